"""What the staged search found, as positions and times: waypoints, and the outcome of each goal."""

from __future__ import annotations

import math
from collections.abc import Sequence

from planner.dead_end import DeadEnd
from planner.grid import Grid, geodesic_m
from planner.ground import Cell
from planner.hazards import StageClock
from planner.plans import NearestPlace, StageOutcome, Waypoint
from planner.route import Route
from planner.staged import StageEnd


def waypoints(route: Route, grid: Grid, clock: StageClock, altitude_m: float) -> tuple[Waypoint, ...]:
    """One waypoint a step; of a wait only the first and the last. Times count from the route's departure."""
    cells = route.cells
    return tuple(
        Waypoint(
            lat_deg=math.degrees(grid.lat_rad[row]),
            lon_deg=math.degrees(grid.lon_rad[column]),
            altitude_m=altitude_m,
            time_s=step * clock.step_s,
            stage=clock.stage_of_step(route.first_step + step),
        )
        for step, (row, column) in enumerate(cells)
        if not 0 < step < len(cells) - 1 or not cells[step - 1] == cells[step] == cells[step + 1]
    )


def stage_outcomes(ends: Sequence[StageEnd], clock: StageClock) -> tuple[StageOutcome, ...]:
    """The best route so far at the end of each stage, by its arrival and score."""
    return tuple(
        StageOutcome(end.stage, reachable=False)
        if end.best is None
        else StageOutcome(end.stage, True, _flight_s(end.best, clock), end.best.score)
        for end in ends
    )


def nearest_place(
    dead_end: DeadEnd | None, goal: Cell, grid: Grid, clock: StageClock, first_step: int
) -> NearestPlace | None:
    """The reached cell nearest to a goal that is not reached, if any is."""
    if dead_end is None or dead_end.nearest is None or dead_end.nearest_step is None:
        return None
    lat_rad, lon_rad = (
        float(axis[at]) for axis, at in zip((grid.lat_rad, grid.lon_rad), dead_end.nearest, strict=True)
    )
    distance_m = geodesic_m(lat_rad, lon_rad, float(grid.lat_rad[goal[0]]), float(grid.lon_rad[goal[1]]))
    return NearestPlace(
        lat_deg=math.degrees(lat_rad),
        lon_deg=math.degrees(lon_rad),
        distance_m=float(distance_m),
        arrival_s=(dead_end.nearest_step - first_step) * clock.step_s,
    )


def length_m(route: Route, grid: Grid) -> float:
    """The length of a route over ground [m]."""
    lat_rad, lon_rad = (
        [float(axis[index]) for index in indices]
        for axis, indices in zip((grid.lat_rad, grid.lon_rad), zip(*route.cells, strict=True), strict=True)
    )
    if len(lat_rad) < 2:
        return 0.0
    return float(sum(geodesic_m(lat_rad[:-1], lon_rad[:-1], lat_rad[1:], lon_rad[1:])))


def _flight_s(route: Route, clock: StageClock) -> float:
    return (route.arrival_step - route.first_step) * clock.step_s
