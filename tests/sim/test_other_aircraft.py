"""Scenarios flown on other aircraft than the default."""

import shutil

import numpy as np
import pytest

from aircraft.description import BUILT_IN
from aircraft.errors import ModelError
from recordings.recorder import Outcome
from sim.closed_loop import fly
from sim.preparation import make_aircraft
from sim.scenario import load_scenario

CESSNA = (
    "aircraft.model=c172p",
    "grid.cell_m=6000",
    "hazard.corridor_m=2000",
    'mission.goals=[{name="There", lat_deg=29.98, lon_deg=-90.0}]',
)


def test_the_cessna_flies_the_short_scenario(ready, kept):
    setup = ready(*CESSNA)
    assert setup.header.versions["aircraft"].startswith("c172p ")
    assert fly(setup, kept, lambda _: None).outcome is Outcome.ARRIVED
    flown = [(state, guidance) for state, guidance in kept.samples if state.time_s >= 0.0]
    assert flown[-1][0].time_s > 400.0
    progress = [guidance for _, guidance in flown]
    assert np.quantile(np.abs([point.cross_track_m for point in progress]), 0.95) < 1.0
    assert np.quantile(np.abs([point.altitude_error_m for point in progress]), 0.95) < 3.0
    assert np.abs([point.time_error_s for point in progress]).max() < 5.0


def test_its_radii_are_its_own_unless_the_scenario_gives_others(ready):
    own, given = (ready(*CESSNA, *more).header.reference for more in ((), ("aircraft.turn_radius_m=1200",)))
    tightest_m = [1.0 / np.abs(reference.curvature * reference.scale).max() for reference in (own, given)]
    assert 890.0 < tightest_m[0] < 1190.0 < tightest_m[1]


def test_a_folder_beside_the_scenario(tmp_path):
    shutil.copytree(BUILT_IN / "aerosonde", tmp_path / "mine")
    scenario = load_scenario("ian", ["aircraft.model=./mine"]).scenario
    assert make_aircraft(scenario, tmp_path).model == "mine"
    with pytest.raises(ModelError, match=r"no aircraft model './mine'"):
        make_aircraft(scenario, tmp_path / "elsewhere")
