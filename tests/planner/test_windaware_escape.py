"""The nearest way out of hazard at the fastest airspeed, against Dijkstra's algorithm in plain Python."""

from __future__ import annotations

import heapq
import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.closures import Closures
from planner.grid import Grid, geodesic_m
from planner.hazards import Bools, StageClock
from planner.passage import Spot
from planner.place import Place
from planner.planning import PlanningRequest
from planner.plans import Waypoint
from planner.way import Cell
from planner.windaware_escape import Escape, escape
from planner.windaware_replanning import WindawareProspect
from planner.windfield import WindField

STEP_DEG = 0.0324
GRID = Grid(math.radians(25.0), math.radians(-85.0), *[math.radians(STEP_DEG)] * 2, 6, 6)
CLOCK = StageClock(0.0, stage_count=4, steps_per_stage=5, step_s=120.0)
HORIZON_S = CLOCK.stage_count * CLOCK.stage_s
SLOWEST_MPS, CRUISE_MPS, FASTEST_MPS, WAIT_MIN_S = 22.0, 27.0, 38.0, 120.0
HERE = (2, 3)
EVERYWHERE = slice(None)


def place(name: str, cell: Cell) -> Place:
    return Place(name, 25.0 + cell[0] * STEP_DEG, -85.0 + cell[1] * STEP_DEG)


REQUEST = PlanningRequest(
    start=place("Here", HERE),
    goals=(place("There", (5, 5)),),
    goal="There",
    altitude_m=1000.0,
    clock=CLOCK,
    threshold_mps=15.0,
    corridor_m=1000.0,
    airspeed_min_mps=SLOWEST_MPS,
    airspeed_max_mps=FASTEST_MPS,
    objective="earliest",
    cruise_mps=CRUISE_MPS,
    wait_min_s=WAIT_MIN_S,
)


def out_of(closed: Bools, begin_s: float, spot: Spot = HERE, wind_mps: complex = 0j) -> Escape | None:
    """The way out where some cells are closed, and the wind is the same everywhere."""
    wind = np.full((CLOCK.stage_count + 1, *GRID.shape), wind_mps)
    time_s = CLOCK.stage_s * np.arange(len(wind))
    field = WindField(GRID, time_s, wind.real.copy(), wind.imag.copy())
    search = WindawareProspect.of(field, replace(REQUEST, closures=Closures(closed.copy()))).search
    at = place("", HERE)
    lat_deg, lon_deg = (
        at.lat_deg + (spot[0] - HERE[0]) * STEP_DEG,
        at.lon_deg + (spot[1] - HERE[1]) * STEP_DEG,
    )
    first = Waypoint(lat_deg, lon_deg, 1000.0, begin_s, CLOCK.stage_at(begin_s))
    return escape(search, GRID, spot, first)


def neighbours(cell: Cell) -> list[tuple[Cell, float, list[Cell]]]:
    """The cells around, how far they are, and the cells that have to be safe on the way."""
    found = []
    for up, right in np.ndindex(3, 3):
        there = cell[0] + up - 1, cell[1] + right - 1
        if there == cell or not (0 <= there[0] < GRID.rows and 0 <= there[1] < GRID.columns):
            continue
        corners = [(row, column) for row in {cell[0], there[0]} for column in {cell[1], there[1]}]
        found.append((there, distance_m(cell, there), corners))
    return found


def distance_m(one: Cell, other: Cell) -> float:
    """From centre to centre."""
    ends = [(float(GRID.lat_rad[row]), float(GRID.lon_rad[column])) for row, column in (one, other)]
    return float(geodesic_m(*ends[0], *ends[1]))


def through(begin_s: float) -> dict[Cell, float]:
    """When each cell can be reached at the fastest airspeed, whatever is in it."""
    arrive_s = {HERE: begin_s}
    heap = [(begin_s, HERE)]
    while heap:
        now_s, cell = heapq.heappop(heap)
        for there, length_m, _ in neighbours(cell) if now_s == arrive_s[cell] else ():
            then_s = now_s + length_m / FASTEST_MPS
            if then_s < arrive_s.get(there, math.inf):
                arrive_s[there] = then_s
                heapq.heappush(heap, (then_s, there))
    return arrive_s


def open_until(closed: Bools, cell: Cell, stage: int) -> int:
    """The first stage from one on in which a cell is closed."""
    while stage < CLOCK.stage_count and not closed[(stage, *cell)]:
        stage += 1
    return stage


