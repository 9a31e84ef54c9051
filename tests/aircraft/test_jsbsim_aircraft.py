import math

import numpy as np
import pytest

from aircraft import jsbsim_aircraft
from aircraft.errors import ModelError
from aircraft.jsbsim_aircraft import IDLE_IN_FLIGHT, SLOW_EVERY, JsbsimAircraft
from aircraft.properties import Property
from aircraft.state import Command, FlightState
from aircraft.turbulence import Turbulence

CALM = Turbulence()
LIGHT = Turbulence("milspec", 3)


def started(
    airspeed_mps: float = 25.0,
    altitude_m: float = 1000.0,
    turbulence: Turbulence = CALM,
    seed: int = 1,
    rate_hz: float = 60.0,
) -> JsbsimAircraft:
    aircraft = JsbsimAircraft("aerosonde", turbulence=turbulence, seed=seed, rate_hz=rate_hz)
    aircraft.start(
        lat_rad=0.45,
        lon_rad=-1.45,
        altitude_m=altitude_m,
        heading_rad=math.radians(90.0),
        airspeed_mps=airspeed_mps,
        time_s=1000.0,
    )
    return aircraft


def fly(aircraft: JsbsimAircraft, seconds: float) -> list[FlightState]:
    """States at 10 Hz."""
    states = []
    for _ in range(round(seconds * 10)):
        for _ in range(round(aircraft.rate_hz / 10)):
            aircraft.step()
        states.append(aircraft.state())
    return states


def column(states: list[FlightState], name: str) -> np.ndarray:
    return np.array([getattr(state, name) for state in states])


# starting


@pytest.mark.parametrize("altitude_m", [300.0, 1000.0, 2000.0])
@pytest.mark.parametrize("airspeed_mps", [20.0, 27.0, 41.0])
def test_starts_in_steady_flight(airspeed_mps: float, altitude_m: float) -> None:
    aircraft = started(airspeed_mps, altitude_m)
    first = aircraft.state()
    assert first.time_s == 1000.0
    assert (first.lat_rad, first.lon_rad) == pytest.approx((0.45, -1.45), abs=1e-12)
    assert first.altitude_m == pytest.approx(altitude_m, abs=0.02)
    assert first.heading_rad == pytest.approx(math.radians(90.0), abs=1e-9)
    assert first.airspeed_mps == pytest.approx(airspeed_mps, abs=1e-6)
    states = fly(aircraft, 20.0)
    assert np.abs(column(states, "altitude_m") - altitude_m).max() < 0.5
    assert np.abs(column(states, "airspeed_mps") - airspeed_mps).max() < 0.3
    assert np.abs(column(states, "roll_rad")).max() < math.radians(0.5)


def test_time_and_position_follow_the_steps() -> None:
    aircraft = started()
    states = fly(aircraft, 10.0)
    assert states[-1].time_s == pytest.approx(1010.0, abs=1e-9)
    assert aircraft.position() == (states[-1].lat_rad, states[-1].lon_rad, states[-1].altitude_m)
    parallel_m = 6378137.0 / math.sqrt(1.0 - 0.00669438 * math.sin(0.45) ** 2) * math.cos(0.45)
    east_m = (states[-1].lon_rad + 1.45) * (parallel_m + 1000.0 * math.cos(0.45))
    assert east_m == pytest.approx(25.0 * 10.0, abs=0.5)


def test_unknown_model_lists_the_known() -> None:
    with pytest.raises(ModelError, match=r"no aircraft model 'albatross'; the models are: aerosonde, c172p"):
        JsbsimAircraft("albatross", turbulence=CALM, seed=1)


@pytest.mark.parametrize(("kind", "severity"), [("dryden", 3), ("milspec", 8), ("milspec", -1)])
def test_unknown_turbulence(kind: str, severity: int) -> None:
    with pytest.raises(ModelError, match="turbulence"):
        Turbulence(kind, severity)  # type: ignore[arg-type]


