"""The wind-aware planner: ways in any direction, at a real airspeed through the wind.

A sweep over cells and their safe intervals (`earliest`) finds who can be where first, one over labels
(`cheapest`) what is best by score or survival; ways are straightened into legs in any direction
(`straighten`), and waits are made loiters or slower legs (`waits`). All times are continuous, so that the
aircraft can meet them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.air import Air, Chart
from planner.appraisal import Appraisal
from planner.blocked import Blocked
from planner.climbs import at_every_level, with_climbs
from planner.closures import joined
from planner.errors import PlannerError
from planner.grid import Grid
from planner.hazards import clearance_m, strongest_mps
from planner.intervals import SafeIntervals
from planner.legs import Country
from planner.levels import Levels, stacked
from planner.moves import Moves
from planner.planning import Place, PlanningRequest
from planner.plans import GoalOutcome, Plan
from planner.survival import Survival, check_level
from planner.timetable import cells_passed, length_m, waiting_s, waypoints
from planner.ways import HEADWAY_MPS, GoalWay, WaySearch
from planner.windfield import FieldArray, Floats, WindField

OBJECTIVES = ("earliest", "score", "survival", "fuel")


def plan_windaware(wind: WindField, request: PlanningRequest, *, neighbours: int = 8) -> Plan:
    """Plan at true airspeed through a wind field on the planner's grid.

    Positions are cell centres, as in the staged planner. All objectives but fuel are flown at cruise.

    Args:
        wind: forecast whose grid is the planner's, two-dimensional at one altitude, else with the levels
            among its heights.
        request: start, goals, times and limits.
        neighbours: of the search's moves, 8 or 16 (4 to compare).

    Returns:
        The plan to `request.goal`, without waypoints where it cannot be reached, and every goal's outcome.

    Raises:
        PlannerError: if the goal is not one of the goals, a position lies off the grid, the cruising airspeed
            outside the envelope, or the objective is unknown or lacks what it needs.
    """
    return plan_of(way_search(wind, request, neighbours), wind.grid, request.goal)


def plan_of(search: WaySearch, grid: Grid, goal: str) -> Plan:
    """The plan to one of a search's goals, with times since departure."""
    request = search.request
    ways = dict(zip((goal.name for goal in request.goals), search.ways(), strict=True))
    chosen = ways[goal].way
    route = (
        ()
        if isinstance(chosen, Blocked)
        else waypoints(search.country, grid, request.clock, search.start, chosen, request.altitude_m)
    )
    clear_m: dict[tuple[int, int], Floats] = {}
    return Plan(
        planner="windaware",
        objective=request.objective,
        departure_s=request.clock.departure_s,
        goal=goal,
        waypoints=route,
        goals=tuple(_outcome(search, place, ways[place.name], clear_m) for place in request.goals),
    )


def way_search(wind: WindField, request: PlanningRequest, neighbours: int = 8) -> WaySearch:
    """Everything that is made from a request once.

    Raises:
        PlannerError: as `plan_windaware`.
    """
    _check(request)
    grid, clock = wind.grid, request.clock
    cruise_mps = _cruise(request)
    threshold_mps = min(request.threshold_mps, request.airspeed_min_mps - HEADWAY_MPS)
    wind, levels = _at_levels(wind, request)
    speed_mps = _strongest_mps(wind, levels, request)
    hazard = joined(speed_mps > threshold_mps, request.closures)
    chart = Chart.of(grid, levels)
    air = Air.over(wind, clock)
    country = Country(chart, air, SafeIntervals.of(hazard), clock.stage_s, climbing=request.climbing)
    at_level = Moves.on(chart, neighbours)
    moves = moves_at_level = at_every_level(at_level, levels)
    if request.climbing is not None and levels.count > 1:
        moves = with_climbs(at_level, chart, request.climbing, cruise_mps, threshold_mps)
    own = levels.at(request.altitude_m)
    start = levels.cell(own, request.start.cell(grid, "start"))
    goals = {goal.name: levels.cell(own, goal.cell(grid, "goal")) for goal in request.goals}
    return WaySearch(
        request=request,
        hazard=hazard,
        country=country,
        moves=moves,
        moves_at_level=moves_at_level,
        start=start,
        goals=tuple(goals.values()),
        chosen=goals[request.goal],
        cruise_mps=cruise_mps,
        strongest_mps=threshold_mps,
        appraisal=Appraisal(grid, request, country, hazard, speed_mps, start, cruise_mps),
    )


def _check(request: PlanningRequest) -> None:
    if request.goal not in (goal.name for goal in request.goals):
        known = ", ".join(goal.name for goal in request.goals)
        raise PlannerError(f"no goal is named {request.goal!r}; there are {known}")
    if request.objective not in OBJECTIVES:
        raise PlannerError(f"no objective is named {request.objective!r}; there are {', '.join(OBJECTIVES)}")
    if request.objective == "fuel" and request.fuel_flow is None:
        raise PlannerError("the objective fuel needs the aircraft's fuel flow; give fuel_flow")
    check_level(request.abstain_below)
    if request.objective == "survival" and not request.tells_chance:
        raise PlannerError(
            f"a forecast error of {request.forecast_error_mps} m/s leaves no risk to make small; "
            "the objective survival needs one above 0, or an ensemble"
        )


