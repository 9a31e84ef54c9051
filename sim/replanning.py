"""Replanning in flight: at each new forecast the staged planner runs again from where the aircraft will be.

The new plan begins at a waypoint of the old one, in its cell and at its step, so the reference can change on
the leg that leads there, or at the end of a lap of a wait, without a jump (`aircraft.joining`). The time of
the simulation stands still while it is planned.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

import numpy as np

from aircraft.errors import PathError
from aircraft.guidance import Guidance, Progress
from aircraft.joining import Joint, joined, joints
from aircraft.reference import Reference
from planner.closures import Closures
from planner.hazards import Bools, strongest_mps
from planner.planning import PlanningRequest
from planner.plans import Plan
from planner.revision import (
    Branch,
    Options,
    Prospect,
    Purpose,
    Revision,
    choose,
    later,
    leave,
    same_ahead,
    utc,
)
from planner.windfield import WindField
from recordings.recorder import Layer, Outcome, PlanIssue, WeatherSheet
from sim.path_layer import PathLayer

_JOINTS = 8  # places that are tried, the nearest first
_MADE_GOOD_S = 30.0  # of lateness, by speed
_OUTCOMES = {
    Purpose.GOAL: Outcome.ARRIVED,
    Purpose.ALTERNATE: Outcome.DIVERTED,
    Purpose.RETURN: Outcome.RETURNED,
    Purpose.WAIT: Outcome.NO_ROUTE,
}


class Decision(NamedTuple):
    """What came of a forecast: its sheet for the stage that begins, and the plan.

    `hazard`: as forecast, with the corridor, [stage, north, east]. `reference`: to be followed from the
    aircraft's place on; None where the old one is kept.
    """

    sheet: WeatherSheet
    hazard: Bools
    issue: PlanIssue
    reference: Reference | None


class Replanner:
    """Decides for one flight.

    `next_s`: when the next forecast is issued, since departure; infinite if there is none any more.
    """

    def __init__(
        self,
        plan: Plan,
        request: PlanningRequest,
        forecast: WindField,
        hazard: Bools,
        layer: PathLayer,
        *,
        prospect: Callable[[WindField, PlanningRequest], Prospect],
        issued: Callable[[int], WindField],
        closures: Callable[[int], Closures] | None,
        if_unreachable: Purpose,
    ) -> None:
        """For a flight along a plan.

        Args:
            plan: made before take-off.
            request: that it was asked for.
            forecast: that it was made with.
            hazard: of that forecast, with the corridor, [stage, north, east].
            layer: lays references.
            prospect: the planner, on a forecast.
            issued: the forecast that is issued when a stage begins.
            closures: what is hazardous besides the wind, as of that; None where it stays as it was.
            if_unreachable: what to do first where there is no route to the goal any more.
        """
        self._home = request.start.name
        self._request = _with_home(request)
        self._prospect = prospect
        self._issued, self._if_unreachable, self._layer = issued, if_unreachable, layer
        self._closures = closures
        self._forecast, self._hazard = forecast, hazard
        self._now: Prospect | None = None
        self._purpose, self._since = Purpose.GOAL, ""
        self._take(plan)
        self._stage = 0
        self._come()

    def _take(self, plan: Plan) -> None:
        self._plan, self._points = plan, self._layer.points(plan.waypoints)

    def _come(self) -> None:
        clock, self._stage = self._request.clock, self._stage + 1
        self.next_s = self._stage * clock.stage_s if self._stage < clock.stage_count else math.inf

    @property
    def ending(self) -> tuple[Outcome, str]:
        """How a flight has ended that came to the end of its reference."""
        goal, clock = self._plan.goal, self._request.clock
        missed = f"no route to {self._request.goal} after the forecast of {self._since}"
        detail = {
            Purpose.GOAL: f"passed {goal}",
            Purpose.ALTERNATE: f"diverted to {goal}: {missed}",
            Purpose.RETURN: f"returned to {goal}: {missed}",
            Purpose.WAIT: f"waited until {utc(clock.departure_s + self._plan.duration_s)}: {missed}",
        }
        return _OUTCOMES[self._purpose], detail[self._purpose]

    def decide(self, time_s: float, guidance: Guidance, progress: Progress) -> Decision:
        """Take the next forecast, and plan.

        Args:
            time_s: now, since departure.
            guidance: of the flight, as of its last round.
            progress: what it said then.
        """
        stage = self._stage
        self._come()
        reason, reference = self._revised(self._issued(stage), guidance, progress, stage)
        sheet = self._sheet(stage, time_s)
        told = f"forecast of {self._utc(stage)}, stage {stage}: {reason}"
        return Decision(
            sheet, self._hazard, PlanIssue(time_s, told, self._plan, reference is not None), reference
        )

    def _sheet(self, stage: int, time_s: float) -> WeatherSheet:
        """The forecast in force, of the stage that begins."""
        clock, wind = self._request.clock, replace(self._forecast, hold=True)
        begin_s, _ = clock.span_s(stage)
        north, east = wind.sheet(begin_s)
        of_stage = replace(clock, departure_s=begin_s, stage_count=1)
        peaks_mps = strongest_mps(wind, of_stage, corridor_m=self._request.corridor_m)
        return WeatherSheet(
            layer=Layer.FORECAST,
            stage=stage,
            time_s=time_s,
            hazard=self._hazard[stage],
            wind_north_mps=north.astype(np.float32),
            wind_east_mps=east.astype(np.float32),
            peak_mps=peaks_mps[0].astype(np.float32),
            closed=None if self._request.closures is None else self._request.closures.closed[stage],
            altitude_m=self._request.altitude_m,
        )

    def _revised(
        self, forecast: WindField, guidance: Guidance, progress: Progress, stage: int
    ) -> tuple[str, Reference | None]:
        """Why the plan is changed or not, and the reference to the new one."""
        if forecast is self._forecast:
            return "unchanged", None
        before = self._now or self._prepare(self._forecast)
        if self._closures is not None:
            self._request = replace(self._request, closures=self._closures(stage))
        self._forecast, now = forecast, self._prepare(forecast)
        self._now, self._hazard = now, now.hazard
        next_s = self._stage * self._request.clock.stage_s
        reason = "too near the plan's end to change it"
        for joint in islice(joints(guidance.reference, self._points, progress.path_m), _JOINTS):
            index = len(self._points) - len(guidance.reference.waypoint_path_m) + joint.place
            options = now.options(self._branch(joint, index, progress.time_error_s), next_s)
            if options is None:
                continue
            if same_ahead(before, now, options.begin_s):
                return "unchanged", None
            decided = leave if options.in_hazard else choose
            revision = decided(options, self._purpose, self._if_unreachable, self._home)
            if revision is None:
                reason = (
                    "the way ahead is in hazard, and no way out can be flown in time; the old plan is kept"
                )
                continue
            if revision.plan is None:
                return revision.reason, None
            try:
                reference = self._lay(joint, index, options, revision, guidance.reference, progress.path_m)
            except PathError as error:
                reason = f"{revision.reason}, but it cannot be flown: {error}"
                continue
            self._purpose, self._since = revision.purpose, self._utc(stage)
            return revision.reason, reference
        return reason, None

    def _utc(self, stage: int) -> str:
        return utc(self._request.clock.span_s(stage)[0])

    def _prepare(self, forecast: WindField) -> Prospect:
        return self._prospect(replace(forecast, hold=True), self._request)

    def _branch(self, joint: Joint, place: int, late_s: float) -> Branch:
        """Where the plan is left at a joint, and when the aircraft will be there."""
        if joint.circling:
            lap_s = self._layer.lap_s(self._plan.waypoints[place], self._forecast)
            return Branch(self._plan, place, joint.time_s + 0.75 * lap_s, True)
        return Branch(self._plan, place, joint.time_s + late_s - _MADE_GOOD_S, False)

    def _lay(
        self,
        joint: Joint,
        index: int,
        options: Options,
        revision: Revision,
        reference: Reference,
        path_m: float,
    ) -> Reference:
        """Lay the reference to a revision, and take it over where that can be done."""
        assert revision.plan is not None
        later_s = options.later_s
        tail = tuple(replace(point, time_s=point.time_s + later_s) for point in revision.plan.waypoints)
        points = self._layer.points(tail)
        circling_rad = None
        if joint.circling:
            circling_rad = reference.at(joint.path_m).course_rad
            before = self._points[index]._replace(time_s=joint.time_s)
        else:
            before = self._points[index - 1]
        onward = self._layer.through([before, *points], self._forecast, circling_rad=circling_rad)
        result = joined(reference, path_m, joint, onward)
        goals = tuple(
            later(goal, later_s)
            for goal in revision.plan.goals
            if goal.name != self._home or revision.plan.goal == self._home
        )
        self._take(
            replace(
                revision.plan,
                departure_s=self._plan.departure_s,
                waypoints=(*self._plan.waypoints[:index], *tail),
                goals=goals,
            )
        )
        return result


def _with_home(request: PlanningRequest) -> PlanningRequest:
    """The same, with the start among the goals, to return to."""
    if request.start.name in (goal.name for goal in request.goals):
        return request
    return replace(request, goals=(*request.goals, request.start))
