"""The aerosonde against closed forms from the published coefficients."""

import math

import numpy as np
import pytest

from aircraft.description import load_aircraft
from aircraft.errors import ModelError
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.own_models import envelope_of
from aircraft.state import Command
from aircraft.turbulence import Turbulence

ENVELOPE = envelope_of(load_aircraft("aerosonde"))
MASS_KG, WING_M2, GRAVITY_MPS2 = 11.0, 0.55, 9.80
FULL_ELEVATOR_RAD = math.radians(30.0)


def trimmed(airspeed_mps: float, altitude_m: float) -> JsbsimAircraft:
    aircraft = JsbsimAircraft("aerosonde", turbulence=Turbulence(), seed=1)
    aircraft.start(
        lat_rad=0.45,
        lon_rad=-1.45,
        altitude_m=altitude_m,
        heading_rad=1.0,
        airspeed_mps=airspeed_mps,
        time_s=0.0,
    )
    return aircraft


def density_kgpm3(altitude_m: float) -> float:
    """The standard atmosphere below 11 km."""
    return 1.225 * (1.0 - 2.25577e-5 * altitude_m) ** 4.2559


@pytest.mark.parametrize("altitude_m", [300.0, 1000.0, 2000.0])
@pytest.mark.parametrize(
    "airspeed_mps", [ENVELOPE.airspeed_min_mps, 25.0, ENVELOPE.cruise_mps, ENVELOPE.airspeed_max_mps]
)
def test_trim_agrees_with_the_published_coefficients(airspeed_mps: float, altitude_m: float) -> None:
    state = trimmed(airspeed_mps, altitude_m).state()
    pressure_pa = 0.5 * density_kgpm3(altitude_m) * airspeed_mps**2
    # two equations, lift and pitching moment, for angle of attack and elevator; thrust carries a little
    drag_n = pressure_pa * WING_M2 * 0.05
    lift = (MASS_KG * GRAVITY_MPS2 - drag_n * math.sin(state.angle_of_attack_rad)) / (pressure_pa * WING_M2)
    alpha_rad, elevator_rad = np.linalg.solve([[5.61, 0.13], [-2.74, -0.99]], [lift - 0.23, -0.0135])
    assert state.angle_of_attack_rad == pytest.approx(alpha_rad, abs=math.radians(0.1))
    assert state.elevator * FULL_ELEVATOR_RAD == pytest.approx(elevator_rad, abs=math.radians(0.3))
    assert 0.0 < state.throttle < 1.0
    assert abs(state.aileron) < 0.1
    assert abs(state.rudder) < 0.1
    assert abs(state.roll_rad) < math.radians(0.5)


def test_trim_at_25_mps_and_1000_m() -> None:
    assert math.degrees(trimmed(25.0, 1000.0).state().angle_of_attack_rad) == pytest.approx(3.6, abs=0.1)


def test_fuel_lasts_twenty_hours_of_cruise() -> None:
    aircraft = trimmed(ENVELOPE.cruise_mps, 1000.0)
    full_kg = aircraft.fuel_kg
    for _ in range(60 * 60):
        aircraft.step()
    burnt_kgph = (full_kg - aircraft.fuel_kg) * 60.0
    assert full_kg == pytest.approx(5.0, abs=0.01)
    assert 0.13 < burnt_kgph < 0.18
    assert full_kg / burnt_kgph > 25.0


@pytest.mark.parametrize("altitude_m", [300.0, ENVELOPE.ceiling_m - 20.0 * ENVELOPE.climb_max_mps])
def test_climb_of_the_envelope(altitude_m: float) -> None:
    aircraft = trimmed(ENVELOPE.cruise_mps, altitude_m)
    for i in range(1, 20 * 60 + 1):
        if i % 6 == 1:
            wanted_m = altitude_m + ENVELOPE.climb_max_mps * i / 60.0
            aircraft.command(Command(0.0, ENVELOPE.cruise_mps, wanted_m, ENVELOPE.climb_max_mps))
        aircraft.step()
    state = aircraft.state()
    assert state.altitude_m == pytest.approx(altitude_m + 20.0 * ENVELOPE.climb_max_mps, abs=1.0)
    assert state.airspeed_mps == pytest.approx(ENVELOPE.cruise_mps, abs=0.5)
    assert state.throttle < 0.95


def test_no_trim_beyond_the_envelope() -> None:
    with pytest.raises(
        ModelError, match=r"cannot fly level at 60\.0 m/s and 1000 m; start between 20 and 41"
    ):
        trimmed(60.0, 1000.0)
