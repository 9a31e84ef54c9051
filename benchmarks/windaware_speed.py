"""The wind-aware planner's speed against the staged score search, on one world of the paper's size."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from planner_speed import STEPS, best_routes
from scipy import ndimage
from tables import duration, table
from timing import clocked, say
from worlds import Cell, start_and_goals

from planner.air import Air
from planner.earliest import sweep
from planner.edges import TimedProblem
from planner.grid import Grid
from planner.hazards import StageClock, hazard_stages
from planner.intervals import SafeIntervals
from planner.planning import Place, PlanningRequest
from planner.straighten import cell_by_cell, nodes_to
from planner.ways import WaySearch
from planner.windaware import way_search
from planner.windfield import WindField

TITLE = "The wind-aware planner"

ROWS, COLUMNS, STAGES = 548, 421, 18
THRESHOLD_MPS = 15.0
CELL_RAD = 3600.0 / 6_371_000.0


class Row(NamedTuple):
    """One measurement: what was done, its processor time, and that over the score search's."""

    name: str
    took_s: float
    ratio: float


def gusty_patches(seed: int = 3) -> WindField:
    """Wind in every hour that is above the threshold in drifting patches, and below it elsewhere."""
    random = np.random.default_rng(seed)
    noise = random.standard_normal((STAGES + 7, ROWS, COLUMNS))
    smooth = ndimage.gaussian_filter(noise, (1.5, 14, 14), mode="wrap")[3:-3]
    turn = ndimage.gaussian_filter(random.standard_normal((ROWS, COLUMNS)), 40, mode="wrap")
    turn /= turn.std()
    shares = 0.17 + 0.1 * np.sin(2.0 * np.pi * np.arange(STAGES + 1) / 9.0)
    north, east = np.empty((2, STAGES + 1, ROWS, COLUMNS), dtype=np.float32)
    for at, (sheet, share) in enumerate(zip(smooth, shares, strict=True)):
        over = (sheet - np.quantile(sheet, 1.0 - share)) / sheet.std()
        speed = np.clip(THRESHOLD_MPS * np.exp(0.4 * over), 0.0, 2.0 * THRESHOLD_MPS)
        north[at], east[at] = speed * np.cos(turn), speed * np.sin(turn)
    grid = Grid(np.radians(20.0), np.radians(-90.0), CELL_RAD, CELL_RAD, ROWS, COLUMNS)
    return WindField(grid, np.arange(STAGES + 1) * 3600.0, north, east)


def way_search_of(wind: WindField, start: Cell, goals: list[Cell]) -> WaySearch:
    lat_deg, lon_deg = np.degrees(wind.grid.lat_rad), np.degrees(wind.grid.lon_rad)

    def place(name: str, cell: Cell) -> Place:
        return Place(name, float(lat_deg[cell[0]]), float(lon_deg[cell[1]]))

    request = PlanningRequest(
        start=place("start", start),
        goals=tuple(place(str(number), goal) for number, goal in enumerate(goals)),
        goal="0",
        altitude_m=1000.0,
        clock=StageClock(0.0, STAGES, STEPS),
        threshold_mps=THRESHOLD_MPS,
        corridor_m=0.0,
        airspeed_min_mps=22.0,
        airspeed_max_mps=39.0,
        objective="earliest",
        cruise_mps=27.0,
    )
    return way_search(wind, request)


def earliest_routes(wind: WindField, search: WaySearch) -> int:
    """Intervals, air, sweep and the route of each goal, from cell to cell; how many were found."""
    clock = search.request.clock
    intervals, air = SafeIntervals.of(search.hazard), Air.over(wind, clock)
    airspeed_mps = search.cruise_mps
    fastest_mps = airspeed_mps + search.strongest_mps + 0.1
    problem = TimedProblem(intervals, clock, air, search.moves, airspeed_mps, fastest_mps)
    found = sweep(problem, search.start, search.goals)
    states = [found.best_state(goal) for goal in search.goals]
    ways = [nodes_to(found, state, clock.stage_s) for state in states if state is not None]
    return len([cell_by_cell(way, airspeed_mps) for way in ways])


def measure(repeats: int = 3) -> list[Row]:
    """Both searches, each the least of some processor times."""
    wind = gusty_patches()
    clock = StageClock(0.0, STAGES, STEPS)
    hazard = hazard_stages(wind, clock, threshold_mps=THRESHOLD_MPS, corridor_m=0.0)
    shares = hazard.mean(axis=(1, 2))
    if not (shares.min() > 0.09 and shares.max() < 0.36):
        raise SystemExit(f"hazard in {shares.min():.0%} to {shares.max():.0%} of the cells, not 10 to 35 %")
    start, goals = start_and_goals(hazard)
    search = way_search_of(wind, start, goals)
    score_s, _ = clocked(lambda: best_routes(hazard, start, goals), repeats)
    sweep_s, _ = clocked(lambda: earliest_routes(wind, search), repeats)
    flyable_s, _ = clocked(search.ways)
    rows = (
        ("staged: best score with routes", score_s),
        ("wind-aware: earliest with routes", sweep_s),
        ("wind-aware: the same, straightened and flyable", flyable_s),
    )
    return [Row(name, took_s, took_s / score_s) for name, took_s in rows]


def section() -> str:
    """What is measured, and the table."""
    say("the score search and the wind-aware search")
    targets = {1: "3 x"}
    rows = [
        [row.name, duration(row.took_s), f"{row.ratio:.2f} x", targets.get(number, "")]
        for number, row in enumerate(measure())
    ]
    return (
        "From one start to ten goals over 548 x 421 cells and 18 stages of 30 steps, 10 to 35 % of them "
        "hazardous by wind above the threshold; both sides give the routes. The wind-aware search "
        "includes its safe intervals and its air; its routes are straightened and timed in the last row.\n\n"
        + table(["", "time", "of the score search", "target: at most"], rows)
    )


if __name__ == "__main__":
    print(section())
