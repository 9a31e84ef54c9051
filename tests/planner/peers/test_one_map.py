"""Systems that plan on the map of departure: shortest on it, and blind to what comes."""

from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from planner.hazards import OFFSETS, StageClock, clearance_cells
from planner.peers import PEERS
from planner.peers.breach import first_breach
from planner.score import Weights
from planner.staged import StagedProblem


def distance_on_first_map(problem, start, goal):
    """Moves from start to goal by a queue, None without a way."""
    queue, moves = deque([start]), {start: 0}
    while queue:
        row, column = here = queue.popleft()
        for rows, columns in OFFSETS.values():
            cell = row + rows, column + columns
            inside = 0 <= cell[0] < problem.hazard.shape[1] and 0 <= cell[1] < problem.hazard.shape[2]
            if inside and not problem.hazard[0][cell] and cell not in moves:
                moves[cell] = moves[here] + 1
                queue.append(cell)
    return moves.get(goal)


maps = hnp.arrays(bool, (1, 5, 5), elements=st.sampled_from([False, False, True]))


@settings(max_examples=100, deadline=None)
@given(hazard=maps)
def test_bfs_is_the_shortest_on_a_map_that_stands_still(hazard):
    hazard[0, 0, 0] = False
    problem = StagedProblem(hazard, StageClock(0.0, 1, 30), Weights())
    route = PEERS["bfs"].find(problem, (0, 0), (4, 4))
    expected = distance_on_first_map(problem, (0, 0), (4, 4))
    assert (route.arrival_step if route.found else None) == expected
    assert first_breach(problem, (0, 0), (4, 4), route) is None


@pytest.mark.parametrize("name", ["bfs", "dijkstra"])
def test_does_not_wait_for_a_door(name, door):
    route = PEERS[name].find(door.problem, door.start, door.goal)
    assert route.reason == "no way on the first stage's map"


@pytest.mark.parametrize("name", ["bfs", "dijkstra"])
def test_flies_into_a_gap_that_has_shut(name, shutter):
    route = PEERS[name].find(shutter.problem, shutter.start, shutter.goal)
    assert route.found
    assert "is in hazard" in first_breach(shutter.problem, shutter.start, shutter.goal, route)


def test_bfs_takes_the_straight_way_and_dijkstra_keeps_clear(world):
    hazard = np.zeros((2, 9, 30), dtype=bool)
    hazard[:, 3, 2:28] = True  # a wall beside the straight way
    problem, start, goal = world(hazard, steps=30), (4, 0), (4, 29)
    bfs, dijkstra = (PEERS[name].find(problem, start, goal) for name in ("bfs", "dijkstra"))
    clearance = clearance_cells(hazard, 4.0)[0]
    assert bfs.arrival_step == 29
    mean = [np.mean([clearance[cell] for cell in route.cells]) for route in (bfs, dijkstra)]
    assert mean[1] > mean[0] + 1.0
    assert dijkstra.arrival_step > bfs.arrival_step


@pytest.mark.parametrize("name", ["bfs", "dijkstra"])
def test_a_way_longer_than_the_horizon_is_refused(name, world):
    route = PEERS[name].find(world(np.zeros((1, 3, 9), dtype=bool)), (0, 0), (2, 8))
    assert "of 10 moves does not fit the horizon of 4 steps" in route.reason
