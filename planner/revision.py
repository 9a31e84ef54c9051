"""What becomes of a plan under way when a new forecast is issued: kept, changed, or given up for another."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from planner.hazards import Bools
from planner.plans import GoalOutcome, Plan, Waypoint


class Purpose(StrEnum):
    """What a plan is for, where the mission's goal may be out of reach."""

    GOAL = "goal"
    ALTERNATE = "alternate"
    RETURN = "return"
    WAIT = "wait"


_INSTEAD = {
    Purpose.ALTERNATE: (Purpose.ALTERNATE, Purpose.RETURN, Purpose.WAIT),
    Purpose.RETURN: (Purpose.RETURN, Purpose.ALTERNATE, Purpose.WAIT),
    Purpose.WAIT: (Purpose.WAIT, Purpose.ALTERNATE, Purpose.RETURN),
}


@dataclass(frozen=True, slots=True)
class Revision:
    """What to do after a forecast. `plan`: from where it is revised on; None to keep the old one."""

    plan: Plan | None
    purpose: Purpose
    reason: str


class Branch(NamedTuple):
    """Where the plan under way can be left for another.

    `place`: the number of the waypoint at which the other begins. `from_s`: not before, since departure.
    `waiting`: while the aircraft waits there; `place` is the waypoint at which the wait ends.
    """

    plan: Plan
    place: int
    from_s: float
    waiting: bool


class Options(Protocol):
    """A planner on the new forecast, where the old plan can be left."""

    @property
    def begin_s(self) -> float:
        """When the old plan is left, since departure."""

    @property
    def later_s(self) -> float:
        """What is to be added to the times of its plans to make them times since departure."""

    @property
    def in_hazard(self) -> bool:
        """Whether the place where it is left is in hazard then."""

    @property
    def goal(self) -> str:
        """The mission's goal, whatever is flown to."""

    @property
    def objective(self) -> str:
        """By which plans are compared."""

    def trouble(self) -> str:
        """What the rest of the old plan runs into, and when; empty if it can be flown."""

    def plan(self, goal: str) -> Plan:
        """A new plan to a goal."""

    def better(self, plan: Plan) -> str:
        """In what way a new plan to the same goal is better than the old one; empty if it is not."""

    def arrival(self, plan: Plan) -> str:
        """When a new plan arrives, in words."""

    def waiting(self, plan: Plan) -> Plan | None:
        """In place of a plan without a route, one that waits where it is safe; None if nowhere is."""

    def out_of_hazard(self) -> WayOut | None:
        """Where it begins in hazard, the nearest way out of it; None if there is none in time."""


class WayOut(NamedTuple):
    """The nearest way out of the hazard in which the old plan is left.

    `options`: from the same place on, of plans that begin with this way. `told`: where it leads, in words.
    `old_as_soon`: whether the old plan is out of hazard as soon, and can be flown from there on.
    """

    options: Options
    told: str
    old_as_soon: bool


class Prospect(Protocol):
    """A planner on one forecast."""

    @property
    def hazard(self) -> Bools:
        """With the corridor, [stage, north, east]."""

    def ahead(self, from_s: float) -> tuple[NDArray[Any] | None, ...]:
        """All that it knows from a time since departure on."""

    def options(self, branch: Branch, until_s: float) -> Options | None:
        """What can be done from a branch on; None if that is too late.

        Args:
            branch: of the plan under way.
            until_s: when the next forecast is issued, until when a place to wait has to be safe at least.
        """


def same_ahead(old: Prospect, new: Prospect, from_s: float) -> bool:
    """Whether two forecasts say the same of all that is still ahead, as far as the planner asks."""
    return all(
        (a is None and b is None) or (a is not None and b is not None and np.array_equal(a, b))
        for a, b in zip(old.ahead(from_s), new.ahead(from_s), strict=True)
    )


def choose(options: Options, purpose: Purpose, if_unreachable: Purpose, home: str) -> Revision:
    """Plan anew from where the old plan can be left, and choose.

    The mission's goal comes first, whatever was flown to. A plan that can still be flown is kept unless the
    new one is better by the planner's own objective.

    Args:
        options: what there is to choose from.
        purpose: of the old plan.
        if_unreachable: what to try first where there is no route to the goal; then the others.
        home: the name of the place to return to, one of the mission's goals.
    """
    goal, bad = options.goal, options.trouble()
    ran = f"the old plan ran {bad}" if bad else ""
    plan = options.plan(goal)
    if plan.waypoints and not plan.outcome.abstained:
        if purpose is not Purpose.GOAL:
            return Revision(plan, Purpose.GOAL, f"a way to {goal} has opened")
        if bad:
            return Revision(plan, Purpose.GOAL, f"{ran}; a new one arrives at {options.arrival(plan)}")
        better = options.better(plan)
        return Revision(plan if better else None, Purpose.GOAL, better or "unchanged")
    why, missing = _why(plan), f"no route to {goal} ({_why(plan)})"
    if not bad and purpose is not Purpose.GOAL:
        return Revision(None, purpose, f"unchanged: still {missing}")
    if not bad:
        return Revision(None, purpose, f"unchanged, though {why}")
    for other, found in _instead_of(options, plan, if_unreachable, home):
        return Revision(found, other, f"{ran}; {missing}, {_told(other, found)}")
    return Revision(None, purpose, f"{ran}; no way out is known, the old plan is kept")


