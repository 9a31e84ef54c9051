"""What the aerosonde can do, and what becomes of it when its engine cannot."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.state import Command, FlightState
from aircraft.turbulence import Turbulence

WEIGHT_N, WING_M2, LIFT_MAX = 11.0 * 9.80, 0.55, 1.5
DENSITY_KGPM3 = 1.112  # of the standard atmosphere at 1000 m
STALL_MPS = math.sqrt(2.0 * WEIGHT_N / (DENSITY_KGPM3 * WING_M2 * LIFT_MAX))  # 15.3, at 11 kg


def started(
    airspeed_mps: float = 27.0,
    altitude_m: float = 1000.0,
    turbulence: Turbulence | None = None,
    seed: int = 1,
) -> JsbsimAircraft:
    aircraft = JsbsimAircraft("aerosonde", turbulence=turbulence or Turbulence(), seed=seed)
    aircraft.start(
        lat_rad=0.45,
        lon_rad=-1.45,
        altitude_m=altitude_m,
        heading_rad=1.0,
        airspeed_mps=airspeed_mps,
        time_s=0.0,
    )
    return aircraft


def fly(aircraft: JsbsimAircraft, seconds: float) -> list[FlightState]:
    """States at 10 Hz."""
    states = []
    for _ in range(round(seconds * 10)):
        for _ in range(6):
            aircraft.step()
        states.append(aircraft.state())
    return states


def worst(states: list[FlightState], name: str) -> float:
    return max(getattr(state, name) for state in states)


def stop_the_engine(aircraft: JsbsimAircraft) -> None:
    aircraft._fdm["propulsion/magneto_cmd"] = 0


# trim and stability


def test_trims_vary_smoothly() -> None:
    """Faster: less angle of attack, elevator farther down (positive static margin), more throttle."""
    trims = [started(airspeed_mps).state() for airspeed_mps in np.arange(18.0, 41.5, 1.0)]
    for slower, faster in pairwise(trims):
        assert -0.025 < faster.angle_of_attack_rad - slower.angle_of_attack_rad < 0.0
        assert 0.0 < faster.elevator - slower.elevator < 0.15
        assert 0.0 < faster.throttle - slower.throttle < 0.04
    bends = np.diff([state.angle_of_attack_rad for state in trims], 2)
    assert np.all(bends > 0.0)


def test_static_margin() -> None:
    """The neutral point lies -C_m_alpha / C_L_alpha = 0.49 chords behind the centre of gravity."""
    slow, fast = (started(airspeed_mps).state() for airspeed_mps in (22.0, 36.0))
    alpha_rad = slow.angle_of_attack_rad - fast.angle_of_attack_rad
    elevator_rad = math.radians(30.0) * (slow.elevator - fast.elevator)
    assert 0.99 * -elevator_rad / (5.61 * alpha_rad) == pytest.approx(0.49, abs=0.03)


def test_the_lift_curve_bends_and_breaks() -> None:
    fdm = started()._fdm
    lift = {}
    for alpha_deg in range(-10, 46):
        fdm["ic/alpha-deg"] = alpha_deg
        fdm.run_ic()
        pressure_lbf = fdm["aero/qbar-psf"] * fdm["metrics/Sw-sqft"]
        lift[alpha_deg] = fdm["forces/fwz-aero-lbs"] / pressure_lbf - 0.13 * fdm["fcs/elevator-pos-rad"]
    assert (lift[12] - lift[-8]) / math.radians(20.0) == pytest.approx(5.61, abs=0.01)
    assert max(lift, key=lift.__getitem__) == 15
    assert lift[15] == pytest.approx(LIFT_MAX, abs=0.001)
    assert lift[20] == pytest.approx(0.8 * LIFT_MAX, abs=0.001)
    assert all(lift[beyond] > lift[beyond + 1] for beyond in range(15, 45))


def test_full_elevator_holds_it_short_of_the_stall() -> None:
    """-30 degrees trim alpha = (C_m_0 + 0.99 delta_e) / -C_m_alpha = 11.1 degrees: 9 % above the stall."""
    aircraft = started(22.0)
    aircraft._fdm["ap/engaged"] = 0.0
    aircraft._fdm["fcs/elevator-cmd-norm"] = -1.0
    states = fly(aircraft, 90.0)[-300:]  # a phugoid around a glide, the engine idling
    assert np.mean([state.angle_of_attack_rad for state in states]) == pytest.approx(
        math.radians(11.1), abs=0.01
    )
    assert np.mean([state.airspeed_mps for state in states]) == pytest.approx(1.09 * STALL_MPS, abs=0.5)


# without an engine


@pytest.mark.parametrize("fuel_out", [False, True])
def test_it_glides_when_the_engine_stops(fuel_out: bool) -> None:
    aircraft = started()
    fly(aircraft, 5.0)
    if fuel_out:
        aircraft._fdm["propulsion/tank/contents-lbs"] = 0.0
    else:
        stop_the_engine(aircraft)
    states = fly(aircraft, 180.0)
    weight_n = aircraft._fdm["inertia/weight-lbs"] * 4.448222
    stall_mps = math.sqrt(2.0 * weight_n / (DENSITY_KGPM3 * WING_M2 * LIFT_MAX))
    assert aircraft._fdm["propulsion/engine/set-running"] == 0.0
    assert weight_n == pytest.approx(58.8 if fuel_out else WEIGHT_N, abs=0.3)
    assert min(state.airspeed_mps for state in states) > 1.1 * stall_mps
    assert worst(states, "angle_of_attack_rad") < math.radians(11.0)
    assert not aircraft.has_crashed()
    first, last = states[599], states[-1]
    assert last.airspeed_mps == pytest.approx(first.airspeed_mps, abs=0.3)
    glide_ratio = 120.0 * last.airspeed_mps / (first.altitude_m - last.altitude_m)
    # the polar's L/D less the drag of the windmilling propeller
    assert 10.0 < glide_ratio < 15.0


def test_it_glides_through_turbulence_and_in_turns() -> None:
    aircraft = started(turbulence=Turbulence("milspec", 4), seed=5)
    stop_the_engine(aircraft)
    states = []
    for i in range(12):
        aircraft.command(Command(math.radians(25.0) * (-1.0) ** i, 27.0, 1000.0))
        states.extend(fly(aircraft, 15.0))
    assert not aircraft.has_crashed()
    assert states[-1].altitude_m > 500.0
    assert np.mean([state.angle_of_attack_rad > math.radians(12.0) for state in states]) < 0.05
    assert max(abs(state.roll_rad) for state in states) < math.radians(45.0)


# fuel


def test_mass_falls_by_the_fuel_that_is_burnt() -> None:
    aircraft = started()
    fdm = aircraft._fdm
    before_kg, moment = aircraft.fuel_kg, fdm["inertia/iyy-slugs_ft2"]
    assert fdm["inertia/weight-lbs"] * 0.45359237 == pytest.approx(11.0, abs=1e-6)
    burnt_kg = 0.0
    for _ in range(3600):
        for _ in range(60):
            aircraft.step()
        burnt_kg += fdm["propulsion/engine/fuel-flow-rate-pps"] * 0.45359237
    assert before_kg - aircraft.fuel_kg == pytest.approx(burnt_kg, rel=1e-3)
    assert 0.13 < burnt_kg < 0.18  # published: 26 hours on 6 litres, at 13 kg
    assert fdm["inertia/weight-lbs"] * 0.45359237 == pytest.approx(11.0 - burnt_kg, abs=1e-4)
    assert fdm["inertia/iyy-slugs_ft2"] == pytest.approx(moment)
    assert [fdm[f"inertia/cg-{axis}-in"] for axis in "xyz"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
