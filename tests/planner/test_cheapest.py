"""The sweep over labels against a heap that lists every label no other dominates, in plain Python."""

import heapq
import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.air import Air, Chart
from planner.cheapest import sweep
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


def by_heap(problem, hazard, price):
    """The least integral with which each cell can be reached, waits ending when a stage begins.

    A label goes if another in the same cell was there before and had spent less.
    """
    edges, intervals, clock = Edges(problem), problem.intervals, problem.clock
    rate = framed(price.rate, MARGIN)
    joints = []
    for stage in range(clock.stage_count):
        edges.enter(stage)
        joints.append(edges.joint)
    heap, least = [(0.0, 0.0, intervals.place_of(0, 0))], {}
    since = {}
    while heap:
        time_s, integral, place = heapq.heappop(heap)
        stage = clock.stage_at(time_s)
        run = int(intervals.run[stage, place])
        if since.get(run, math.inf) <= integral:
            continue
        since[run] = integral
        least[place] = min(least.get(place, math.inf), integral)
        edges.stage, edges.joint = stage, joints[stage]
        moves = np.flatnonzero(edges.joint[:, place] > 0)
        places, departs = np.full(moves.size, place), np.full(moves.size, time_s)
        for move, arrive_s in zip(moves, edges.fly(places, moves, departs, stage), strict=True):
            if np.isfinite(arrive_s):
                target = place + edges.shift[move]
                there = int(arrive_s / clock.stage_s)
                spent = integral + 0.5 * (rate[stage, place] + rate[there, target]) * (arrive_s - time_s)
                heapq.heappush(heap, (float(arrive_s), float(spent), int(target)))
        begin_s = (stage + 1) * clock.stage_s
        if intervals.run_end[stage, place] > stage + 1:
            spent = integral + rate[stage, place] * (begin_s - time_s)
            heapq.heappush(heap, (begin_s, spent - 1e-12, place))
            since[run] = math.inf
    return {intervals.cell_of(place): spent for place, spent in least.items()}


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_it_is_never_better_than_every_label_and_seldom_worse(seed):
    problem, hazard, price = world(seed)
    theirs = by_heap(problem, hazard, price)
    found = sweep(problem, price, (0, 0), everywhere(hazard), never_late(hazard), math.inf)
    ours = {cell: at.integral.min() for cell, at in found.arrivals.items() if at.label.size}
    assert ours.keys() == theirs.keys()
    for cell, spent in ours.items():
        assert theirs[cell] - 1e-9 <= spent
    assert sum(ours.values()) <= 1.02 * sum(theirs.values()) + 1e-9
