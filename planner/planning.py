"""From wind and goals to a plan: hazard, the search, and the route as waypoints in time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from planner.closures import Closures, chance_of_hazard, joined
from planner.consumption import FuelFlow
from planner.errors import PlannerError
from planner.grid import Grid
from planner.ground import Cell, Occupancy
from planner.hazards import StageClock, clearance_m, flyable_moves, strongest_mps
from planner.levels import Climbing
from planner.place import Place
from planner.plans import GoalOutcome, Plan
from planner.route import Route
from planner.score import Weights
from planner.staged import Blocked, GoalRoutes, StagedProblem, StageEnd, ends_of_earliest, search
from planner.staged_outcome import length_m, nearest_place, stage_outcomes, waypoints
from planner.survival import check_level, search_survival, survival_of
from planner.windfield import FieldArray, Floats, WindField

__all__ = ["OBJECTIVES", "Place", "PlanningRequest", "StagedMission", "plan_staged", "staged_problem"]

Way = tuple[Route | None, Sequence[StageEnd]]
"""A route, if there is one, and the best routes so far at the end of each stage."""

OBJECTIVES = ("earliest", "score", "survival")


@dataclass(frozen=True, slots=True)
class PlanningRequest:
    """What the staged planner is asked.

    `objective`: which arrival the route takes, "earliest", "score" or "survival". `corridor_m`: half width of
    the room kept below the threshold around every move. The airspeeds are the aircraft's envelope.
    `forecast_error_mps`: standard deviation of the forecast's wind speed, 0 if it is taken as right;
    `abstain_below`: the least chance to survive. Only the wind-aware planner uses `cruise_mps`, the true
    airspeed on its legs (None: in the middle of the envelope), and `wait_min_s`, the shortest wait that can
    be flown as a loiter. `fuel_flow`: the aircraft's consumption at the altitude, which "fuel" needs.
    `closures`: what is hazardous besides wind over the threshold; of several levels in tall sheets.
    `levels_m`: altitudes that the wind-aware planner may change to besides the flight's own, at which it
    begins and ends, and `climbing` how fast it does so.
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
    closures: Closures | None = None
    levels_m: tuple[float, ...] = ()
    climbing: Climbing | None = None

    @property
    def tells_chance(self) -> bool:
        """Whether a chance to survive can be told: the forecast has an error, or there is an ensemble."""
        by_members = self.closures is not None and self.closures.chance is not None
        return self.forecast_error_mps > 0.0 or by_members


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
    return StagedMission.prepare(wind, request).plan()


