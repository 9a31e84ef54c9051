"""The measured envelope: against a closed form, and against JSBSim's trims inside and outside of it."""

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aircraft.description import built_in_names, load_aircraft
from aircraft.envelope import Condition, Margins, Trimmed, measure_envelope, shortfall
from aircraft.errors import ModelError
from aircraft.own_models import envelope_of
from aircraft.properties import Property
from aircraft.trim_stand import TrimStand


@pytest.fixture(scope="module", params=built_in_names())
def stand(request):
    return TrimStand(load_aircraft(request.param))


@pytest.fixture(scope="module")
def envelope(stand):
    return envelope_of(stand._aircraft)


def banks_and_loads(envelope):
    altitudes = (0.0, 0.4 * envelope.ceiling_m, envelope.ceiling_m)
    banks = (0.0, 0.6 * envelope.bank_max_rad, envelope.bank_max_rad)
    return list(itertools.product(altitudes, (1.0, 0.01), banks))


def test_everything_inside_holds_with_the_margins(stand, envelope):
    airspeeds = (envelope.airspeed_min_mps, envelope.cruise_mps, envelope.airspeed_max_mps)
    for airspeed_mps, (altitude_m, fuel, bank_rad) in itertools.product(airspeeds, banks_and_loads(envelope)):
        condition = Condition(airspeed_mps, altitude_m, fuel, bank_rad)
        assert shortfall(stand, stand.margins, condition) == "", condition
    for altitude_m, fuel in itertools.product((0.0, 1000.0, envelope.ceiling_m), (1.0, 0.01)):
        climbing = Condition(envelope.cruise_mps, altitude_m, fuel, 0.0, envelope.climb_max_mps)
        assert shortfall(stand, stand.margins, climbing) == "", climbing
        descending = climbing._replace(climb_mps=-envelope.descent_max_mps)
        assert shortfall(stand, stand.margins, descending) == "", descending


@pytest.mark.parametrize("change", ["slower", "faster", "climbing", "descending"])
def test_just_outside_something_does_not_hold(stand, envelope, change):
    airspeed_mps, climb_mps = {
        "slower": (envelope.airspeed_min_mps - 0.2, 0.0),
        "faster": (envelope.airspeed_max_mps + 0.2, 0.0),
        "climbing": (envelope.cruise_mps, envelope.climb_max_mps + 0.2),
        "descending": (envelope.cruise_mps, -envelope.descent_max_mps - 0.2),
    }[change]
    reasons = [
        shortfall(stand, stand.margins, Condition(airspeed_mps, altitude_m, fuel, bank_rad, climb_mps))
        for altitude_m, fuel, bank_rad in banks_and_loads(envelope)
        if not (bank_rad and climb_mps)
    ]
    assert any(reasons)


def test_values_near_what_is_known_of_the_aircraft():
    aerosonde, c172p = (envelope_of(load_aircraft(name)) for name in built_in_names())
    assert aerosonde.airspeed_min_mps == pytest.approx(20.0, abs=1.0)
    assert aerosonde.airspeed_max_mps == pytest.approx(41.0, abs=1.5)
    # Cessna's handbook: 44 kn calibrated to stall in level flight, 121 kn true at 80 % power
    assert 44 * 0.5144 * 1.1 < c172p.airspeed_min_mps < 39.0
    assert c172p.airspeed_max_mps == pytest.approx(121 * 0.5144, abs=3.0)


def test_a_turn_takes_the_lift_of_slower_level_flight_and_its_rates(stand, envelope):
    """The lift coefficient at V in a bank is that of V sqrt(cos(bank)) in level flight."""
    airspeed_mps, bank_rad = envelope.cruise_mps, envelope.bank_max_rad
    turning = stand(Condition(airspeed_mps, 1000.0, 1.0, bank_rad))
    rates = [stand._model.get(member) for member in (Property.PITCH_RATE, Property.YAW_RATE)]
    per_s = 9.80 / airspeed_mps * math.sin(bank_rad)
    assert rates == pytest.approx([per_s * math.tan(bank_rad), per_s], rel=0.03)
    level = stand(Condition(airspeed_mps * math.sqrt(math.cos(bank_rad)), 1000.0))
    assert turning.angle_of_attack_rad == pytest.approx(level.angle_of_attack_rad, abs=math.radians(0.4))


def test_order_of_trims_does_not_matter(stand, envelope):
    first = stand(Condition(envelope.cruise_mps, 1000.0))
    assert stand(Condition(4.0 * envelope.airspeed_max_mps, 1000.0)) is None
    stand(Condition(envelope.airspeed_max_mps, 0.0, 0.01, envelope.bank_max_rad))
    assert stand(Condition(envelope.cruise_mps, 1000.0)) == pytest.approx(first, rel=2e-3, abs=1e-4)


# against a closed form


def simple(condition):
    """Angle of attack 90 n m / V^2, throttle (V / 60)^2 + climb / 10, both from 30 % more at the ceiling."""
    load = (0.7 + 0.3 * condition.fuel_share) / math.cos(condition.bank_rad)
    air = 1.0 - 0.3 * condition.altitude_m / 3000.0
    airspeed_mps = condition.airspeed_mps
    throttle = (airspeed_mps / 60.0) ** 2 / air + condition.climb_mps / 10.0
    return Trimmed(90.0 * load / (air * airspeed_mps**2), throttle, 0.0) if throttle <= 1.0 else None


@settings(max_examples=50, deadline=None)
@given(
    bank_rad=st.floats(0.1, 0.9),
    ceiling_m=st.floats(100.0, 3000.0),
    throttle_max=st.floats(0.8, 1.0),
    alpha_max_rad=st.floats(0.14, 0.3),
)
def test_limits_of_a_simple_aircraft(bank_rad, ceiling_m, throttle_max, alpha_max_rad):
    margins = Margins(38.0, ceiling_m, bank_rad, throttle_max, alpha_max_rad)
    air = 1.0 - 0.3 * ceiling_m / 3000.0
    slowest = math.sqrt(90.0 / math.cos(bank_rad) / air / alpha_max_rad)
    fastest = 60.0 * math.sqrt(throttle_max * air)
    climb = 10.0 * (throttle_max - (38.0 / 60.0) ** 2 / air)
    found = measure_envelope(simple, margins, "simple")
    assert 0.0 <= found.airspeed_min_mps - slowest < 0.16
    assert 0.0 <= fastest - found.airspeed_max_mps < 0.16
    assert 0.0 <= climb - found.climb_max_mps < 0.16
    descent = 10.0 * ((38.0 / 60.0) ** 2 - (1.0 - throttle_max))  # least at sea level
    assert 0.0 <= descent - found.descent_max_mps < 0.16


@pytest.mark.parametrize(
    ("margins", "said"),
    [
        (Margins(70.0, 1000.0, 0.5, 1.0, 0.2), "it does not trim"),
        (Margins(50.0, 1000.0, 0.5, 0.5, 0.2), r"throttle 0\.77 of 0\.50"),
        (Margins(20.0, 1000.0, 0.5, 1.0, 0.2), r"angle of attack 16\.\d° of 11\.5°"),
    ],
)
def test_a_cruise_that_does_not_hold_is_refused(margins, said):
    with pytest.raises(ModelError, match=rf"'simple' cannot fly its cruise .*{said}; change cruise_mps"):
        measure_envelope(simple, margins, "simple")