def _at_levels(wind: WindField, request: PlanningRequest) -> tuple[WindField, Levels]:
    """The levels of a request, and the wind at those and at the heights between."""
    rows = wind.grid.rows
    if not request.levels_m:
        return wind.at_altitude(request.altitude_m), Levels.one(request.altitude_m, rows)
    if wind.height_m is None:
        raise PlannerError("levels_m asks for levels, but the wind is the same at all heights; leave it out")
    if request.climbing is None:
        raise PlannerError("levels are changed at the rates of climbing, which is missing; give it")
    levels = Levels.among(wind.height_m, (request.altitude_m, *request.levels_m), rows)
    inner = np.isin(wind.height_m, levels.height_m)
    if inner.all():
        return wind, levels
    return replace(
        wind,
        height_m=levels.height_m,
        north_mps=wind.north_mps[:, inner],
        east_mps=wind.east_mps[:, inner],
        down_mps=None,
    ), levels


def _strongest_mps(wind: WindField, levels: Levels, request: PlanningRequest) -> FieldArray:
    """The largest wind speed in each cell's room, [stage, north, east], of several levels in tall sheets."""
    clock, corridor_m = request.clock, request.corridor_m
    if wind.height_m is None:
        return strongest_mps(wind, clock, corridor_m=corridor_m)
    at_levels = (wind.at_altitude(height_m) for height_m in levels.height_m.tolist())
    peaks = [strongest_mps(at_level, clock, corridor_m=corridor_m) for at_level in at_levels]
    sheets: NDArray[Any] = np.stack(peaks, axis=1)
    return stacked(sheets, np.inf)  # nobody may enter the rows between


def _outcome(
    search: WaySearch, goal: Place, found: GoalWay, clear_m: dict[tuple[int, int], Floats]
) -> GoalOutcome:
    way = found.way
    if isinstance(way, Blocked):
        return GoalOutcome(goal.name, goal.lat_deg, goal.lon_deg, reachable=False, reason=str(way))
    request, appraisal, levels = search.request, search.appraisal, search.country.chart.levels
    nearest_m, worst = float("inf"), 0.0
    with_error = request.tells_chance
    passed = [(search.begin_s, search.start), *cells_passed(search.country, way)]
    for time_s, cell in passed:
        stage = request.clock.stage_at(time_s)
        if with_error:
            worst = max(worst, float(appraisal.risk[(stage, *cell)]))
        level, at_level = levels.split(cell)
        if (stage, level) not in clear_m:
            clear_m[stage, level] = clearance_m(appraisal.grid, levels.parts(search.hazard[stage])[level])
        nearest_m = min(nearest_m, float(clear_m[stage, level][at_level]))
    arrival_s = way[-1].arrive_s if way else search.begin_s
    chance = Survival(math.exp(appraisal.log_survival(way)), math.exp(-worst)) if with_error else None
    if chance is not None and request.closures is not None and request.closures.members is not None:
        visited = ((request.clock.stage_at(time_s), cell) for time_s, cell in passed)
        chance = request.closures.members.counted(chance, visited)
    terms = appraisal.terms(way)
    return GoalOutcome(
        goal.name,
        goal.lat_deg,
        goal.lon_deg,
        reachable=True,
        earliest_arrival_s=found.earliest_s,
        arrival_s=arrival_s,
        length_m=length_m(search.country, way),
        waiting_s=waiting_s(way, search.begin_s),
        score=terms.total,
        terms=terms,
        min_clearance_m=nearest_m if nearest_m < float("inf") else None,
        fuel_kg=appraisal.fuel_kg(way),
        survival=None if chance is None else chance.at_least,
        survival_at_most=None if chance is None else chance.at_most,
        members_survived=None if chance is None else chance.members_survived,
        members=None if chance is None else chance.members,
        abstained=chance is not None and chance.below(request.abstain_below),
    )


def _cruise(request: PlanningRequest) -> float:
    low_mps, high_mps = request.airspeed_min_mps, request.airspeed_max_mps
    airspeed_mps = 0.5 * (low_mps + high_mps) if request.cruise_mps is None else request.cruise_mps
    if not (HEADWAY_MPS < low_mps <= airspeed_mps <= high_mps):
        raise PlannerError(
            f"a cruise of {airspeed_mps} m/s does not lie within the airspeeds {low_mps} to {high_mps} m/s, "
            f"of which the lowest has to be above {HEADWAY_MPS} m/s; choose another"
        )
    return airspeed_mps
