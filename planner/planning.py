"""From wind and goals to a plan: hazard, the search, and the route as waypoints in time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.consumption import FuelFlow
from planner.errors import PlannerError
from planner.grid import Grid, geodesic_m
from planner.ground import Cell, Occupancy
from planner.hazards import StageClock, clearance_m, flyable_moves, hazard_stages
from planner.plans import GoalOutcome, Plan, Waypoint
from planner.route import Route
from planner.score import Weights
from planner.staged import Blocked, GoalRoutes, StagedProblem, search
from planner.windfield import WindField

OBJECTIVES = ("earliest", "score")


@dataclass(frozen=True, slots=True)
class Place:
    """A named position, geodetic WGS84 [deg]."""

    name: str
    lat_deg: float
    lon_deg: float

    def cell(self, grid: Grid, what: str) -> Cell:
        """The grid cell it lies in; raises OutsideGridError off the grid."""
        lat_rad, lon_rad = math.radians(self.lat_deg), math.radians(self.lon_deg)
        return grid.nearest_cell(lat_rad, lon_rad, f"{what} {self.name}")


@dataclass(frozen=True, slots=True)
class PlanningRequest:
    """What the staged planner is asked.

    `objective`: which arrival the route takes, "earliest" or "score". `corridor_m`: half width of the room
    kept below the threshold around every move. The airspeeds are the aircraft's envelope.
    `forecast_error_mps`: standard deviation of the forecast's wind speed, 0 if it is taken as right;
    `abstain_below`: the least chance to survive. Only the wind-aware planner uses `cruise_mps`, the true
    airspeed on its legs (None: in the middle of the envelope), and `wait_min_s`, the shortest wait that can
    be flown as a loiter. `fuel_flow`: the aircraft's consumption at the altitude, which "fuel" needs.
    """

    start: Place
    goals: tuple[Place, ...]
    goal: str
    altitude_m: float
    clock: StageClock
    threshold_mps: float
    corridor_m: float
    airspeed_min_mps: float
    airspeed_max_mps: float
    objective: str = "score"
    weights: Weights = Weights()  # noqa: RUF009 - frozen
    cruise_mps: float | None = None
    wait_min_s: float = 120.0
    forecast_error_mps: float = 0.0
    abstain_below: float = 0.0
    fuel_flow: FuelFlow | None = None


def plan_staged(wind: WindField, request: PlanningRequest) -> Plan:
    """Plan through a wind field on the planner's grid, at the flight's altitude.

    Args:
        wind: two-dimensional forecast whose grid is the planner's.
        request: start, goals, times and limits.

    Returns:
        The plan to `request.goal`, without waypoints where it cannot be reached, and every goal's outcome.

    Raises:
        PlannerError: if the goal is not one of the goals, a position lies off the grid, or the objective is
            not one of this planner's.
    """
    if request.goal not in (goal.name for goal in request.goals):
        raise PlannerError(f"no goal is named {request.goal!r}; there are {_names(request.goals)}")
    if request.objective not in OBJECTIVES:
        raise PlannerError(
            f"the staged planner has no objective {request.objective!r}; choose {' or '.join(OBJECTIVES)}"
        )
    grid, clock = wind.grid, request.clock
    problem = staged_problem(wind, request)
    found = _search(
        problem,
        request.start.cell(grid, "start"),
        [goal.cell(grid, "goal") for goal in request.goals],
    )
    chosen = {
        goal.name: routes.earliest if request.objective == "earliest" else routes.best
        for goal, routes in zip(request.goals, found, strict=True)
    }
    clear_m = [clearance_m(grid, stage) for stage in problem.hazard]
    outcomes = tuple(
        _outcome(goal, routes, chosen[goal.name], clear_m, clock, grid)
        for goal, routes in zip(request.goals, found, strict=True)
    )
    route = chosen[request.goal]
    return Plan(
        planner="staged",
        objective=request.objective,
        departure_s=clock.departure_s,
        goal=request.goal,
        waypoints=_waypoints(route, grid, clock, request.altitude_m) if route else (),
        goals=outcomes,
    )


def staged_problem(wind: WindField, request: PlanningRequest) -> StagedProblem:
    """What the staged search is given: hazard with its corridor, strict occupancy, and the moves to be flown.

    Raises:
        PlannerError: if no wind below the threshold makes the cells flyable in a step.
    """
    _check_ground_speed(wind.grid, request)
    hazard = hazard_stages(
        wind, request.clock, threshold_mps=request.threshold_mps, corridor_m=request.corridor_m
    )
    return StagedProblem(
        hazard,
        request.clock,
        request.weights,
        Occupancy.STRICT,
        flyable_moves(
            wind,
            request.clock,
            airspeed_min_mps=request.airspeed_min_mps,
            airspeed_max_mps=request.airspeed_max_mps,
        ),
    )


def _search(problem: StagedProblem, start: Cell, goals: Sequence[Cell]) -> list[GoalRoutes]:
    """Search, and search once more without the aircraft's limits to tell which goals only they put off."""
    found = search(problem, start, goals)
    if all(routes.blocked is not Blocked.NEVER_REACHABLE for routes in found):
        return found
    with_any_airspeed = search(replace(problem, flyable=None), start, goals)
    return [
        replace(routes, blocked=Blocked.NOT_FLYABLE)
        if routes.blocked is Blocked.NEVER_REACHABLE and free.blocked is None
        else routes
        for routes, free in zip(found, with_any_airspeed, strict=True)
    ]


