"""Holding: laps of a circle beside the path, for an aircraft that is earlier than its airspeed can mend.

The circle touches a straight leg a little ahead of the aircraft and is flown round whole times, so that
position and course go on without a jump; as many times, and so wide, that the schedule is met where it ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from aircraft.corners import bulb
from aircraft.laying import Stop, banked_radius_m, circles
from aircraft.loiters import fit_laps, lap_s
from aircraft.path import PathPoint, Phase
from aircraft.reference import Reference
from aircraft.relaying import with_detour

_AHEAD_S = 3.0  # from the aircraft to the circle: time to bank, and to speed up
_CLEAR_S = 5.0  # of straight leg before the aircraft and behind the circle's beginning, without a waypoint
_TO_SPARE_S = 5.0  # earlier than a lap of the smallest circle
_WHOLE = 1.0 - 1e-9  # of the largest circle, so that rounding makes it none too large


MayHold = Callable[[float, float, float], bool]
"""(north_m, east_m, until_s): whether the room for a circle around a place is safe from now until then."""


@dataclass(frozen=True, slots=True)
class HoldLimits:
    """What an aircraft can hold on.

    `radius_min_m`, `radius_max_m`: true metres. `airspeed_mps`: true, kept on the circle. `bank_max_rad`: no
    circle is so small that the wind from behind would ask for more than guidance takes in a turn.
    """

    radius_min_m: float
    radius_max_m: float
    airspeed_mps: float
    bank_max_rad: float

    @property
    def early_s(self) -> float:
        """How early an aircraft has to be for any hold at all: a lap is quickest in still air."""
        return 2.0 * math.pi * self.smallest_m((0.0, 0.0)) / self.airspeed_mps + _TO_SPARE_S

    def smallest_m(self, wind: tuple[float, float]) -> float:
        """Radius of the smallest circle to be flown in a wind."""
        fastest_mps = self.airspeed_mps + math.hypot(*wind)
        banked_m = banked_radius_m(fastest_mps, self.bank_max_rad)
        return max(self.radius_min_m, banked_m, 0.5 * self.radius_max_m)  # half: `fit_laps` asks for it


class Hold(NamedTuple):
    """A hold, laid.

    `reference`: the new one, from the aircraft's place on. `path_m`: where the circle begins on the old one.
    `from_s`, `until_s`: on the circle.
    """

    reference: Reference
    path_m: float
    laps: int
    from_s: float
    until_s: float

    @property
    def lap_s(self) -> float:
        """Of one lap, on average."""
        return (self.until_s - self.from_s) / self.laps


def lay_hold(
    reference: Reference,
    path_m: float,
    early_s: float,
    limits: HoldLimits,
    wind: tuple[float, float],
    may_hold: MayHold,
) -> Hold | None:
    """The hold after which an aircraft is on time again, or as nearly as whole laps allow.

    Args:
        reference: followed so far.
        path_m: where along it the aircraft is, plane metres.
        early_s: time to spend.
        limits: what can be flown.
        wind: toward (north_mps, east_mps), taken to last.
        may_hold: whether a place is safe till the end of a hold.

    Returns:
        None without a straight leg that is safe, in time less than a lap, or in a wind too strong to circle.
    """
    here = reference.at(path_m)
    onward_mps = here.speed_mps * here.scale
    at_m = path_m + _AHEAD_S * onward_mps
    if not is_straight(reference, path_m - _CLEAR_S * onward_mps, at_m + _CLEAR_S * onward_mps):
        return None
    place = reference.at(at_m)
    wait_s = _wait_s(early_s, place.course_rad, limits, wind)
    if wait_s == 0.0 or not may_hold(place.north_m, place.east_m, place.time_s):
        return None
    begin = PathPoint(place.north_m, place.east_m, place.altitude_m, place.time_s - wait_s, place.scale)
    laps = fit_laps(
        wait_s,
        radius_max_m=limits.radius_max_m,
        airspeed_mps=limits.airspeed_mps,
        course_rad=place.course_rad,
        right=True,
        wind_after=lambda _: wind,
        where="the hold",
    )
    circle = bulb(0.0, laps.radius_m * place.scale, math.inf)
    ends = begin, begin._replace(time_s=place.time_s)
    detour = circles(Stop(ends, circle, laps, place.north_m, place.east_m, place.course_rad))
    return Hold(
        with_detour(reference, path_m, at_m, detour, at_m),
        at_m,
        len(laps.arc_times_s),
        begin.time_s,
        place.time_s,
    )


def is_straight(reference: Reference, from_m: float, to_m: float) -> bool:
    """Whether a stretch lies within the straight part of one leg, without a waypoint on it."""
    waypoints_m = reference.waypoint_path_m
    if ((waypoints_m >= from_m) & (waypoints_m <= to_m)).any():
        return False
    ends_m = reference.start_m + reference.length_m
    touched = (ends_m > from_m) & (reference.start_m < to_m)
    straight = (reference.curvature == 0.0) & (reference.phase == Phase.LEG)
    return from_m >= 0.0 and to_m <= reference.end_m and bool(straight[touched].all())


def _wait_s(early_s: float, course_rad: float, limits: HoldLimits, wind: tuple[float, float]) -> float:
    """How much of the time to spend can be spent on whole laps; zero if none."""
    smallest_m, largest_m = limits.smallest_m(wind), limits.radius_max_m
    lap_of_one_m = lap_s(1.0, airspeed_mps=limits.airspeed_mps, course_rad=course_rad, right=True, wind=wind)
    if smallest_m > largest_m or not early_s >= smallest_m * lap_of_one_m + _TO_SPARE_S:
        return 0.0
    laps = math.ceil(early_s / (largest_m * lap_of_one_m))
    if early_s >= laps * smallest_m * lap_of_one_m:
        return early_s
    return (laps - 1) * largest_m * lap_of_one_m * _WHOLE