def test_it_is_silent(capfd: pytest.CaptureFixture[str]) -> None:
    aircraft = started(turbulence=LIGHT)
    fly(aircraft, 1.0)
    with pytest.raises(ModelError):
        started(60.0)
    del aircraft
    assert capfd.readouterr() == ("", "")


# holding what is commanded


@pytest.mark.parametrize("airspeed_mps", [21.0, 27.0, 38.0])
def test_bank_is_quick_and_altitude_holds_in_the_turn(airspeed_mps: float) -> None:
    aircraft = started(airspeed_mps)
    bank_rad = math.radians(25.0)
    aircraft.command(Command(bank_rad, airspeed_mps, 1000.0))
    states = fly(aircraft, 30.0)
    roll_rad = column(states, "roll_rad")
    assert np.argmax(roll_rad > 0.632 * bank_rad) < 5  # 0.3 to 0.5 s
    assert roll_rad.max() < bank_rad + math.radians(1.0)
    assert np.abs(roll_rad[20:] - bank_rad).max() < math.radians(1.0)
    assert np.abs(column(states, "altitude_m") - 1000.0).max() < 0.5
    assert np.abs(column(states, "airspeed_mps") - airspeed_mps).max() < 0.5
    assert np.abs(column(states, "sideslip_rad")[20:]).max() < math.radians(1.5)
    # the rate of a coordinated turn
    turned_rad = states[-1].heading_rad - states[-101].heading_rad
    expected_rad = 10.0 * 9.80 * math.tan(bank_rad) / airspeed_mps
    assert math.remainder(turned_rad - expected_rad, 2.0 * math.pi) == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("change_mps", [3.0, -3.0])
def test_airspeed_step(change_mps: float) -> None:
    aircraft = started(27.0)
    aircraft.command(Command(0.0, 27.0 + change_mps, 1000.0))
    states = fly(aircraft, 20.0)
    error_mps = (column(states, "airspeed_mps") - 27.0 - change_mps) * math.copysign(1.0, change_mps)
    assert np.abs(error_mps[35:]).max() < 0.5
    assert np.abs(error_mps[100:]).max() < 0.15
    assert error_mps.max() < 0.5
    assert np.abs(column(states, "altitude_m") - 1000.0).max() < 0.3


def test_altitude_step() -> None:
    aircraft = started()
    aircraft.command(Command(0.0, 25.0, 1010.0))
    altitude_m = column(fly(aircraft, 20.0), "altitude_m")
    assert np.abs(altitude_m[60:] - 1010.0).max() < 0.3
    assert altitude_m.max() < 1010.3


@pytest.mark.parametrize("climb_mps", [2.0, -2.0])
def test_altitude_ramp_with_climb_feed_forward(climb_mps: float) -> None:
    aircraft = started()
    errors_m = []
    for i in range(300):
        altitude_m = 1000.0 + climb_mps * 0.1 * i
        aircraft.command(Command(0.0, 25.0, altitude_m, climb_mps))
        errors_m.append(fly(aircraft, 0.1)[0].altitude_m - altitude_m - climb_mps * 0.1)
    assert np.abs(errors_m[50:]).max() < 0.5


def test_a_command_too_slow_to_fly_is_flown_as_slowly_as_is_safe() -> None:
    aircraft = started()
    aircraft.command(Command(math.radians(35.0), 10.0, 1000.0))
    states = fly(aircraft, 60.0)
    assert column(states, "angle_of_attack_rad").max() < math.radians(11.0)
    assert np.abs(column(states, "altitude_m") - 1000.0).max() < 1.0
    assert 17.0 < states[-1].airspeed_mps < 22.0


def test_airspeed_comes_before_altitude() -> None:
    """Air that sinks faster than the aircraft can climb takes altitude, not the aircraft."""
    aircraft = started(22.0)
    for i in range(600):
        aircraft.set_wind(0.0, 0.0, min(9.0, 0.02 * i))
        aircraft.step()
    states = fly(aircraft, 60.0)
    assert column(states, "angle_of_attack_rad").max() < math.radians(12.0)
    assert column(states, "airspeed_mps").min() > 16.5
    assert states[-1].altitude_m < 950.0


# wind and turbulence


