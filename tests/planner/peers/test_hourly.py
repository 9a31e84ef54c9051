"""Replanning by the map of the hour, from nothing and by D* Lite, each the other's oracle."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from planner.hazards import Move, StageClock
from planner.peers import PEERS
from planner.peers.breach import first_breach
from planner.peers.dstar_lite import DStarLite
from planner.score import Weights
from planner.staged import Occupancy, StagedProblem

BOTH = ["replanning", "dstar-lite"]


@pytest.mark.parametrize("name", BOTH)
def test_waits_until_the_map_shows_the_door_open(name, door):
    route = PEERS[name].find(door.problem, door.start, door.goal)
    assert first_breach(door.problem, door.start, door.goal, route) is None
    # It stood at the start, knowing no way, while the optimum had gone ahead to the door.
    assert door.optimum < route.arrival_step <= 15 + 6


@pytest.mark.parametrize("name", BOTH)
def test_turns_round_when_the_gap_shuts(name, shutter):
    route = PEERS[name].find(shutter.problem, shutter.start, shutter.goal)
    assert first_breach(shutter.problem, shutter.start, shutter.goal, route) is None
    assert route.arrival_step >= shutter.optimum


@pytest.mark.parametrize("name", BOTH)
def test_is_caught_where_the_next_hour_brings_hazard(name, siding):
    route = PEERS[name].find(siding.problem, siding.start, siding.goal)
    assert not route.found
    assert "caught by hazard" in route.reason


@pytest.mark.parametrize("name", BOTH)
def test_can_be_late_for_a_short_cut_that_shuts(name, world):
    hazard = np.zeros((8, 9, 12), dtype=bool)
    hazard[:, :, 8] = True
    hazard[0:2, 0:2, 8] = False  # still open in the second hour, shut as it arrives
    hazard[:, 7:9, 8] = False
    hazard[1, 0:2, 8] = True
    problem = world(hazard)
    late, best = (PEERS[peer].find(problem, (0, 0), (0, 11)) for peer in (name, "staged"))
    assert late.arrival_step >= best.arrival_step


@settings(max_examples=150, deadline=None)
@given(
    hnp.arrays(
        bool,
        st.tuples(st.integers(1, 5), st.integers(1, 6), st.integers(1, 6)),
        elements=st.sampled_from([False, False, False, True]),
    ),
    st.integers(1, 4),
    st.sampled_from(Occupancy),
    st.booleans(),
    st.integers(0, 2**32 - 1),
)
def test_repairing_and_starting_anew_fly_the_same_route(hazard, steps, occupancy, windy, lot):
    lots = np.random.default_rng(lot)
    flyable = None
    if windy:
        flyable = lots.random((len(hazard), len(Move), *hazard.shape[1:])) < 0.8
        flyable[:, Move.STAY] = True
    clock = StageClock(0.0, len(hazard), steps)
    problem = StagedProblem(hazard, clock, Weights(), occupancy, flyable)
    start, goal = (tuple(int(lots.integers(size)) for size in hazard.shape[1:]) for _ in range(2))
    anew, repaired = (PEERS[name].find(problem, start, goal) for name in BOTH)
    assert anew == repaired


def test_repairing_takes_less_work_than_searching_anew(world):
    hazard = np.zeros((2, 30, 30), dtype=bool)
    hazard[:, 5:25, 15] = True
    hazard[1, 4, 15] = True  # the wall grows by one cell
    start, goal = (15, 2), (15, 27)
    problem = world(hazard)
    repairing = DStarLite(problem, start, goal)
    repairing.see(0, start)
    first = repairing.expansions
    repairing.see(1, start)
    anew = DStarLite(problem, start, goal)
    anew.see(1, start)
    assert repairing.next_cell(start) is not None
    assert 0 <= repairing.expansions - first < anew.expansions