def _check_ground_speed(grid: Grid, request: PlanningRequest) -> None:
    """Refuse cells and steps that no wind below the threshold makes flyable."""
    cells_m = np.concatenate([grid.north_cell_m, grid.east_cell_m])
    slowest_mps, fastest_mps = (
        float(cell_m) / request.clock.step_s for cell_m in (cells_m.min(), cells_m.max())
    )
    highest_mps = request.airspeed_max_mps + request.threshold_mps
    lowest_mps = request.airspeed_min_mps - request.threshold_mps
    if slowest_mps > highest_mps or fastest_mps < lowest_mps:
        raise PlannerError(
            f"cells of {cells_m.mean():.0f} m in steps of {request.clock.step_s:g} s ask for "
            f"{cells_m.mean() / request.clock.step_s:.0f} m/s over ground; the aircraft flies "
            f"{request.airspeed_min_mps:.0f} to {request.airspeed_max_mps:.0f} m/s through the air, "
            "so change the size of the cells or the time of a step"
        )


def _names(places: Sequence[Place]) -> str:
    return ", ".join(place.name for place in places)


def _waypoints(route: Route, grid: Grid, clock: StageClock, altitude_m: float) -> tuple[Waypoint, ...]:
    """One waypoint a step; of a wait only the first and the last."""
    cells = route.cells
    return tuple(
        Waypoint(
            lat_deg=math.degrees(grid.lat_rad[row]),
            lon_deg=math.degrees(grid.lon_rad[column]),
            altitude_m=altitude_m,
            time_s=step * clock.step_s,
            stage=clock.stage_of_step(step),
        )
        for step, (row, column) in enumerate(cells)
        if not 0 < step < len(cells) - 1 or not cells[step - 1] == cells[step] == cells[step + 1]
    )


def _outcome(
    goal: Place,
    routes: GoalRoutes,
    route: Route | None,
    clear_m: Sequence[NDArray[np.float64]],
    clock: StageClock,
    grid: Grid,
) -> GoalOutcome:
    if route is None or routes.earliest is None:
        reason = str(routes.blocked)
        return GoalOutcome(goal.name, goal.lat_deg, goal.lon_deg, reachable=False, reason=reason)
    nearest_m = min(float(clear_m[clock.stage_of_step(step)][cell]) for step, cell in enumerate(route.cells))
    return GoalOutcome(
        goal.name,
        goal.lat_deg,
        goal.lon_deg,
        reachable=True,
        earliest_arrival_s=routes.earliest.arrival_step * clock.step_s,
        arrival_s=route.arrival_step * clock.step_s,
        length_m=_length_m(route, grid),
        waiting_s=route.waits * clock.step_s,
        score=route.score,
        min_clearance_m=nearest_m if math.isfinite(nearest_m) else None,
    )


def _length_m(route: Route, grid: Grid) -> float:
    lat_rad, lon_rad = (
        [float(axis[index]) for index in indices]
        for axis, indices in zip((grid.lat_rad, grid.lon_rad), zip(*route.cells, strict=True), strict=True)
    )
    if len(lat_rad) < 2:
        return 0.0
    return float(sum(geodesic_m(lat_rad[:-1], lon_rad[:-1], lat_rad[1:], lon_rad[1:])))