@dataclass(frozen=True, eq=False)
class StagedMission:
    """A request on its grid, with what is made from the wind once for every departure within the horizon.

    `probability`: of hazard, [stage, north, east], None where the forecast is taken as right. `clear_m`: the
    distance to hazard in each stage.
    """

    request: PlanningRequest
    grid: Grid
    problem: StagedProblem
    probability: Floats | None
    clear_m: tuple[Floats, ...]
    start: Cell
    goals: tuple[Cell, ...]

    @classmethod
    def prepare(cls, wind: WindField, request: PlanningRequest) -> StagedMission:
        """Make hazard, flyable moves and probabilities; raises as `plan_staged` does."""
        _check_request(request)
        strongest = _strongest_mps(wind, request)
        problem = _problem(wind, request, strongest)
        probability = chance_of_hazard(
            strongest,
            threshold_mps=request.threshold_mps,
            error_mps=request.forecast_error_mps,
            closures=request.closures,
        )
        return cls(
            request,
            wind.grid,
            problem,
            probability,
            tuple(clearance_m(wind.grid, stage) for stage in problem.hazard),
            request.start.cell(wind.grid, "start"),
            tuple(goal.cell(wind.grid, "goal") for goal in request.goals),
        )

    def plan(self, *, goal: str | None = None, first_step: int = 0) -> Plan:
        """Plan from one departure.

        Args:
            goal: the name of the goal to plan to, if not the request's.
            first_step: the step of departure; all times of the plan count from it.
        """
        request, clock = self.request, self.problem.clock
        goal = request.goal if goal is None else goal
        found = _search(self.problem, self.start, self.goals, first_step)
        chosen = self._chosen(found, first_step)
        route = next(
            route for place, (route, _) in zip(request.goals, chosen, strict=True) if place.name == goal
        )
        return Plan(
            planner="staged",
            objective=request.objective,
            departure_s=clock.departure_s + first_step * clock.step_s,
            goal=goal,
            waypoints=waypoints(route, self.grid, clock, request.altitude_m) if route else (),
            goals=tuple(
                self._outcome(place, routes, *way, first_step)
                for place, routes, way in zip(request.goals, found, chosen, strict=True)
            ),
        )

    def _chosen(self, found: Sequence[GoalRoutes], first_step: int) -> list[Way]:
        """Of each goal the route by the objective, and the best so far of each stage."""
        if self.request.objective == "score":
            return [(routes.best, routes.stages) for routes in found]
        clock = self.problem.clock
        if self.request.objective == "earliest" or self.probability is None:
            earliest = [routes.earliest for routes in found]
            return [(route, ends_of_earliest(route, clock) if route else ()) for route in earliest]
        safest = search_survival(
            self.probability,
            self.problem.ground,
            self.start,
            self.goals,
            first_step=first_step,
            by_stage=True,
        )
        clearance, weights = self.problem.clearance(), self.request.weights
        return [way.evaluated(clearance, clock, weights) if way.cells else (None, ()) for way in safest]

    def _outcome(
        self,
        goal: Place,
        routes: GoalRoutes,
        route: Route | None,
        ends: Sequence[StageEnd],
        first_step: int,
    ) -> GoalOutcome:
        grid, clock = self.grid, self.problem.clock
        known = GoalOutcome(goal.name, goal.lat_deg, goal.lon_deg, reachable=False)
        if route is None or routes.earliest is None:
            end = routes.dead_end
            cell = goal.cell(grid, "goal")
            return replace(
                known,
                reason=str(routes.blocked),
                nearest=nearest_place(end, cell, grid, clock, first_step),
                last_door_stage=end.last_door_stage if end else None,
            )
        steps = enumerate(route.cells, first_step)
        nearest_m = min(float(self.clear_m[clock.stage_of_step(step)][cell]) for step, cell in steps)
        known = replace(
            known,
            reachable=True,
            earliest_arrival_s=(routes.earliest.arrival_step - first_step) * clock.step_s,
            arrival_s=(route.arrival_step - first_step) * clock.step_s,
            length_m=length_m(route, grid),
            waiting_s=route.waits * clock.step_s,
            score=route.score,
            terms=route.terms,
            min_clearance_m=nearest_m if math.isfinite(nearest_m) else None,
            stages=stage_outcomes(ends, clock),
        )
        if self.probability is None:
            return known
        chance = survival_of(route.cells, first_step, self.probability, clock)
        closures = self.request.closures
        if closures is not None and closures.members is not None:
            visited = ((clock.stage_of_step(step), cell) for step, cell in enumerate(route.cells, first_step))
            chance = closures.members.counted(chance, visited)
        return replace(
            known,
            survival=chance.at_least,
            survival_at_most=chance.at_most,
            members_survived=chance.members_survived,
            members=chance.members,
            abstained=chance.below(self.request.abstain_below),
        )


def _check_request(request: PlanningRequest) -> None:
    if request.goal not in (goal.name for goal in request.goals):
        raise PlannerError(f"no goal is named {request.goal!r}; there are {_names(request.goals)}")
    if request.objective not in OBJECTIVES:
        raise PlannerError(
            f"the staged planner has no objective {request.objective!r}; choose {', '.join(OBJECTIVES)}"
        )
    if request.levels_m:
        raise PlannerError(
            "the staged planner flies at one altitude, and levels_m names others; leave them out, or take "
            "the wind-aware planner"
        )
    check_level(request.abstain_below)
    if not request.tells_chance and (request.objective == "survival" or request.abstain_below > 0.0):
        raise PlannerError(
            "a chance to survive needs an error of the forecast or an ensemble, but forecast_error_mps is 0 "
            "and there is no ensemble; raise it, or add one"
        )


def staged_problem(wind: WindField, request: PlanningRequest) -> StagedProblem:
    """What the staged search is given: hazard with its corridor, strict occupancy, and the moves to be flown.

    Raises:
        PlannerError: if no wind below the threshold makes the cells flyable in a step.
    """
    return _problem(wind, request, _strongest_mps(wind, request))


def _strongest_mps(wind: WindField, request: PlanningRequest) -> FieldArray:
    _check_ground_speed(wind.grid, request)
    return strongest_mps(wind, request.clock, corridor_m=request.corridor_m)


def _problem(wind: WindField, request: PlanningRequest, strongest: FieldArray) -> StagedProblem:
    return StagedProblem(
        joined(strongest > request.threshold_mps, request.closures),
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


def _search(problem: StagedProblem, start: Cell, goals: Sequence[Cell], first_step: int) -> list[GoalRoutes]:
    """Search, and search once more without the aircraft's limits to tell which goals only they put off."""
    found = search(problem, start, goals, first_step=first_step)
    if all(routes.blocked is not Blocked.NEVER_REACHABLE for routes in found):
        return found
    with_any_airspeed = search(replace(problem, flyable=None), start, goals, first_step=first_step)
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
