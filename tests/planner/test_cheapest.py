"""The sweep over labels against a heap that lists every label no other dominates, in plain Python."""

import heapq
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.air import Air, Chart
from planner.cheapest import sweep
from planner.earliest import sweep as sweep_earliest
from planner.edges import Edges, TimedProblem
from planner.grid import Grid
from planner.hazards import StageClock
from planner.intervals import MARGIN, SafeIntervals
from planner.moves import Moves
from planner.price import Price, framed

AIRSPEED_MPS = 27.0
STEP_RAD = 3600.0 / 6_371_000.0


def world(seed, share=0.2):
    """A small problem, its hazard, and a price with a rate from 0 to 1 in each cell and stage."""
    random = np.random.default_rng(seed)
    stages, rows, columns = (int(random.integers(*ends)) for ends in ((1, 4), (2, 6), (2, 6)))
    hazard = random.random((stages, rows, columns)) < share
    hazard[0, 0, 0] = False
    clock = StageClock(0.0, stages, int(random.integers(3, 7)), 120.0)
    time_s = np.arange(stages + 1) * clock.stage_s
    speed = 12.0 * np.sqrt(random.random((time_s.size, rows, columns)))
    wind_mps = (speed * np.exp(2j * np.pi * random.random(speed.shape))).astype(np.complex64)
    grid = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, rows, columns)
    problem = TimedProblem(
        SafeIntervals.of(hazard),
        clock,
        Air(time_s, wind_mps),
        Moves.on(Chart.of(grid)),
        AIRSPEED_MPS,
        AIRSPEED_MPS + 12.1,
    )
    price = Price(1e-9, rate=random.random(hazard.shape) ** 2 / 100.0, enough=1e-12)
    return problem, hazard, price


def everywhere(hazard):
    return list(np.ndindex(hazard.shape[1:]))


def never_late(hazard):
    return np.full(hazard.shape[1:], np.inf)


def waiting(rate, stage_s, since_s, integral):
    """The integral of who is in a cell from a time on, as a function of time."""
    corners = np.arange(len(rate) + 1) * stage_s
    total = np.concatenate([[0.0], np.cumsum(rate * stage_s)])
    before = np.interp(since_s, corners, total)
    return lambda time_s: integral + np.interp(time_s, corners, total) - before


def by_heap(problem, hazard, price):
    """The least integral with which each cell can be reached, waits ending when a stage begins.

    A label goes if another was in the same cell before, and to have waited there is no dearer.
    """
    edges, intervals, clock = Edges(problem), problem.intervals, problem.clock
    rate = framed(price.rate, MARGIN)
    joints = []
    for stage in range(clock.stage_count):
        edges.enter(stage)
        joints.append(edges.joint)
    heap, least, since = [(0.0, 0.0, intervals.place_of(0, 0), False)], {}, {}
    while heap:
        time_s, integral, place, has_waited = heapq.heappop(heap)
        stage = clock.stage_at(time_s)
        run = int(intervals.run[stage, place])
        if not has_waited and run in since and since[run](time_s) <= integral:
            continue
        since[run] = waiting(rate[:, place], clock.stage_s, time_s, integral)
        least[place] = min(least.get(place, math.inf), integral)
        edges.stage, edges.joint = stage, joints[stage]
        moves = np.flatnonzero(edges.joint[:, place] > 0)
        places, departs = np.full(moves.size, place), np.full(moves.size, time_s)
        for move, arrive_s in zip(moves, edges.fly(places, moves, departs, stage), strict=True):
            if np.isfinite(arrive_s):
                target = place + edges.shift[move]
                there = int(arrive_s / clock.stage_s)
                spent = integral + 0.5 * (rate[stage, place] + rate[there, target]) * (arrive_s - time_s)
                heapq.heappush(heap, (float(arrive_s), float(spent), int(target), False))
        begin_s = (stage + 1) * clock.stage_s
        if intervals.run_end[stage, place] > stage + 1:
            spent = integral + rate[stage, place] * (begin_s - time_s)
            heapq.heappush(heap, (begin_s, float(spent), place, True))
    return {intervals.cell_of(place): spent for place, spent in least.items()}


