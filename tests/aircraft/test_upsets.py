"""What the aerosonde's inner loops survive, from 1000 m up, light and heavy."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import pytest

import aircraft.description as module
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.state import Command, FlightState
from aircraft.turbulence import Turbulence

MASSES_KG = (11.0, 13.5)  # of the two printings of the book
ALTITUDE_M = 1000.0


@pytest.fixture(params=MASSES_KG)
def mass_kg(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> float:
    """The mass with full tank; the model is made so heavy."""
    models = tmp_path / "models"
    shutil.copytree(module.BUILT_IN, models)
    xml = models / "aerosonde" / "aerosonde.xml"
    text, empty = xml.read_text(), '<emptywt unit="KG"> 6.0 '
    assert empty in text
    xml.write_text(text.replace(empty, f'<emptywt unit="KG"> {request.param - 5.0} '))
    monkeypatch.setattr(module, "BUILT_IN", models)
    return float(request.param)


def eastward(airspeed_mps: float, mass_kg: float, severity: int = 0, seed: int = 1) -> JsbsimAircraft:
    aircraft = JsbsimAircraft("aerosonde", turbulence=Turbulence("milspec", severity), seed=seed)
    aircraft.start(
        lat_rad=0.45,
        lon_rad=-1.45,
        altitude_m=ALTITUDE_M,
        heading_rad=math.radians(90.0),
        airspeed_mps=airspeed_mps,
        time_s=0.0,
    )
    assert aircraft._fdm["inertia/weight-lbs"] * 0.45359237 == pytest.approx(mass_kg)
    return aircraft


def fly(aircraft: JsbsimAircraft, seconds: float) -> list[FlightState]:
    """States at 10 Hz, as long as it flies."""
    states: list[FlightState] = []
    while len(states) < round(10 * seconds) and not aircraft.has_crashed():
        for _ in range(6):
            aircraft.step()
        states.append(aircraft.state())
    assert aircraft.is_finite()
    return states


def fly_into(
    aircraft: JsbsimAircraft, north_mps: float, east_mps: float, down_mps: float
) -> list[FlightState]:
    """Ten seconds of still air, a wind that is there within a second, and a minute of it."""
    states = fly(aircraft, 10.0)
    for i in range(1, 61):
        aircraft.set_wind(north_mps * i / 60.0, east_mps * i / 60.0, down_mps * i / 60.0)
        aircraft.step()
    return states + fly(aircraft, 60.0)


@pytest.mark.parametrize("airspeed_mps", [22.0, 27.0, 38.0])
def test_a_tailwind_that_takes_the_airspeed_away(airspeed_mps: float, mass_kg: float) -> None:
    """20 m/s within a second leave as little as 7 m/s of airspeed: it falls, and flies again."""
    states = fly_into(eastward(airspeed_mps, mass_kg), 0.0, 20.0, 0.0)
    assert len(states) == 700
    assert min(state.airspeed_mps for state in states) < airspeed_mps - 13.0
    assert min(state.altitude_m for state in states) > ALTITUDE_M - 100.0
    assert max(abs(state.roll_rad) for state in states) < math.radians(15.0)
    for state in states[-100:]:
        assert state.airspeed_mps == pytest.approx(airspeed_mps, abs=0.5)
        assert state.altitude_m == pytest.approx(ALTITUDE_M, abs=0.5)


@pytest.mark.parametrize("wind", [(0.0, -20.0, 0.0), (20.0, 0.0, 0.0), (-14.0, -14.0, 0.0)])
def test_a_wind_from_elsewhere(wind: tuple[float, float, float], mass_kg: float) -> None:
    states = fly_into(eastward(27.0, mass_kg), *wind)
    assert len(states) == 700
    assert max(abs(state.altitude_m - ALTITUDE_M) for state in states) < 1.0
    assert max(abs(state.roll_rad) for state in states) < math.radians(15.0)
    assert max(abs(state.sideslip_rad) for state in states) < math.radians(15.0)
    assert states[-1].airspeed_mps == pytest.approx(27.0, abs=0.5)


def test_a_downdraught_stronger_than_its_climb(mass_kg: float) -> None:
    """10 m/s down: it goes down with the air, less what the engine climbs, with airspeed in hand."""
    aircraft = eastward(27.0, mass_kg)
    sinking = fly_into(aircraft, 0.0, 0.0, 10.0)
    assert len(sinking) == 700
    assert 3.0 < sinking[-1].down_mps < 7.0
    assert min(state.airspeed_mps for state in sinking) > 17.0
    assert max(state.angle_of_attack_rad for state in sinking) < math.radians(12.0)
    aircraft.set_wind(0.0, 0.0, 0.0)
    back = fly(aircraft, 180.0)
    assert back[-1].altitude_m == pytest.approx(ALTITUDE_M, abs=0.5)
    assert back[-1].airspeed_mps == pytest.approx(27.0, abs=0.5)


@pytest.mark.parametrize("severity", [6, 7])
def test_severe_turbulence(severity: int, mass_kg: float) -> None:
    """Gusts of 7 m/s and more (root mean square): stalls and loss of height, but not of attitude."""
    aircraft = eastward(27.0, mass_kg, severity, seed=1)
    states = []
    for i in range(10):
        aircraft.command(Command(math.radians(20.0) * (-1.0) ** i, 27.0, ALTITUDE_M))
        states.extend(fly(aircraft, 20.0))
    assert len(states) == 2000
    assert max(state.angle_of_attack_rad for state in states) > math.radians(15.0)
    assert min(state.altitude_m for state in states) > 400.0
    assert max(abs(state.roll_rad) for state in states) < math.radians(60.0)
    assert max(abs(state.pitch_rad) for state in states) < math.radians(60.0)
