"""The sweep in buckets against Dijkstra's algorithm with a heap over (cell, interval), in plain Python."""

import heapq
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.air import Air, Chart
from planner.earliest import sweep
from planner.edges import TimedProblem
from planner.errors import PlannerError
from planner.grid import Grid, geodesic_m
from planner.hazards import StageClock
from planner.intervals import SafeIntervals
from planner.moves import Moves

AIRSPEED_MPS = 27.0
WIND_MAX_MPS = 15.0
STEP_RAD = 3600.0 / 6_371_000.0


def problem_of(seed, share, neighbours=8):
    """A small world with random hazard and wind; edges take about half a stage to a whole one."""
    random = np.random.default_rng(seed)
    stages, rows, columns = (int(random.integers(*ends)) for ends in ((1, 5), (2, 7), (2, 7)))
    hazard = random.random((stages, rows, columns)) < share
    hazard[0, 0, 0] = False
    clock = StageClock(0.0, stages, int(random.integers(2, 5)), 120.0)
    time_s = np.union1d(
        np.arange(stages + 1) * clock.stage_s,
        random.uniform(0.0, stages * clock.stage_s, int(random.integers(3))),
    )
    speed = WIND_MAX_MPS * np.sqrt(random.random((time_s.size, rows, columns)))
    wind_mps = (speed * np.exp(2j * np.pi * random.random(speed.shape))).astype(np.complex64)
    grid = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, rows, columns)
    return (
        TimedProblem(
            SafeIntervals.of(hazard),
            clock,
            Air(time_s, wind_mps),
            Moves.on(Chart.of(grid), neighbours),
            AIRSPEED_MPS,
            AIRSPEED_MPS + WIND_MAX_MPS + 0.1,
        ),
        hazard,
        grid,
    )


def edge_arrival(problem, grid, here, there, depart_s):
    """By halving, on the integral of a speed that is linear in time between the air's times."""
    (r0, c0), (r1, c1) = here, there
    plane = grid.frame.to_plane(grid.lat_rad[[r0, r1]], grid.lon_rad[[c0, c1]])
    course = math.atan2(plane[1][1] - plane[1][0], plane[0][1] - plane[0][0])
    length_m = geodesic_m(grid.lat_rad[r0], grid.lon_rad[c0], grid.lat_rad[r1], grid.lon_rad[c1])
    speeds = []
    for sheet in problem.air.wind_mps:
        wind = 0.5 * (complex(sheet[here]) + complex(sheet[there]))
        along = wind.real * math.cos(course) + wind.imag * math.sin(course)
        across = wind.imag * math.cos(course) - wind.real * math.sin(course)
        speeds.append(along + math.sqrt(AIRSPEED_MPS**2 - across**2))
    time_s = problem.air.time_s

    def covered_m(until_s):
        corners = [depart_s, *time_s[(time_s > depart_s) & (time_s < until_s)], until_s]
        return np.trapezoid(np.interp(corners, time_s, speeds), corners)

    low, high = depart_s, float(time_s[-1])
    if covered_m(high) < length_m:
        return math.inf
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if covered_m(middle) < length_m else (low, middle)
    return high