@pytest.mark.parametrize(("north_mps", "east_mps"), [(10.0, 0.0), (0.0, -10.0), (-6.0, 8.0)])
def test_wind_is_toward(north_mps: float, east_mps: float) -> None:
    aircraft = started()
    for i in range(
        1, 601
    ):  # hold the heading while the wind rises, for 20 s, and until it is no longer a gust
        aircraft.set_wind(north_mps * min(1.0, i / 200), east_mps * min(1.0, i / 200), 0.0)
        off_rad = math.remainder(math.radians(90.0) - aircraft.state().heading_rad, 2.0 * math.pi)
        aircraft.command(Command(max(-0.5, min(0.5, 2.0 * off_rad)), 25.0, 1000.0))
        fly(aircraft, 0.1)
    state = aircraft.state()
    assert (state.wind_north_mps, state.wind_east_mps) == pytest.approx((north_mps, east_mps), abs=1e-9)
    assert state.north_mps == pytest.approx(north_mps, abs=0.3)
    assert state.east_mps == pytest.approx(25.0 + east_mps, abs=0.3)
    assert state.airspeed_mps == pytest.approx(25.0, abs=0.1)


def test_turbulence_has_the_strength_of_the_specification() -> None:
    """MIL-F-8785C, figure 7, exceedance index 3 at 3,281 ft: 7.3 ft/s on each axis."""
    states = fly(started(30.0, turbulence=LIGHT), 3600.0)
    gusts = np.array([column(states, f"gust_{axis}_mps") for axis in ("north", "east", "down")])
    assert math.sqrt(np.mean(gusts**2)) == pytest.approx(2.22, rel=0.1)
    assert np.abs(gusts.mean(axis=1)).max() < 0.6
    total = np.array([column(states, f"{axis}_mps") for axis in ("north", "east", "down")])
    assert np.allclose(np.linalg.norm(total - gusts, axis=0), column(states, "airspeed_mps"), atol=0.15)


def test_holds_in_light_turbulence() -> None:
    states = fly(started(27.0, turbulence=LIGHT), 600.0)
    error_m = np.abs(column(states, "altitude_m") - 1000.0)
    assert np.quantile(error_m, 0.95) < 1.0
    assert error_m.max() < 3.0
    assert np.quantile(np.abs(column(states, "roll_rad")), 0.95) < math.radians(5.0)
    assert abs(column(states, "airspeed_mps").mean() - 27.0) < 0.5


def test_no_gust_in_still_air() -> None:
    state = fly(started(), 5.0)[-1]
    assert state[16:22] == pytest.approx((0.0,) * 6, abs=1e-9)


def test_seed_decides_the_flight() -> None:
    first, again, other = (started(turbulence=LIGHT, seed=seed) for seed in (7, 7, 8))
    flight = fly(first, 20.0)
    assert fly(again, 20.0) == flight
    assert fly(other, 20.0) != flight
    again.start(
        lat_rad=0.45,
        lon_rad=-1.45,
        altitude_m=1000.0,
        heading_rad=math.radians(90.0),
        airspeed_mps=25.0,
        time_s=1000.0,
    )
    assert fly(again, 20.0) == flight


@pytest.mark.parametrize("seed", [0, 2**31 - 3, 2**40 + 5])
def test_any_seed_will_do(seed: int) -> None:
    assert fly(started(turbulence=LIGHT, seed=seed), 1.0)[-1].gust_down_mps != 0.0


def test_60_and_120_hz_agree() -> None:
    flights = []
    for rate_hz in (60.0, 120.0):
        aircraft, states = started(rate_hz=rate_hz), []
        for i in range(200):
            share = min(1.0, i / 20)  # of the change commanded
            aircraft.command(Command(math.radians(25.0) * share, 25.0 + 3.0 * share, 1000.0 + 5.0 * share))
            states.extend(fly(aircraft, 0.1))
        flights.append(states)
    coarse, fine = flights
    for name, tolerance in (
        ("roll_rad", math.radians(0.25)),
        ("altitude_m", 0.05),
        ("airspeed_mps", 0.05),
        ("angle_of_attack_rad", math.radians(0.25)),
    ):
        assert np.abs(column(coarse, name) - column(fine, name)).max() < tolerance, name
    assert coarse[-1].lat_rad == pytest.approx(fine[-1].lat_rad, abs=2.0 / 6.4e6)


