"""A plan as an operator reads it."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime

from planner.departure_table import clock, percent
from planner.plans import GoalOutcome, NearestPlace, Plan
from planner.whereabouts import place_text


def plan_lines(plan: Plan, *, goal_alone: bool = False) -> Iterator[str]:
    """What was planned, and a line for each goal, or for the plan's alone."""
    yield f"plan ({plan.planner}, by {plan.objective}), departure {utc(plan.departure_s)}"
    for goal in [plan.outcome] if goal_alone else plan.goals:
        mark = ">" if goal.name == plan.goal else " "
        yield f" {mark} {goal.name:14s} {_goal_line(goal)}"
    if len(plan.level_flight) > 1:
        (first_m, _), *others = plan.level_flight
        yield f"   levels to {plan.goal}: {first_m:.0f} m{''.join(_level(*other) for other in others)}"


def why_not_flown(plan: Plan, abstain_below: float) -> str | None:
    """Why a plan is not to be flown, or None if it is."""
    outcome = plan.outcome
    if not plan.waypoints:
        return f"no route to {plan.goal}: {outcome.reason}"
    if outcome.abstained:
        chance = "too small" if outcome.survival is None else percent(outcome.survival)
        return (
            f"not to be flown: the chance to survive on the way to {plan.goal} is {chance}, and "
            f"planner.abstain_below is {percent(abstain_below)}; lower it, or set planner.objective=survival"
        )
    return None


def utc(time_s: float) -> str:
    """Seconds since 1970 as date and time in UTC."""
    return datetime.fromtimestamp(time_s, UTC).strftime("%Y-%m-%dT%H:%MZ")


def _goal_line(goal: GoalOutcome) -> str:
    if goal.arrival_s is None or goal.earliest_arrival_s is None or goal.length_m is None:
        return f"no route: {goal.reason}{_nearest(goal.nearest)}{_last_door(goal)}"
    waits = f", waits {goal.waiting_s / 60.0:.0f} min" if goal.waiting_s else ""
    clear = (
        "" if goal.min_clearance_m is None else f", {goal.min_clearance_m / 1000.0:.0f} km clear of hazard"
    )
    return (
        f"{_hours(goal.arrival_s)} h (earliest {_hours(goal.earliest_arrival_s)}), "
        f"{goal.length_m / 1000.0:.0f} km{waits}{clear}{_fuel(goal)}{_survival(goal)}"
    )


def _level(altitude_m: float, from_s: float) -> str:
    return f", {altitude_m:.0f} m from {_hours(from_s)} h"


def _fuel(goal: GoalOutcome) -> str:
    return "" if goal.fuel_kg is None else f", burns {goal.fuel_kg:.2f} kg"


def _survival(goal: GoalOutcome) -> str:
    if goal.survival is None:
        return ""
    most = "" if goal.survival_at_most is None else f" to {percent(goal.survival_at_most)}"
    members = "" if goal.members is None else f" ({goal.members_survived} of {goal.members} members)"
    return f", survives {percent(goal.survival)}{most}{members}{', abstained' if goal.abstained else ''}"


def _nearest(place: NearestPlace | None) -> str:
    if place is None:
        return ""
    return (
        f"; nearest {place_text(place.lat_deg, place.lon_deg)}, "
        f"{place.distance_m / 1000.0:.0f} km off, at {_hours(place.arrival_s)} h"
    )


def _last_door(goal: GoalOutcome) -> str:
    if goal.nearest is None:
        return ""
    if goal.last_door_stage is None:
        return ", cut off all along"
    return f", last door in stage {goal.last_door_stage}"


def _hours(time_s: float) -> str:
    return clock(time_s / 60.0)
