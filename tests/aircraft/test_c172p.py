"""JSBSim's own Cessna under galeway's autopilot."""

import math
from pathlib import Path
from xml.etree import ElementTree

import jsbsim
import numpy as np
import pytest

from aircraft.base_model import write_with_autopilot
from aircraft.description import BUILT_IN
from aircraft.errors import ModelError
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.state import Command
from aircraft.turbulence import Turbulence

AUTOPILOT = BUILT_IN / "c172p" / "autopilot.xml"
JSBSIM = Path(jsbsim.get_default_root_dir())


@pytest.fixture(scope="module")
def cessna():
    return JsbsimAircraft("c172p", turbulence=Turbulence(), seed=1)


def start(aircraft, airspeed_mps, altitude_m):
    aircraft.start(
        lat_rad=0.45,
        lon_rad=-1.45,
        altitude_m=altitude_m,
        heading_rad=1.0,
        airspeed_mps=airspeed_mps,
        time_s=0.0,
    )


def fly(aircraft, seconds):
    states = []
    for _ in range(round(10 * seconds)):
        for _ in range(round(aircraft.rate_hz / 10)):
            aircraft.step()
        states.append(aircraft.state())
    return states


def column(states, name):
    return np.array([getattr(state, name) for state in states])


@pytest.mark.parametrize("altitude_m", [300.0, 1900.0])
@pytest.mark.parametrize("airspeed_mps", [35.0, 50.0, 62.0])
def test_it_takes_over_from_the_trim_without_a_jolt(cessna, airspeed_mps, altitude_m):
    start(cessna, airspeed_mps, altitude_m)
    assert cessna.fuel_kg == pytest.approx(167.0, abs=0.01)
    states = fly(cessna, 20.0)
    assert np.abs(column(states, "altitude_m") - altitude_m).max() < 1.0
    assert np.abs(column(states, "airspeed_mps") - airspeed_mps).max() < 1.2
    assert np.abs(column(states, "roll_rad")).max() < math.radians(1.0)


@pytest.mark.parametrize("airspeed_mps", [37.0, 50.0, 60.0])
def test_it_turns_level_and_coordinated(cessna, airspeed_mps):
    start(cessna, airspeed_mps, 1000.0)
    bank_rad = math.radians(25.0)
    cessna.command(Command(bank_rad, airspeed_mps, 1000.0))
    states = fly(cessna, 30.0)
    roll_rad = column(states, "roll_rad")
    assert np.argmax(roll_rad > 0.632 * bank_rad) < 7
    assert np.abs(roll_rad[30:] - bank_rad).max() < math.radians(1.0)
    assert np.abs(column(states, "altitude_m") - 1000.0).max() < 0.8
    assert np.abs(column(states, "airspeed_mps") - airspeed_mps).max() < 1.2
    assert np.abs(column(states, "sideslip_rad")[150:]).max() < math.radians(1.5)


def test_it_climbs_and_changes_speed_as_told(cessna):
    start(cessna, 50.0, 1000.0)
    cessna.command(Command(0.0, 53.0, 1010.0))
    states = fly(cessna, 20.0)
    assert np.abs(column(states, "altitude_m")[80:] - 1010.0).max() < 0.5
    assert np.abs(column(states, "airspeed_mps")[80:] - 53.0).max() < 0.5


def test_too_slow_a_command_does_not_stall_it(cessna):
    start(cessna, 40.0, 1000.0)
    cessna.command(Command(math.radians(30.0), 20.0, 1000.0))
    states = fly(cessna, 60.0)
    assert column(states, "angle_of_attack_rad").max() < math.radians(13.5)
    assert np.abs(column(states, "altitude_m") - 1000.0).max() < 5.0


def test_only_the_autopilot_is_added(tmp_path):
    write_with_autopilot(JSBSIM, "c172p", AUTOPILOT, tmp_path)
    ours = ElementTree.parse(tmp_path / "c172p.xml").getroot()
    (added,) = ours.findall("autopilot")
    assert Path(added.get("file")) == AUTOPILOT
    ours.remove(added)
    theirs = ElementTree.parse(JSBSIM / "aircraft" / "c172p" / "c172p.xml").getroot()
    theirs.tail = ours.tail
    assert ElementTree.tostring(ours) == ElementTree.tostring(theirs)


def test_an_autopilot_of_its_own_is_replaced(tmp_path):
    write_with_autopilot(JSBSIM, "c172x", AUTOPILOT, tmp_path)
    (only,) = ElementTree.parse(tmp_path / "c172x.xml").getroot().findall("autopilot")
    assert Path(only.get("file")) == AUTOPILOT


def test_an_aircraft_that_jsbsim_does_not_have(tmp_path):
    with pytest.raises(ModelError, match=r"JSBSim has no aircraft 'c172q'; did you mean 'c172"):
        write_with_autopilot(JSBSIM, "c172q", AUTOPILOT, tmp_path)