def test_what_is_idle_in_flight_can_be_left_out() -> None:
    whole, lean = (started(turbulence=Turbulence("milspec", 4)) for _ in range(2))
    for part in IDLE_IN_FLIGHT:
        assert lean._fdm[f"simulation/models/{part}/enabled"] == 0.0
        whole.enable(part, True)
    assert fly(whole, 60.0) == fly(lean, 60.0)


def test_the_airs_density_is_that_of_the_height_within_a_hundredth_of_a_per_cent() -> None:
    aircraft = started(turbulence=Turbulence("milspec", 4))
    aircraft.command(Command(0.0, 25.0, 1300.0))
    heights_m, densities = [], []
    for _ in range(3000):
        aircraft.step()
        heights_m.append(aircraft.state().altitude_m)
        densities.append(aircraft._fdm["atmosphere/rho-slugs_ft3"] * 515.378818)
    assert np.ptp(heights_m) > 100.0
    geopotential_m = 6356766.0 * np.array(heights_m) / (6356766.0 + np.array(heights_m))
    standard = 1.225 * (1.0 - 0.0065 * geopotential_m / 288.15) ** 4.25588  # ISO 2533, up to 11 km
    np.testing.assert_allclose(densities, standard, rtol=1e-4)
    assert len(set(densities)) < len(densities) / 5  # and is not computed at every step


def test_what_changes_slowly_need_not_be_computed_in_every_step(monkeypatch: pytest.MonkeyPatch) -> None:
    flights = []
    for every in (1, SLOW_EVERY):
        monkeypatch.setattr(jsbsim_aircraft, "SLOW_EVERY", every)
        aircraft = started(turbulence=Turbulence("milspec", 4))
        aircraft.command(Command(0.3, 27.0, 1030.0))
        flights.append(fly(aircraft, 30.0))
        weight_kg = aircraft._fdm["inertia/weight-lbs"] * 0.45359237
        assert weight_kg == pytest.approx(6.0 + aircraft.fuel_kg, abs=1e-5)
    always, seldom = flights
    assert always != seldom
    for name, tolerance in (("roll_rad", 1e-4), ("altitude_m", 0.01), ("airspeed_mps", 0.005)):
        assert np.abs(column(always, name) - column(seldom, name)).max() < tolerance, name
    assert seldom[-1].lat_rad == pytest.approx(always[-1].lat_rad, abs=0.1 / 6.4e6)


def test_the_height_above_ground_is_jsbsims() -> None:
    aircraft = started(turbulence=Turbulence("milspec", 4))
    for state in fly(aircraft, 2.0):
        assert state.height_above_ground_m == state.altitude_m
    assert aircraft.state().height_above_ground_m == aircraft.get(Property.HEIGHT_ABOVE_GROUND)


# the end of a flight


def test_fuel_burns() -> None:
    aircraft = started()
    fuel_kg = column(fly(aircraft, 60.0), "fuel_kg")
    assert np.all(np.diff(fuel_kg) < 0.0)
    assert aircraft.fuel_kg == fuel_kg[-1]


def test_a_crash_is_told() -> None:
    aircraft = started(altitude_m=60.0)
    aircraft.command(Command(0.0, 25.0, -200.0))
    assert not aircraft.has_crashed()
    fly(aircraft, 9.0)
    assert not aircraft.has_crashed()
    assert any(fly(aircraft, 0.2) and aircraft.has_crashed() for _ in range(30))
    fly(aircraft, 5.0)
    assert aircraft.has_crashed()  # still


def test_not_a_number_is_told() -> None:
    aircraft = started()
    assert aircraft.is_finite()
    aircraft.set_wind(math.nan, 0.0, 0.0)
    fly(aircraft, 0.2)
    assert not aircraft.is_finite()
    assert aircraft.has_crashed()