def can_stay(closed: Bools, cell: Cell, from_s: float, until_s: float) -> bool:
    """Whether safe moves at cruise, and waits, lead from a safe cell to one that is open until a time."""
    heap, done = [(from_s, cell)], set()
    while heap:
        now_s, here = heapq.heappop(heap)
        end = open_until(closed, here, int(now_s // CLOCK.stage_s))
        if (here, end) in done:
            continue
        done.add((here, end))
        if end * CLOCK.stage_s >= until_s and now_s + WAIT_MIN_S + CLOCK.step_s <= end * CLOCK.stage_s:
            return True
        begins = [stage * CLOCK.stage_s for stage in range(CLOCK.stage_count)]
        for there, length_m, corners in neighbours(here):
            for leave_s in [now_s, *(s for s in begins if now_s < s < end * CLOCK.stage_s)]:
                then_s = leave_s + length_m / CRUISE_MPS
                stage = int(leave_s // CLOCK.stage_s)
                if all(then_s < open_until(closed, corner, stage) * CLOCK.stage_s for corner in corners):
                    heapq.heappush(heap, (then_s, there))
    return False


def exits(closed: Bools, begin_s: float) -> dict[Cell, list[float]]:
    """When each cell can be entered, open, so that one is out for good."""
    found: dict[Cell, list[float]] = {}
    for cell, arrive_s in through(begin_s).items():
        for stage in range(CLOCK.stage_count):
            exit_s = max(arrive_s, stage * CLOCK.stage_s)
            begins = not closed[(stage, *cell)] and (stage == 0 or closed[(stage - 1, *cell)])
            if not begins or exit_s >= open_until(closed, cell, stage) * CLOCK.stage_s:
                continue
            direct_m = distance_m(HERE, cell)
            early_s = exit_s - begin_s - direct_m / FASTEST_MPS
            if 0.0 < early_s < WAIT_MIN_S and begin_s + direct_m / SLOWEST_MPS < exit_s:
                continue  # neither to be waited for nor to be flown slowly enough for
            known_s = (exit_s // CLOCK.stage_s + 1) * CLOCK.stage_s + 2 * CLOCK.step_s
            if can_stay(closed, cell, exit_s, min(known_s, HORIZON_S)):
                found.setdefault(cell, []).append(exit_s)
    return found


@settings(max_examples=120, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1500.0))
def test_nobody_is_sooner_out_of_hazard_for_good(seed: int, begin_s: float) -> None:
    random = np.random.default_rng(seed)
    closed = random.random((CLOCK.stage_count, *GRID.shape)) < random.uniform(0.5, 0.95)
    closed[(CLOCK.stage_at(begin_s), *HERE)] = True
    way, by_hand = out_of(closed, begin_s), exits(closed, begin_s)
    if not by_hand:
        assert way is None
        return
    assert way is not None
    soonest_s = min(time_s for times_s in by_hand.values() for time_s in times_s)
    assert way.exit.time_s <= soonest_s + 1.0
    assert way.cell in by_hand
    assert way.points[0].time_s == begin_s
    speeds = [
        float(geodesic_m(*np.radians([a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg]))) / (b.time_s - a.time_s)
        for a, b in pairwise(way.points)
    ]
    assert all(SLOWEST_MPS * 0.999 < speed < FASTEST_MPS * 1.001 or speed < 1e-6 for speed in speeds)
    known_s = (way.exit.time_s // CLOCK.stage_s + 1) * CLOCK.stage_s + 2 * CLOCK.step_s
    assert can_stay(closed, way.cell, way.exit.time_s, min(known_s, HORIZON_S))
    last = way.points[-1]
    assert (last.lat_deg, last.lon_deg) == pytest.approx(
        (place("", way.cell).lat_deg, place("", way.cell).lon_deg)
    )


def walled(*open_to: tuple[int, Cell]) -> Bools:
    """Closed everywhere, but for cells from a stage on."""
    closed = np.ones((CLOCK.stage_count, *GRID.shape), dtype=np.bool_)
    for stage, cell in open_to:
        closed[(slice(stage, None), *cell)] = False
    return closed


def test_wind_decides_which_way_is_the_nearest() -> None:
    closed = walled((0, (2, 0)), (0, (2, 5)))
    eastward = out_of(closed, 0.0)
    assert eastward is not None
    assert eastward.cell == (2, 5)
    westward = out_of(closed, 0.0, wind_mps=-14j)
    assert westward is not None
    assert westward.cell == (2, 0)
    assert westward.exit.time_s < 3 * 3600.0 / 45.0


def test_wind_that_the_aircraft_makes_no_headway_against_is_not_flown_through() -> None:
    assert out_of(walled((0, (2, 5))), 0.0, wind_mps=0.98 * FASTEST_MPS + 0j) is None


def test_from_between_cells_it_begins_with_a_passage() -> None:
    spot = (2.0, 3.4)
    way = out_of(walled((0, (2, 5))), 30.0, spot)
    assert way is not None
    assert way.cell == (2, 5)
    assert way.points[0].lon_deg == pytest.approx(place("", HERE).lon_deg + 0.4 * STEP_DEG)
    straight_m = 1.6 * math.radians(STEP_DEG) * 6_378_137.0 * math.cos(math.radians(25.0))
    assert way.length_m == pytest.approx(straight_m, rel=5e-3)
    assert way.exit.time_s == pytest.approx(30.0 + way.length_m / FASTEST_MPS, abs=0.5)


def test_it_waits_where_hazard_passes_sooner_than_it_could_be_left() -> None:
    way = out_of(walled((1, HERE)), 300.0)
    assert way is not None
    assert (way.cell, way.length_m) == (HERE, 0.0)
    assert [point.time_s for point in way.points] == [300.0, 600.0]


def test_a_cell_that_closes_again_is_no_way_out_unless_another_is_reached_from_it() -> None:
    closed = walled((0, (2, 0)))
    closed[0, 2, 4] = False
    away = out_of(closed, 100.0)
    assert away is not None
    assert away.cell == (2, 0)
    closed[:, 3, 4] = False
    closed[0, 2, 5] = closed[0, 3, 5] = False
    beside = out_of(closed, 100.0)
    assert beside is not None
    assert beside.cell == (2, 4)


def test_where_nothing_is_open_there_is_no_way_out() -> None:
    assert out_of(walled(), 0.0) is None