def by_heap(problem, hazard, grid):
    """Earliest arrival of every (cell, first stage of the interval)."""
    stages, stage_s = len(hazard), problem.clock.stage_s

    def first_stage(cell, stage):
        while stage > 0 and not hazard[(stage - 1, *cell)]:
            stage -= 1
        return stage

    def run_end(cells, stage):
        while stage < stages and not any(hazard[(stage, *cell)] for cell in cells):
            stage += 1
        return stage

    arrive = {((0, 0), 0): 0.0}
    heap = [(0.0, (0, 0), 0)]
    done = set()
    while heap:
        now_s, here, began = heapq.heappop(heap)
        if (here, began) in done:
            continue
        done.add((here, began))
        for rows, columns in problem.moves.offsets:
            there = here[0] + rows, here[1] + columns
            if not (0 <= there[0] < grid.rows and 0 <= there[1] < grid.columns):
                continue
            box = [
                (row, column)
                for row in range(min(here[0], there[0]), max(here[0], there[0]) + 1)
                for column in range(min(here[1], there[1]), max(here[1], there[1]) + 1)
            ]
            for stage in range(int(now_s // stage_s), run_end([here], began)):
                depart_s = max(now_s, stage * stage_s)
                arrive_s = edge_arrival(problem, grid, here, there, depart_s)
                if arrive_s < run_end(box, stage) * stage_s and run_end(box, stage) > stage:
                    state = there, first_stage(there, stage)
                    if arrive_s < arrive.get(state, math.inf):
                        arrive[state] = arrive_s
                        heapq.heappush(heap, (arrive_s, *state))
    return arrive


@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    share=st.sampled_from([0.0, 0.2, 0.4, 0.6]),
    neighbours=st.sampled_from([4, 8, 16]),
)
def test_arrivals_are_those_of_the_heap(seed, share, neighbours):
    problem, hazard, grid = problem_of(seed, share, neighbours)
    found = sweep(problem, (0, 0))
    intervals = found.intervals
    ours = {
        (intervals.cell_of(int(intervals.place[state])), int(intervals.begin[state])): found.arrive_s[state]
        for state in np.flatnonzero(np.isfinite(found.arrive_s))
    }
    theirs = by_heap(problem, hazard, grid)
    horizon_s = len(hazard) * problem.clock.stage_s
    ends_s = {key: value for key, value in theirs.items() if value < horizon_s}
    assert ours.keys() == ends_s.keys()
    for state, arrive_s in ours.items():
        assert arrive_s == pytest.approx(theirs[state], rel=2e-5)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), share=st.sampled_from([0.1, 0.3]), more=st.sampled_from([0.05, 0.3]))
def test_more_hazard_never_brings_an_arrival_forward(seed, share, more):
    problem, hazard, _ = problem_of(seed, share)
    worse = hazard | (np.random.default_rng(seed + 1).random(hazard.shape) < more)
    worse[0, 0, 0] = False
    harder = TimedProblem(
        SafeIntervals.of(worse),
        problem.clock,
        problem.air,
        problem.moves,
        problem.airspeed_mps,
        problem.fastest_mps,
    )
    before, after = sweep(problem, (0, 0)), sweep(harder, (0, 0))
    for cell in np.ndindex(hazard.shape[1:]):
        states = [found.best_state(cell) for found in (before, after)]
        if states[1] is not None:
            assert states[0] is not None
            assert before.arrive_s[states[0]] <= after.arrive_s[states[1]]


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), share=st.sampled_from([0.2, 0.4]))
def test_ways_lead_from_the_start_in_order_of_time_through_safe_cells(seed, share):
    problem, hazard, _ = problem_of(seed, share)
    found = sweep(problem, (0, 0))
    intervals, stage_s = found.intervals, problem.clock.stage_s
    for state in np.flatnonzero(np.isfinite(found.arrive_s)).tolist():
        way = found.states_to(state)
        assert intervals.cell_of(int(intervals.place[way[0]])) == (0, 0)
        for before, after in pairwise(way):
            assert found.arrive_s[before] <= found.leave_s[after] < found.arrive_s[after]
            occupied = range(int(found.arrive_s[before] // stage_s), int(found.leave_s[after] // stage_s) + 1)
            assert not any(hazard[(at, *intervals.cell_of(int(intervals.place[before])))] for at in occupied)


def test_stopping_at_goals_changes_nothing_for_them():
    problem, hazard, _ = problem_of(11, 0.2)
    whole = sweep(problem, (0, 0))
    for cell in np.ndindex(hazard.shape[1:]):
        best = whole.best_state(cell)
        found = sweep(problem, (0, 0), [cell])
        assert found.best_state(cell) == best
        if best is not None:
            assert found.arrive_s[best] == whole.arrive_s[best]


def test_other_numbers_of_neighbours_are_refused():
    with pytest.raises(PlannerError, match="4, 8 or 16 neighbours, not 6"):
        problem_of(0, 0.0, neighbours=6)
