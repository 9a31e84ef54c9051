"""Systems that search in time: which of them wait, and which come back."""

import numpy as np
import pytest

from planner.peers import PEERS, astar_steps, depth_first
from planner.peers.breach import first_breach

WORLDS = ["still", "door", "shutter", "siding"]
COMPLETE = ["dfs", "astar-steps", "paper", "staged"]


@pytest.fixture(params=WORLDS)
def any_world(request):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize("name", COMPLETE)
def test_complete_systems_find_a_way_through_every_world(name, any_world):
    world = any_world
    route = PEERS[name].find(world.problem, world.start, world.goal)
    assert route.found, route.reason
    assert first_breach(world.problem, world.start, world.goal, route) is None
    assert route.arrival_step >= world.optimum


@pytest.mark.parametrize("name", ["astar-steps", "staged"])
def test_optimal_systems_arrive_as_early_as_can_be(name, any_world):
    route = PEERS[name].find(any_world.problem, any_world.start, any_world.goal)
    assert route.arrival_step == any_world.optimum


def test_depth_first_arrives_late(still):
    route = PEERS["dfs"].find(still.problem, still.start, still.goal)
    assert route.arrival_step > still.optimum


def test_the_siding_must_be_left_and_entered_again(siding):
    route = PEERS["astar-steps"].find(siding.problem, siding.start, siding.goal)
    assert route.cells.count((0, 1)) >= 2
    assert (1, 1) in route.cells


@pytest.mark.parametrize("name", ["door", "siding"])
def test_a_closed_list_of_cells_misses_goals_that_need_waiting(name, request):
    world = request.getfixturevalue(name)
    route = PEERS["astar-cells"].find(world.problem, world.start, world.goal)
    assert not route.found
    assert "closed cells" in route.reason


def test_a_closed_list_of_cells_is_late_where_waiting_is_quicker(world):
    hazard = np.zeros((8, 9, 7), dtype=bool)
    hazard[:, 0:7, 3] = True  # a wall, open in the north
    hazard[1:, 0, 3] = False  # and from the second stage in the south
    problem = world(hazard)
    closed, open_list = (PEERS[name].find(problem, (0, 1), (0, 5)) for name in ("astar-cells", "astar-steps"))
    assert open_list.arrival_step == 5 + 3
    assert closed.arrival_step == 4 + 2 * 7
    assert first_breach(problem, (0, 1), (0, 5), closed) is None


def test_a_closed_list_of_cells_does_where_nothing_changes(still):
    route = PEERS["astar-cells"].find(still.problem, still.start, still.goal)
    assert route.arrival_step == still.optimum


@pytest.mark.parametrize(("name", "module"), [("dfs", depth_first), ("astar-steps", astar_steps)])
def test_gives_up_rather_than_search_for_ever(name, module, door, monkeypatch):
    monkeypatch.setattr(module, "EXPANSION_LIMIT", 10)
    route = PEERS[name].find(door.problem, door.start, door.goal)
    assert "gave up" in route.reason


def test_the_papers_planner_spends_time_on_a_better_score(shutter):
    route = PEERS["paper"].find(shutter.problem, shutter.start, shutter.goal)
    assert route.arrival_step >= shutter.optimum
