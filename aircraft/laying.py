"""Laying a flyable curve through waypoints: what the plan's straight legs become before they are flown."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from aircraft.corners import Corner, bulb, corner
from aircraft.errors import PathError
from aircraft.loiters import ARCS, Laps, fit_laps
from aircraft.path import GRAVITY_MPS2, PathPoint, Phase, Segment, WindAt, along
from aircraft.timing import Stretch, times_at_one_airspeed

_SAME_PLACE_M = 1.0
_NOTHING_M = 1e-6  # pieces shorter than this are rounding
_LONGEST_M = 700.0  # true metres with one ground speed
_WIDEST_RAD = math.radians(20.0)  # of turn with one ground speed
_COURSES = 7  # on which the ground speed in a corner is looked at
_BANK_SHARE = 0.72  # of the tangent of the highest bank, that a corner takes where all is as forecast


@dataclass(frozen=True, slots=True)
class Style:
    """How to lay a path; lengths in true metres."""

    turn_radius_m: float
    loiter_radius_m: float
    lead_in_s: float
    loiter_airspeed_mps: float
    bank_max_rad: float
    wind_at: WindAt | None

    def __post_init__(self) -> None:
        for name in ("turn_radius_m", "loiter_radius_m", "loiter_airspeed_mps", "bank_max_rad"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise PathError(f"{name} is {getattr(self, name)}; it must be positive")
        if not 0.0 <= self.lead_in_s < math.inf:
            raise PathError(f"lead_in_s is {self.lead_in_s}; it must be zero or more")


class Leg(NamedTuple):
    """The straight line between two places: plane metres, and true speed over ground."""

    length_m: float
    course_rad: float
    speed_mps: float


class Stop(NamedTuple):
    """A place on the way, and how it is passed: half-way round its corner, at a position on a course.

    `points`: the waypoint, or all the waypoints of a wait, whose time is filled with `laps`.
    """

    points: Sequence[PathPoint]
    corner: Corner
    laps: Laps | None
    north_m: float
    east_m: float
    course_rad: float


class Piece(NamedTuple):
    """A piece of a leg before it has times; plane metres, straight where the curvature is zero."""

    curvature: float
    length_m: float
    phase: Phase


def lay(points: Sequence[PathPoint], style: Style, circling_rad: float | None = None) -> list[Segment]:
    """The segments of the curve in the order they are flown.

    Args:
        points: in the order flown.
        style: how to lay it.
        circling_rad: the course on which the first place is passed, where it is a wait under way; that of the
            first leg if None.

    Raises:
        PathError: see `gather` and `loiters.fit_laps`.
    """
    places = gather(points)
    legs = [_leg(a[-1], b[0]) for a, b in pairwise(places)]
    before = [legs[0] if legs else Leg(math.inf, 0.0, 0.0), *legs]
    after = [*legs, before[-1]]
    first = 0
    stops: list[Stop] = []
    for place, leg, next_leg in zip(places, before, after, strict=True):
        if circling_rad is not None and not stops:
            turn_rad = math.remainder(next_leg.course_rad - circling_rad, 2.0 * math.pi)
            leg = leg._replace(course_rad=circling_rad - turn_rad)  # half-way round, it is on that course
            stops.append(_waiting(place, "waypoint 0", leg, 2.0 * turn_rad, next_leg.length_m / 2.0, style))
        else:
            stops.append(_stop(place, f"waypoint {first}", leg, next_leg, style))
        first += len(place)

    segments: list[Segment] = []
    for i, stop in enumerate(stops):
        segments.extend(circles(stop))
        if i < len(legs):
            segments.extend(_stretch(stop, stops[i + 1], legs[i].length_m, style.wind_at))
    return [*_lead_in(stops, segments, style), *segments]


def gather(points: Sequence[PathPoint]) -> list[list[PathPoint]]:
    """The points with those at one place, which are a wait, put together.

    Raises:
        PathError: if there are fewer than two points, one is not finite, or the times do not rise.
    """
    if len(points) < 2:
        raise PathError(f"a path needs two waypoints or more, not {len(points)}; add the goal, or a wait")
    for index, point in enumerate(points):
        if not (all(map(math.isfinite, point)) and point.scale > 0.0):
            raise PathError(
                f"waypoint {index} is not finite or its scale is not positive: {point}; mend the plan"
            )
    places = [[points[0]]]
    for index, (before, here) in enumerate(pairwise(points), start=1):
        if not here.time_s > before.time_s:
            raise PathError(
                f"waypoint {index} is to be passed at {here.time_s:.3f} s, not after waypoint {index - 1} "
                f"({before.time_s:.3f} s); drop one of them or let the times rise"
            )
        if math.dist(places[-1][0][:2], here[:2]) < _SAME_PLACE_M:
            places[-1].append(here)
        else:
            places.append([here])
    return places


def _leg(start: PathPoint, end: PathPoint) -> Leg:
    north_m, east_m = end.north_m - start.north_m, end.east_m - start.east_m
    length_m, scale = math.hypot(north_m, east_m), (start.scale + end.scale) / 2.0
    return Leg(length_m, math.atan2(east_m, north_m), length_m / scale / (end.time_s - start.time_s))


def _stop(points: Sequence[PathPoint], name: str, leg: Leg, next_leg: Leg, style: Style) -> Stop:
    """Shape the corner between two legs; it may use half of each."""
    turn_rad = math.remainder(next_leg.course_rad - leg.course_rad, 2.0 * math.pi)
    room_m = min(leg.length_m, next_leg.length_m) / 2.0
    if len(points) > 1:
        return _waiting(points, name, leg, turn_rad, room_m, style)
    point = points[0]
    middle_rad = leg.course_rad + turn_rad / 2.0
    radius_m = max(style.turn_radius_m, _banked_radius_m(point, leg, next_leg, turn_rad, style))
    shape = corner(turn_rad, radius_m * point.scale, room_m)
    inward_rad = middle_rad + math.copysign(math.pi / 2.0, turn_rad)
    north_m = point.north_m + shape.cut_m * math.cos(inward_rad)
    east_m = point.east_m + shape.cut_m * math.sin(inward_rad)
    return Stop(points, shape, None, north_m, east_m, middle_rad)


def _waiting(
    points: Sequence[PathPoint], name: str, leg: Leg, turn_rad: float, room_m: float, style: Style
) -> Stop:
    """Shape a wait: laps through the waypoint, which is passed half-way round the turn."""
    point, middle_rad = points[0], leg.course_rad + turn_rad / 2.0
    widest = bulb(turn_rad, style.loiter_radius_m * point.scale, room_m)
    laps = fit_laps(
        points[-1].time_s - point.time_s,
        radius_max_m=widest.radius_m / point.scale,
        airspeed_mps=style.loiter_airspeed_mps,
        course_rad=middle_rad,
        right=widest.right,
        wind_after=_wind_after(point, style.wind_at),
        where=name,
    )
    shape = bulb(turn_rad, laps.radius_m * point.scale, room_m)
    return Stop(points, shape, laps, point.north_m, point.east_m, middle_rad)


def _banked_radius_m(point: PathPoint, leg: Leg, next_leg: Leg, turn_rad: float, style: Style) -> float:
    """The turn that leaves bank in hand at the highest ground speed of the corner: true metres.

    The speed is that of the faster airspeed of the two legs, in the wind at the waypoint and its time, on
    that course of the turn which has most tailwind.
    """
    north_mps, east_mps = style.wind_at(*point[:2], point.time_s) if style.wind_at else (0.0, 0.0)
    airspeed_mps = max(
        math.hypot(
            side.speed_mps * math.cos(side.course_rad) - north_mps,
            side.speed_mps * math.sin(side.course_rad) - east_mps,
        )
        for side in (leg, next_leg)
    )
    speed_mps = max(leg.speed_mps, next_leg.speed_mps)
    for share in np.linspace(0.0, 1.0, _COURSES).tolist():
        course_rad = leg.course_rad + share * turn_rad
        tail_mps = north_mps * math.cos(course_rad) + east_mps * math.sin(course_rad)
        cross_mps = east_mps * math.cos(course_rad) - north_mps * math.sin(course_rad)
        ahead_mps = math.sqrt(max(airspeed_mps * airspeed_mps - cross_mps * cross_mps, 0.0))
        speed_mps = max(speed_mps, tail_mps + ahead_mps)
    return banked_radius_m(speed_mps, style.bank_max_rad)


def banked_radius_m(speed_mps: float, bank_max_rad: float) -> float:
    """The turn at a speed over ground that leaves bank in hand."""
    return speed_mps * speed_mps / (_BANK_SHARE * GRAVITY_MPS2 * math.tan(bank_max_rad))


def _wind_after(point: PathPoint, wind_at: WindAt | None) -> Callable[[float], tuple[float, float]]:
    """The wind at a point, seconds after its time."""
    if wind_at is None:
        return lambda _: (0.0, 0.0)
    return lambda after_s: wind_at(point.north_m, point.east_m, point.time_s + after_s)


def circles(stop: Stop) -> list[Segment]:
    """The laps of a wait; none where there is no wait."""
    if stop.laps is None:
        return []
    scale = stop.points[0].scale
    times_s = stop.points[0].time_s + np.concatenate([[0.0], np.cumsum(stop.laps.arc_times_s)])
    times_s[-1] = stop.points[-1].time_s
    altitudes_m = np.interp(times_s, [p.time_s for p in stop.points], [p.altitude_m for p in stop.points])
    arc_m = 2.0 * math.pi * stop.corner.radius_m / ARCS
    curvature = (1.0 if stop.corner.right else -1.0) / stop.corner.radius_m
    segments = []
    for i in range(len(times_s) - 1):
        done_m = i % ARCS * arc_m
        north_m, east_m = along(stop.north_m, stop.east_m, stop.course_rad, curvature, done_m)
        segments.append(
            Segment(
                north_m,
                east_m,
                stop.course_rad + curvature * done_m,
                curvature,
                arc_m,
                scale,
                Phase.LOITER,
                *map(float, times_s[i : i + 2]),
                *map(float, altitudes_m[i : i + 2]),
            )
        )
    return segments


def _stretch(start: Stop, end: Stop, leg_m: float, wind_at: WindAt | None) -> list[Segment]:
    """From half-way round one corner to half-way round the next."""
    straight_m = leg_m - start.corner.tangent_m - end.corner.tangent_m
    pieces = [
        *(Piece(curvature, length_m, Phase.TURN) for curvature, length_m in reversed(start.corner.arcs)),
        Piece(0.0, straight_m, Phase.LEG),
        *(Piece(curvature, length_m, Phase.TURN) for curvature, length_m in end.corner.arcs),
    ]
    return list(_timed([piece for piece in pieces if piece.length_m > _NOTHING_M], start, end, wind_at))


def _timed(pieces: Sequence[Piece], start: Stop, end: Stop, wind_at: WindAt | None) -> Iterable[Segment]:
    """Spread the climb between two stops evenly over the pieces between them, the time at one airspeed."""
    leaving, arriving = start.points[-1], end.points[0]
    scale = (leaving.scale + arriving.scale) / 2.0
    parts = list(_parts(pieces, scale)) if wind_at else pieces
    length_m = sum(part.length_m for part in parts)
    places, stretches = [], []
    north_m, east_m, course_rad = start.north_m, start.east_m, start.course_rad
    for part in parts:
        places.append((north_m, east_m, course_rad))
        turned_rad = part.curvature * part.length_m
        middle = along(north_m, east_m, course_rad, part.curvature, part.length_m / 2.0)
        stretches.append(Stretch(*middle, course_rad + turned_rad / 2.0, part.length_m / scale))
        north_m, east_m = along(north_m, east_m, course_rad, part.curvature, part.length_m)
        course_rad += turned_rad
    ends_s = times_at_one_airspeed(stretches, leaving.time_s, arriving.time_s, wind_at).tolist()
    time_s, altitude_m, done_m = leaving.time_s, leaving.altitude_m, 0.0
    for i, (place, part, end_s) in enumerate(zip(places, parts, ends_s, strict=True), start=1):
        done_m += part.length_m
        share = 1.0 if i == len(parts) else done_m / length_m
        end_altitude_m = leaving.altitude_m + share * (arriving.altitude_m - leaving.altitude_m)
        yield Segment(*place, *part[:2], scale, part.phase, time_s, end_s, altitude_m, end_altitude_m)
        time_s, altitude_m = end_s, end_altitude_m


def _parts(pieces: Sequence[Piece], scale: float) -> Iterable[Piece]:
    """The pieces cut into equal parts, short enough that each may have one ground speed."""
    for piece in pieces:
        turned_rad = abs(piece.curvature) * piece.length_m
        count = math.ceil(max(piece.length_m / scale / _LONGEST_M, turned_rad / _WIDEST_RAD) - 1e-9)
        yield from [piece._replace(length_m=piece.length_m / count)] * count


def _lead_in(stops: Sequence[Stop], segments: Sequence[Segment], style: Style) -> list[Segment]:
    """The straight stretch that ends at the first stop, at the ground speed of the first leg."""
    if style.lead_in_s == 0.0:
        return []
    first = stops[0]
    point = first.points[0]
    speed_mps = style.loiter_airspeed_mps * point.scale
    leg = next((segment for segment in segments if segment.phase != Phase.LOITER), None)
    if leg is not None:
        speed_mps = leg.length_m / (leg.end_time_s - leg.start_time_s)
    length_m = speed_mps * style.lead_in_s
    north_m, east_m = along(first.north_m, first.east_m, first.course_rad, 0.0, -length_m)
    return [
        Segment(
            north_m,
            east_m,
            first.course_rad,
            0.0,
            length_m,
            point.scale,
            Phase.LEAD_IN,
            point.time_s - style.lead_in_s,
            point.time_s,
            point.altitude_m,
            point.altitude_m,
        )
    ]
