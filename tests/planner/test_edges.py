"""Edges in time: who leaves first arrives first, and no edge is shorter than a bucket."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.air import Air, Chart
from planner.edges import Edges, TimedProblem, buckets
from planner.grid import Grid
from planner.hazards import StageClock
from planner.intervals import SafeIntervals
from planner.moves import Moves

STEP_RAD = 3600.0 / 6_371_000.0
STAGES, ROWS, COLUMNS = 4, 5, 5


def open_problem(seed, neighbours=8, hazard=None):
    """No hazard, and wind of up to 15 m/s that has nothing to do with that an hour or a cell away."""
    random = np.random.default_rng(seed)
    clock = StageClock(0.0, STAGES, 30)
    time_s = np.arange(2 * STAGES + 1) * 1800.0
    speed = 15.0 * np.sqrt(random.random((time_s.size, ROWS, COLUMNS)))
    wind_mps = (speed * np.exp(2j * np.pi * random.random(speed.shape))).astype(np.complex64)
    grid = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, ROWS, COLUMNS)
    hazard = np.zeros((STAGES, ROWS, COLUMNS), dtype=bool) if hazard is None else hazard
    return TimedProblem(
        SafeIntervals.of(hazard),
        clock,
        Air(time_s, wind_mps),
        Moves.on(Chart.of(grid), neighbours),
        27.0,
        27.0 + 15.1,
    )


def arrivals(problem, depart_s):
    """Of every move from the middle, left at such times, shape (moves, times)."""
    edges, intervals = Edges(problem), problem.intervals
    edges.enter(0)
    found = []
    for move in range(len(problem.moves.offsets)):
        spans = np.searchsorted(problem.air.time_s, depart_s, side="right") - 1
        place = np.array([intervals.place_of(ROWS // 2, COLUMNS // 2)])
        found.append(
            [
                edges.fly(place, np.array([move]), np.array([left_s]), int(span))[0]
                for left_s, span in zip(depart_s.tolist(), spans, strict=True)
            ]
        )
    return np.array(found)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    neighbours=st.sampled_from([8, 16]),
    times=st.lists(st.floats(0.0, 3 * 3600.0), min_size=2, max_size=12, unique=True),
)
def test_who_leaves_first_arrives_first(seed, neighbours, times):
    depart_s = np.sort(np.array(times))
    found = arrivals(open_problem(seed, neighbours), depart_s)
    assert np.isfinite(found).all()
    assert (np.diff(found, axis=1) >= 0.0).all()
    apart = np.diff(depart_s) > 1e-3
    assert (np.diff(found, axis=1)[:, apart] > 0.0).all()


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), neighbours=st.sampled_from([8, 16]))
def test_no_edge_ends_in_the_bucket_in_which_it_is_left(seed, neighbours):
    problem = open_problem(seed, neighbours)
    timetable = list(buckets(problem))
    ends_s = np.array([end_s for _, _, end_s in timetable])
    assert set(problem.air.time_s[1:]) <= set(ends_s)
    depart_s = np.concatenate([[0.0], ends_s[:20:4]])
    bucket = np.searchsorted(ends_s, depart_s, side="right")
    assert (arrivals(problem, depart_s) >= ends_s[bucket]).all()


def test_an_edge_whose_cells_close_before_it_ends_cannot_be_flown():
    hazard = np.zeros((STAGES, ROWS, COLUMNS), dtype=bool)
    hazard[1, ROWS // 2 + 1, COLUMNS // 2] = True
    found = arrivals(open_problem(3, hazard=hazard), np.array([3000.0, 3599.0]))
    north = problem_move(1, 0)
    assert np.isfinite(found[north, 0])
    assert np.isinf(found[north, 1])
    assert np.isfinite(found[problem_move(-1, 0)]).all()


def problem_move(rows, columns):
    return open_problem(0).moves.offsets.index((rows, columns))


@pytest.mark.parametrize("guard_s", [0.0, 400.0])
def test_the_guard_asks_moves_to_end_earlier(guard_s):
    hazard = np.zeros((STAGES, ROWS, COLUMNS), dtype=bool)
    hazard[1, ROWS // 2 + 1, COLUMNS // 2] = True
    free = open_problem(3, hazard=hazard)
    guarded = TimedProblem(
        free.intervals, free.clock, free.air, free.moves, free.airspeed_mps, free.fastest_mps, guard_s
    )
    left_s = np.array([3000.0])
    expected = arrivals(free, left_s)[problem_move(1, 0), 0]
    found = arrivals(guarded, left_s)[problem_move(1, 0), 0]
    assert found == (expected if expected + guard_s < 3600.0 else np.inf)