def leave(options: Options, purpose: Purpose, if_unreachable: Purpose, home: str) -> Revision | None:
    """Where the old plan can be left in hazard only: out of it the nearest way, and plan on from there.

    The old plan is kept if it is out of hazard as soon, and safe from there on, unless a way to the goal has
    opened. The arguments are those of `choose`.

    Returns:
        None if there is no way out in time, or nothing to do then.
    """
    out = options.out_of_hazard()
    if out is None:
        return None
    plan = out.options.plan(options.goal)
    to_goal = bool(plan.waypoints) and not plan.outcome.abstained
    if out.old_as_soon and (purpose is Purpose.GOAL or not to_goal):
        return Revision(
            None, purpose, "the way ahead is in hazard, and the old plan leaves it the nearest way"
        )
    told = f"the way ahead is in hazard: {out.told}, then"
    if to_goal:
        told = f"{told} on to {options.goal}, arriving at {out.options.arrival(plan)}"
        return Revision(plan, Purpose.GOAL, told)
    for other, found in _instead_of(out.options, plan, if_unreachable, home):
        return Revision(found, other, f"{told} {_told(other, found)}: no route to {plan.goal} ({_why(plan)})")
    return None


def _why(plan: Plan) -> str:
    """The reason why a plan to the goal is not to be flown."""
    return "the risk is too high" if plan.outcome.abstained else plan.outcome.reason


def _instead_of(options: Options, plan: Plan, first: Purpose, home: str) -> Iterator[tuple[Purpose, Plan]]:
    """What can be done in place of a plan to the goal, in the order in which it is tried."""
    for other in _INSTEAD[first]:
        found = _instead(options, plan, other, home)
        if found is not None:
            yield other, found


def _instead(options: Options, plan: Plan, purpose: Purpose, home: str) -> Plan | None:
    """The plan for a purpose other than the goal, if there is one."""
    if purpose is Purpose.WAIT:
        return options.waiting(plan)
    names = (
        [home]
        if purpose is Purpose.RETURN
        else [other.name for other in plan.goals if other.name not in (plan.goal, home)]
    )
    open_to = [
        other for other in plan.goals if other.name in names and other.reachable and not other.abstained
    ]
    if not open_to:
        return None
    return options.plan(max(open_to, key=lambda outcome: _merit(outcome, options.objective)).name)


def _merit(outcome: GoalOutcome, objective: str) -> float:
    """By the objective, larger is better."""
    burned_kg = None if outcome.fuel_kg is None else -outcome.fuel_kg
    known = {"score": outcome.score, "survival": outcome.survival, "fuel": burned_kg}.get(objective)
    return known if known is not None else -(outcome.arrival_s or 0.0)


def _told(purpose: Purpose, plan: Plan) -> str:
    if purpose is Purpose.WAIT:
        return "waiting where it is safe"
    return f"back to {plan.goal}" if purpose is Purpose.RETURN else f"diverted to {plan.goal}"


def utc(time_s: float) -> str:
    """The time of day, of seconds since 1970."""
    return f"{datetime.fromtimestamp(time_s, UTC):%H:%M} UTC"


def later(goal: GoalOutcome, by_s: float, by_m: float = 0.0) -> GoalOutcome:
    """The outcome of a plan that begins later, or after a way of some length, with times since departure."""
    return replace(
        goal,
        earliest_arrival_s=_plus(goal.earliest_arrival_s, by_s),
        arrival_s=_plus(goal.arrival_s, by_s),
        length_m=_plus(goal.length_m, by_m),
        stages=tuple(replace(stage, arrival_s=_plus(stage.arrival_s, by_s)) for stage in goal.stages),
        nearest=goal.nearest and replace(goal.nearest, arrival_s=goal.nearest.arrival_s + by_s),
    )


def _plus(value: float | None, by: float) -> float | None:
    return None if value is None else value + by


_COURSES = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


def told_way(first: Waypoint, last: Waypoint, length_m: float) -> str:
    """A way out of hazard in words: where to, and how far; at one place, until when."""
    if not length_m:
        return "waits there until it has passed"
    north = last.lat_deg - first.lat_deg
    east = (last.lon_deg - first.lon_deg) * math.cos(math.radians(first.lat_deg))
    eighth = round(math.atan2(east, north) / (math.pi / 4.0)) % len(_COURSES)
    return f"leaves it toward the {_COURSES[eighth]}, {length_m / 1000.0:.0f} km"
