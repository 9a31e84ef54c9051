"""The plan as other programs want it: checked positions, stops instead of doubled waypoints, UTC times."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

from planner.errors import BadPlanError
from planner.plans import GoalOutcome, Plan

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_DIGITS = 3  # of metres and seconds
_ANGLE_DIGITS = 9  # of degrees: 0.1 mm


@dataclass(frozen=True, slots=True)
class Stop:
    """A position passed (`arrive_s` is `leave_s`) or waited at; times since departure.

    Longitude is at least -180 and less than 180 deg. Angles are rounded to 1e-9 deg, heights to 1 mm, times
    to 1 ms.
    """

    lat_deg: float
    lon_deg: float
    altitude_m: float
    arrive_s: float
    leave_s: float

    @property
    def position(self) -> tuple[float, float, float]:
        """Latitude, longitude and altitude."""
        return self.lat_deg, self.lon_deg, self.altitude_m

    @property
    def waiting_s(self) -> float:
        """How long the stop lasts."""
        return round(self.leave_s - self.arrive_s, _DIGITS)

    @property
    def times_s(self) -> tuple[float, ...]:
        """The arrival and, after a wait, the departure."""
        return (self.arrive_s, self.leave_s) if self.waiting_s > 0.0 else (self.arrive_s,)


def stops(plan: Plan) -> tuple[Stop, ...]:
    """The route with each wait as one stop.

    Raises:
        BadPlanError: if there is no route, a position is not on the Earth, or time does not move on.
    """
    if not plan.waypoints:
        reason = next((goal.reason for goal in plan.goals if goal.name == plan.goal), "")
        raise BadPlanError(
            f"there is no route to {plan.goal} to export{f': {reason}' if reason else ''}; "
            "plan to a goal that can be reached"
        )
    made: list[Stop] = []
    for index, waypoint in enumerate(plan.waypoints):
        what = f"waypoint {index}"
        lat_deg, lon_deg = position_deg(waypoint.lat_deg, waypoint.lon_deg, what)
        altitude_m = _finite(waypoint.altitude_m, f"the altitude of {what}")
        time_s = _finite(waypoint.time_s, f"the time of {what}")
        stop = Stop(lat_deg, lon_deg, altitude_m, time_s, time_s)
        before = made[-1] if made else None
        stays = before is not None and before.position == stop.position
        if before and (time_s < before.leave_s or (time_s == before.leave_s and not stays)):
            raise BadPlanError(
                f"{what} comes at {time_s} s and the one before it at {before.leave_s} s; "
                "a plan needs times that rise, by a millisecond at least"
            )
        if before and stays:
            made[-1] = replace(before, leave_s=time_s)
        else:
            made.append(stop)
    return tuple(made)


def position_deg(lat_deg: float, lon_deg: float, what: str) -> tuple[float, float]:
    """A position on the Earth, rounded, its longitude moved into -180 (included) to 180 deg.

    Raises:
        BadPlanError: if an angle is not finite or the latitude lies beyond a pole.
    """
    if not (abs(lat_deg) <= 90.0 and math.isfinite(lon_deg)):
        raise BadPlanError(
            f"{what} lies at latitude {lat_deg} and longitude {lon_deg} deg; "
            "give finite degrees, the latitude within 90 north and south"
        )
    lon_deg = round((lon_deg + 180.0) % 360.0 - 180.0 if abs(lon_deg) > 180.0 else lon_deg, _ANGLE_DIGITS)
    return round(lat_deg, _ANGLE_DIGITS), -180.0 if lon_deg == 180.0 else lon_deg


def utc(plan: Plan, time_s: float) -> str:
    """A time since the plan's departure as ISO 8601 in UTC, to the millisecond.

    Raises:
        BadPlanError: if it does not lie in the years 1 to 9999.
    """
    try:
        moment = _EPOCH + timedelta(milliseconds=round(1e3 * (plan.departure_s + time_s)))
    except (OverflowError, ValueError) as error:
        raise BadPlanError(
            f"the departure {plan.departure_s} s with {time_s} s of flight is not a date; departure_s counts "
            "seconds since 1970"
        ) from error
    digits = "milliseconds" if moment.microsecond else "seconds"
    return f"{moment.replace(tzinfo=None).isoformat(timespec=digits)}Z"


def goal_places(plan: Plan) -> Iterator[tuple[GoalOutcome, float, float, str]]:
    """Each goal with its latitude and longitude [deg], and a line on what became of it."""
    for goal in plan.goals:
        lat_deg, lon_deg = position_deg(goal.lat_deg, goal.lon_deg, f"the goal {goal.name}")
        if goal.arrival_s is None:
            text = f"no route: {goal.reason}"
        else:
            text = f"reached {utc(plan, goal.arrival_s)}"
        yield goal, lat_deg, lon_deg, text


def _finite(value: float, what: str) -> float:
    """A length or time, rounded to a thousandth."""
    if not math.isfinite(value):
        raise BadPlanError(f"{what} is {value}; a route needs finite numbers")
    return round(value, _DIGITS)
