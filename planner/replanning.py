"""The staged planner's plan under way against a new forecast: what becomes of it, and what is better."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.escape import way_out
from planner.grid import Grid
from planner.ground import Cell, Ground
from planner.hazards import OFFSETS, Bools
from planner.planning import StagedMission
from planner.plans import Plan, Waypoint
from planner.refuge import LEAVING_STEPS, stay
from planner.revision import Branch, WayOut, later, told_way, utc
from planner.route import Route, evaluate
from planner.staged_outcome import length_m, waypoints
from planner.survival import survival_of

_MOVES = {offset: move for move, offset in OFFSETS.items()}
_BETTER = 1e-9  # of a score: anything less is rounding


class UnderWay(NamedTuple):
    """The rest of the plan that is flown: the cells to be occupied from `first_step` on, one a step."""

    first_step: int
    cells: tuple[Cell, ...]


class Trouble(NamedTuple):
    """The first step of a route that cannot be made: for hazard, or by the aircraft in that wind."""

    step: int
    hazard: bool


def cells_by_step(points: Sequence[Waypoint], grid: Grid, step_s: float) -> tuple[Cell, ...]:
    """The cell that a plan occupies at each step from its first waypoint's to its last's."""
    cells: list[Cell] = []
    first_step = round(points[0].time_s / step_s)
    for point in points:
        lat_rad, lon_rad = np.radians([point.lat_deg, point.lon_deg]).tolist()
        row, column = (round(float(index)) for index in grid.indices(lat_rad, lon_rad))
        gap = round(point.time_s / step_s) - first_step - len(cells)
        cells += [cells[-1]] * gap if gap > 0 else []
        cells.append((row, column))
    return tuple(cells)


def trouble(ground: Ground, cells: Sequence[Cell], first_step: int) -> Trouble | None:
    """The first step of a route that hazard, the wind or the end of the forecast forbids, if any does."""
    clock = ground.clock
    if ground.hazard[clock.stage_of_step(first_step)][cells[0]]:
        return Trouble(first_step, hazard=True)
    for step, (here, there) in enumerate(pairwise(cells), first_step + 1):
        if step >= clock.step_count:
            return Trouble(step, hazard=False)
        move = _MOVES[there[0] - here[0], there[1] - here[1]]
        if not ground.may_move(step, here, move):
            stages = {clock.stage_of_step(step), clock.stage_of_step(step - 1)}
            in_hazard = any(ground.hazard[stage][cell] for stage in stages for cell in (here, there))
            return Trouble(step, in_hazard)
    return None


@dataclass(frozen=True, eq=False)
class StagedProspect:
    """The staged planner on one forecast."""

    mission: StagedMission

    @property
    def hazard(self) -> Bools:
        """With the corridor, [stage, north, east]."""
        return self.mission.problem.hazard

    def ahead(self, from_s: float) -> tuple[NDArray[Any] | None, ...]:
        """Hazard, flyable moves and the chance of hazard from a time's stage on."""
        problem = self.mission.problem
        stage = problem.clock.stage_at(from_s)
        known = problem.hazard, problem.flyable, self.mission.probability
        return tuple(None if part is None else part[stage:] for part in known)

    def options(self, branch: Branch, until_s: float) -> StagedOptions | None:
        """From the waypoint's step on, or the one in which the aircraft will be there."""
        clock, points = self.mission.problem.clock, branch.plan.waypoints
        behind = round(points[branch.place].time_s / clock.step_s)
        planned = step = math.ceil(branch.from_s / clock.step_s)
        if not branch.waiting:
            planned, step = behind, max(behind, step)
        if step >= clock.step_count or planned > behind:  # less of the wait is left than can be circled
            return None
        cells = cells_by_step(points, self.mission.grid, clock.step_s)[planned:]
        needed_until = round(until_s / clock.step_s) + LEAVING_STEPS
        return StagedOptions(replace(self.mission, start=cells[0]), UnderWay(step, cells), needed_until)