def test_prices_are_never_below_those_of_the_heap_and_seldom_above():
    """One label a bucket loses a cell where only its earliest arrival came through a closing door."""
    reached = missed = 0
    ours_sum = theirs_sum = 0.0
    for seed in range(40):
        problem, hazard, price = world(seed)
        theirs = by_heap(problem, hazard, price)
        found = sweep(problem, price, (0, 0), everywhere(hazard), never_late(hazard), math.inf)
        ours = {cell: at.integral.min() for cell, at in found.arrivals.items() if at.label.size}
        assert ours.keys() <= theirs.keys()
        assert all(spent >= theirs[cell] * (1.0 - 1e-6) - 1e-9 for cell, spent in ours.items())
        reached += len(theirs)
        missed += len(theirs) - len(ours)
        ours_sum += sum(ours.values())
        theirs_sum += sum(theirs[cell] for cell in ours)
    assert missed <= 0.02 * reached
    assert ours_sum <= 1.02 * theirs_sum


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_price_of_time_gives_the_earliest_arrivals(seed):
    problem, hazard, _ = world(seed)
    soonest = sweep_earliest(problem, (0, 0))
    even = Price(0.0, rate=np.ones(hazard.shape), enough=1e-6)
    found = sweep(problem, even, (0, 0), everywhere(hazard), never_late(hazard), math.inf)
    for cell, at in found.arrivals.items():
        state = soonest.best_state(cell)
        assert (state is None) == (not at.label.size)
        if state is not None:
            assert at.time_s.min() == pytest.approx(soonest.arrive_s[state], rel=1e-9)
            assert at.integral.min() == pytest.approx(at.time_s.min(), rel=1e-9)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_labels_are_the_sums_along_their_ways_through_safe_cells(seed):
    problem, hazard, price = world(seed)
    found = sweep(problem, price, (0, 0), everywhere(hazard), never_late(hazard), math.inf)
    stage_s = problem.clock.stage_s

    def rate_at(cell, time_s):
        return price.rate[(int(time_s // stage_s), *cell)]

    for cell, at in found.arrivals.items():
        for label, integral in zip(at.label.tolist(), at.integral.tolist(), strict=True):
            nodes = found.nodes_to(label, stage_s)
            assert (nodes[0].cell, nodes[-1].cell) == ((0, 0), cell)
            total = 0.0
            for here, there in pairwise(nodes):
                assert here.safe_from_s <= here.arrive_s <= here.leave_s < here.safe_until_s
                borders_s = [stage_s * stage for stage in range(1, len(hazard))]
                cuts = [cut for cut in borders_s if here.arrive_s < cut < here.leave_s]
                for begin_s, end_s in pairwise([here.arrive_s, *cuts, here.leave_s]):
                    total += rate_at(here.cell, 0.5 * (begin_s + end_s)) * (end_s - begin_s)
                ends = rate_at(here.cell, here.leave_s), rate_at(there.cell, there.arrive_s)
                total += 0.5 * sum(ends) * (there.arrive_s - here.leave_s)
            assert integral == pytest.approx(total, rel=1e-9)


def test_limits_cut_off_what_is_of_no_use():
    problem, hazard, price = world(5, share=0.0)
    cells = everywhere(hazard)
    whole = sweep(problem, price, (0, 0), cells, never_late(hazard), math.inf)
    most = np.median([at.integral.min() for at in whole.arrivals.values()])
    cheap = sweep(problem, price, (0, 0), cells, never_late(hazard), most)
    soon = sweep(problem, price, (0, 0), cells, np.full(hazard.shape[1:], 300.0), math.inf)
    for cell, at in whole.arrivals.items():
        assert (cheap.arrivals[cell].integral <= most).all()
        assert (soon.arrivals[cell].time_s <= 300.0).all()
        if at.integral.min() <= most:
            assert cheap.arrivals[cell].integral.min() == pytest.approx(at.integral.min())
