"""What every system in the table promises: valid answers, the same every time, and no more than it claims."""

import inspect

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from planner.hazards import Move
from planner.peers import PEERS, genetic
from planner.peers.breach import first_breach
from planner.staged import Occupancy, search

SAMPLING = {"prm": "ompl", "rrt": "ompl", "rrt-star": "ompl", "rrt-time": "ompl", "genetic": "pygad"}


@pytest.fixture(params=list(PEERS))
def name(request):
    if request.param in SAMPLING:
        pytest.importorskip(SAMPLING[request.param])
    return request.param


@pytest.fixture(autouse=True)
def few_generations(monkeypatch):
    monkeypatch.setattr(genetic, "GENERATIONS", 15)


def test_takes_the_one_call(name):
    signature = inspect.signature(PEERS[name].find)
    assert list(signature.parameters) == ["problem", "start", "goal", "seed"]
    assert signature.parameters["seed"].kind is inspect.Parameter.KEYWORD_ONLY


def test_without_hazard_all_arrive_within_the_rules(name, world):
    problem = world(np.zeros((8, 7, 9), dtype=bool))
    route = PEERS[name].find(problem, (1, 1), (5, 7), seed=1)
    assert route.found, route.reason
    assert first_breach(problem, (1, 1), (5, 7), route) is None
    assert route.arrival_step >= np.hypot(4, 6) - 0.5
    if PEERS[name].optimal:
        assert route.arrival_step == 10


def test_a_still_wall_is_flown_around(name, still):
    route = PEERS[name].find(still.problem, still.start, still.goal, seed=1)
    if name != "genetic":  # with few generations it may still fly through
        assert route.found, route.reason
    assert first_breach(still.problem, still.start, still.goal, route) is None


def test_the_same_seed_gives_the_same_route(name, still):
    first, second = (PEERS[name].find(still.problem, still.start, still.goal, seed=3) for _ in range(2))
    assert first == second


def test_a_start_in_hazard_has_no_route(name, world):
    hazard = np.zeros((2, 3, 3), dtype=bool)
    hazard[0, 0, 0] = True
    route = PEERS[name].find(world(hazard), (0, 0), (2, 2))
    assert not route.found
    assert "start" in route.reason


def test_a_goal_behind_hazard_for_ever_has_no_route(name, world):
    hazard = np.zeros((3, 3, 5), dtype=bool)
    hazard[:, :, 3] = True
    route = PEERS[name].find(world(hazard), (0, 0), (2, 4))
    assert not route.found
    assert route.reason


@pytest.mark.parametrize("shape", [(1, 1, 1), (3, 4, 4)])
def test_being_there_already_takes_no_time(name, world, shape):
    route = PEERS[name].find(world(np.zeros(shape, dtype=bool)), (0, 0), (0, 0))
    assert route.arrival_step == 0


cases = st.tuples(
    hnp.arrays(
        bool,
        st.tuples(st.integers(1, 4), st.integers(1, 5), st.integers(1, 5)),
        elements=st.sampled_from([False, False, True]),
    ),
    st.integers(1, 4),
    st.sampled_from(Occupancy),
    st.booleans(),
    st.integers(0, 2**32 - 1),
)


def problem_of(case, world):
    """A random problem with start and goal; half of them with moves that cannot be flown."""
    hazard, steps, occupancy, windy, lot = case
    lots = np.random.default_rng(lot)
    flyable = None
    if windy:
        flyable = lots.random((len(hazard), len(Move), *hazard.shape[1:])) < 0.8
        flyable[:, Move.STAY] = True
    start, goal = (tuple(int(lots.integers(size)) for size in hazard.shape[1:]) for _ in range(2))
    return world(hazard, steps, occupancy, flyable), start, goal


@pytest.mark.parametrize("optimal", [name for name, peer in PEERS.items() if peer.optimal])
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(case=cases)
def test_those_claimed_optimal_arrive_with_the_staged_search(optimal, world, case):
    problem, start, goal = problem_of(case, world)
    route = PEERS[optimal].find(problem, start, goal)
    (found,) = search(problem, start, [goal])
    assert route.found == (found.earliest is not None)
    assert first_breach(problem, start, goal, route) is None
    if found.earliest:
        assert route.arrival_step == found.earliest.arrival_step


ON_CELLS = [name for name in PEERS if name not in SAMPLING]
KEEPS_RULES = [
    name for name in ON_CELLS if PEERS[name].time_dependent or name in ("replanning", "dstar-lite")
]


@pytest.mark.parametrize("peer", KEEPS_RULES)
@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(case=cases)
def test_systems_that_test_every_step_break_no_rule_and_are_never_early(peer, world, case):
    problem, start, goal = problem_of(case, world)
    route = PEERS[peer].find(problem, start, goal)
    assert first_breach(problem, start, goal, route) is None
    (found,) = search(problem, start, [goal])
    if route.found:
        assert found.earliest is not None
        assert route.arrival_step >= found.earliest.arrival_step


@pytest.mark.parametrize("peer", ["genetic", "rrt-time"])
@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(case=cases)
def test_systems_that_draw_lots_break_no_rule_either(peer, world, case):
    pytest.importorskip(SAMPLING[peer])
    problem, start, goal = problem_of(case, world)
    route = PEERS[peer].find(problem, start, goal)
    assert first_breach(problem, start, goal, route) is None