@dataclass(frozen=True, eq=False)
class StagedOptions:
    """What the staged planner can do from a step of the old plan on.

    `mission`: on the new forecast, from the old plan's cell at that step. `needed_until`: the step until
    which a place to wait has to be safe. `out`: where that cell is in hazard, the cells on the way out of it
    before the mission's start, one a step.
    """

    mission: StagedMission
    old: UnderWay
    needed_until: int
    out: tuple[Cell, ...] = ()

    @property
    def goal(self) -> str:
        """The mission's."""
        return self.mission.request.goal

    @property
    def objective(self) -> str:
        """By which plans are compared."""
        return self.mission.request.objective

    @property
    def begin_s(self) -> float:
        """When the old plan is left."""
        return self.old.first_step * self.mission.problem.clock.step_s

    @property
    def later_s(self) -> float:
        """Plans begin at that step."""
        return self.begin_s

    @property
    def in_hazard(self) -> bool:
        """Whether the cell is, at that step."""
        problem = self.mission.problem
        return bool(problem.hazard[problem.clock.stage_of_step(self.old.first_step)][self.old.cells[0]])

    def trouble(self) -> str:
        """What the old cells run into, and when."""
        bad = trouble(self.mission.problem.ground, self.old.cells, self.old.first_step)
        if bad is None:
            return ""
        into = "into hazard" if bad.hazard else "into wind that it cannot be flown in"
        return f"{into} at {self._utc(bad.step)}"

    @property
    def _first_step(self) -> int:
        """From which on the mission is planned."""
        return self.old.first_step + len(self.out)

    def plan(self, goal: str) -> Plan:
        """From the step on, with the way out of hazard before it."""
        plan = self.mission.plan(goal=goal, first_step=self._first_step)
        if not self.out:
            return plan
        mission, clock = self.mission, self.mission.problem.clock
        way = self._route((*self.out, mission.start))
        by_s, by_m = len(self.out) * clock.step_s, length_m(way, mission.grid)
        points = plan.waypoints
        if points:
            points = self._waypoints((*self.out, *cells_by_step(points, mission.grid, clock.step_s)))
        return replace(
            plan,
            departure_s=plan.departure_s - by_s,
            waypoints=points,
            goals=tuple(later(goal, by_s, by_m) for goal in plan.goals),
        )

    def _route(self, cells: tuple[Cell, ...]) -> Route:
        """Cells occupied from where the old plan is left on."""
        mission, problem = self.mission, self.mission.problem
        weights = mission.request.weights
        return evaluate(cells, problem.clearance(), problem.clock, weights, self.old.first_step)

    def _waypoints(self, cells: tuple[Cell, ...]) -> tuple[Waypoint, ...]:
        mission = self.mission
        route, clock = self._route(cells), mission.problem.clock
        return waypoints(route, mission.grid, clock, mission.request.altitude_m)

    def out_of_hazard(self) -> WayOut | None:
        """By the fewest steps in hazard."""
        mission, old = self.mission, self.old
        ground, request = mission.problem.ground, mission.request
        goal = next(place for place in request.goals if place.name == request.goal)
        cells = way_out(ground, mission.start, goal.cell(mission.grid, "goal"), first_step=old.first_step)
        if cells is None:
            return None
        points = self._waypoints(cells)
        told = told_way(points[0], points[-1], length_m(self._route(cells), mission.grid))
        on = replace(self, mission=replace(mission, start=cells[-1]), out=cells[:-1])
        return WayOut(on, told, self._is_out(len(cells) - 1))

    def _is_out(self, after: int) -> bool:
        """Whether the old cells can be flown so far, and are safe after so many steps to their end."""
        ground, old = self.mission.problem.ground, self.old
        calm = replace(ground, hazard=np.zeros_like(ground.hazard))
        return (
            after < len(old.cells)
            and trouble(calm, old.cells, old.first_step) is None
            and trouble(ground, old.cells[after:], old.first_step + after) is None
        )

    def arrival(self, plan: Plan) -> str:
        """The time of day of its end."""
        return self._utc(self.old.first_step + round(plan.duration_s / self.mission.problem.clock.step_s))

    def _utc(self, step: int) -> str:
        clock = self.mission.problem.clock
        return utc(clock.departure_s + step * clock.step_s)

    def waiting(self, plan: Plan) -> Plan | None:
        """The plan to the unreachable goal with a way to stay safe in place of the route."""
        ground, step = self.mission.problem.ground, self._first_step
        cells = stay(ground, self.mission.start, first_step=step)
        needed_until = min(self.needed_until, ground.clock.step_count - 1)
        if cells is None or len(cells) < 2 or step + len(cells) - 1 < needed_until:
            return None
        return replace(plan, waypoints=self._waypoints((*self.out, *cells)))

    def better(self, plan: Plan) -> str:
        """In what way the new plan is better than the old one; empty if it is not."""
        mission, old = self.mission, self.old
        problem, step, objective = mission.problem, old.first_step, mission.request.objective
        clock = problem.clock
        cells = cells_by_step(plan.waypoints, mission.grid, clock.step_s)
        if cells == old.cells:
            return ""
        earlier_s = (len(old.cells) - len(cells)) * clock.step_s
        sooner = f"{earlier_s / 60.0:.0f} min earlier"
        if objective == "earliest" or (objective == "survival" and mission.probability is None):
            return f"a better one, {sooner}" if earlier_s > 0.0 else ""
        if objective == "survival":
            assert mission.probability is not None
            was, now = (
                survival_of(each, step, mission.probability, clock).at_least for each in (old.cells, cells)
            )
        else:
            clearance, weights = problem.clearance(), mission.request.weights
            was, now = (evaluate(each, clearance, clock, weights, step).score for each in (old.cells, cells))
        if now <= was + _BETTER:
            return ""
        by = f"{objective} {now:.3g} instead of {was:.3g}"
        return f"a better one, {sooner}, {by}" if earlier_s > 0.0 else f"a better one, {by}"
