"""The wind-aware planner: ways in any direction, at a real airspeed through the wind.

A sweep over cells and their safe intervals (`earliest`) finds who can be where first, one over labels
(`cheapest`) what is best by score or survival; ways are straightened into legs in any direction
(`straighten`), and waits are made loiters or slower legs (`waits`). All times are continuous, so that the
aircraft can meet them.
"""

from __future__ import annotations

import math

from planner.air import Air, Chart
from planner.appraisal import Appraisal
from planner.blocked import Blocked
from planner.errors import PlannerError
from planner.hazards import clearance_m, strongest_mps
from planner.intervals import SafeIntervals
from planner.legs import Country
from planner.moves import Moves
from planner.planning import Place, PlanningRequest
from planner.plans import GoalOutcome, Plan
from planner.survival import check_level
from planner.timetable import cells_passed, length_m, waiting_s, waypoints
from planner.ways import GoalWay, WaySearch
from planner.windfield import Floats, WindField

OBJECTIVES = ("earliest", "score", "survival", "fuel")

_HEADWAY_MPS = 3.0  # what a head wind has to leave of the slowest airspeed; stronger wind counts as hazard


def plan_windaware(wind: WindField, request: PlanningRequest, *, neighbours: int = 8) -> Plan:
    """Plan at true airspeed through a wind field on the planner's grid.

    Positions are cell centres, as in the staged planner. All objectives but fuel are flown at cruise.

    Args:
        wind: two-dimensional forecast whose grid is the planner's.
        request: start, goals, times and limits.
        neighbours: of the search's moves, 8 or 16 (4 to compare).

    Returns:
        The plan to `request.goal`, without waypoints where it cannot be reached, and every goal's outcome.

    Raises:
        PlannerError: if the goal is not one of the goals, a position lies off the grid, the cruising airspeed
            outside the envelope, or the objective is unknown or lacks what it needs.
    """
    search = way_search(wind, request, neighbours)
    ways = dict(zip((goal.name for goal in request.goals), search.ways(), strict=True))
    chosen = ways[request.goal].way
    route = (
        ()
        if isinstance(chosen, Blocked)
        else waypoints(search.country, wind.grid, request.clock, search.start, chosen, request.altitude_m)
    )
    clear_m: dict[int, Floats] = {}
    return Plan(
        planner="windaware",
        objective=request.objective,
        departure_s=request.clock.departure_s,
        goal=request.goal,
        waypoints=route,
        goals=tuple(_outcome(search, goal, ways[goal.name], clear_m) for goal in request.goals),
    )


def way_search(wind: WindField, request: PlanningRequest, neighbours: int = 8) -> WaySearch:
    """Everything that is made from a request once.

    Raises:
        PlannerError: as `plan_windaware`.
    """
    _check(request)
    grid, clock = wind.grid, request.clock
    cruise_mps = _cruise(request)
    threshold_mps = min(request.threshold_mps, request.airspeed_min_mps - _HEADWAY_MPS)
    speed_mps = strongest_mps(wind, clock, corridor_m=request.corridor_m)
    hazard = speed_mps > threshold_mps
    chart = Chart.of(grid)
    country = Country(chart, Air.over(wind, clock), SafeIntervals.of(hazard), clock.stage_s)
    start = request.start.cell(grid, "start")
    goals = {goal.name: goal.cell(grid, "goal") for goal in request.goals}
    return WaySearch(
        request=request,
        hazard=hazard,
        country=country,
        moves=Moves.on(chart, neighbours),
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
    if request.objective == "survival" and not request.forecast_error_mps > 0.0:
        raise PlannerError(
            f"a forecast error of {request.forecast_error_mps} m/s leaves no risk to make small; "
            "the objective survival needs one above 0"
        )


def _outcome(search: WaySearch, goal: Place, found: GoalWay, clear_m: dict[int, Floats]) -> GoalOutcome:
    way = found.way
    if isinstance(way, Blocked):
        return GoalOutcome(goal.name, goal.lat_deg, goal.lon_deg, reachable=False, reason=str(way))
    request, appraisal = search.request, search.appraisal
    nearest_m, worst = float("inf"), 0.0
    with_error = request.forecast_error_mps > 0.0
    for time_s, cell in [(0.0, search.start), *cells_passed(search.country, way)]:
        stage = request.clock.stage_at(time_s)
        if with_error:
            worst = max(worst, float(appraisal.risk[(stage, *cell)]))
        if stage not in clear_m:
            clear_m[stage] = clearance_m(appraisal.grid, search.hazard[stage])
        nearest_m = min(nearest_m, float(clear_m[stage][cell]))
    arrival_s = way[-1].arrive_s if way else 0.0
    survival = math.exp(appraisal.log_survival(way)) if with_error else None
    terms = appraisal.terms(way)
    return GoalOutcome(
        goal.name,
        goal.lat_deg,
        goal.lon_deg,
        reachable=True,
        earliest_arrival_s=found.earliest_s,
        arrival_s=arrival_s,
        length_m=length_m(search.country, way),
        waiting_s=waiting_s(way),
        score=terms.total,
        terms=terms,
        min_clearance_m=nearest_m if nearest_m < float("inf") else None,
        fuel_kg=appraisal.fuel_kg(way),
        survival=survival,
        survival_at_most=math.exp(-worst) if with_error else None,
        abstained=survival is not None and survival < request.abstain_below,
    )


def _cruise(request: PlanningRequest) -> float:
    low_mps, high_mps = request.airspeed_min_mps, request.airspeed_max_mps
    airspeed_mps = 0.5 * (low_mps + high_mps) if request.cruise_mps is None else request.cruise_mps
    if not (_HEADWAY_MPS < low_mps <= airspeed_mps <= high_mps):
        raise PlannerError(
            f"a cruise of {airspeed_mps} m/s does not lie within the airspeeds {low_mps} to {high_mps} m/s, "
            f"of which the lowest has to be above {_HEADWAY_MPS} m/s; choose another"
        )
    return airspeed_mps
