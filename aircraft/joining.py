"""Where a reference can be left for one that goes elsewhere, and the reference that does so.

Two kinds of place, each passed by the old curve and by the new one on the same course:

- the straight part of a leg. The new path shares the leg, and bends off at the waypoint behind it; a corner
  takes no more than half of a leg, so from its beginning to its middle the leg is straight in both.
- the end of a lap of a wait. There the aircraft is at the waypoint on a known course, and can circle on or
  fly on to anywhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from aircraft.errors import PathError
from aircraft.loiters import ARCS
from aircraft.path import PathPoint, Phase, Segment
from aircraft.reference import Reference
from aircraft.relaying import part

_AHEAD_S = 3.0  # from the aircraft to the place: guidance looks ahead so far
_SAME_M = 1e-3  # plane metres that rounding may move a place on a leg
_SAME_PLACE_M = 1.0


class Joint(NamedTuple):
    """A place to leave a reference.

    `path_m`: where along it. `place`: among the waypoints that it passes, the one at whose position the new
    path begins; of a wait it is the second, whose time it does not keep. `circling`: at the end of a lap.
    `time_s`: of the old reference at that waypoint, or at the end of the lap.
    """

    path_m: float
    place: int
    circling: bool
    time_s: float


def joints(reference: Reference, points: Sequence[PathPoint], path_m: float) -> Iterator[Joint]:
    """The places ahead at which a reference can be left, the nearest first.

    Args:
        reference: followed so far.
        points: the waypoints that it was laid through; it passes the last ones of them, as many as it has.
        path_m: where along it the aircraft is, plane metres.
    """
    here = reference.at(path_m)
    from_m = path_m + _AHEAD_S * here.speed_mps * here.scale
    marks_m = reference.waypoint_path_m.tolist()
    passed = len(points) - len(marks_m)
    for place, mark_m in enumerate(marks_m):
        index = passed + place
        if mark_m < from_m or index == 0:
            continue
        before, point = points[index - 1], points[index]
        begin_m = marks_m[place - 1] if place else 0.0
        if math.dist(before[:2], point[:2]) < _SAME_PLACE_M:
            yield from _laps(reference, place, from_m, begin_m)
        else:
            found_m = _straight(reference, before, point, max(begin_m, from_m), mark_m)
            if found_m is not None:
                yield Joint(found_m, place, False, reference.at(mark_m).time_s)


def _straight(
    reference: Reference, before: PathPoint, point: PathPoint, from_m: float, to_m: float
) -> float | None:
    """The first place on a leg from which on it is straight to its middle at least; None if that is behind.

    A hold on the leg comes before it.
    """
    ends_m = reference.start_m + reference.length_m
    on = np.flatnonzero((ends_m > from_m) & (reference.start_m < to_m))
    straight = (reference.curvature[on] == 0.0) & (reference.phase[on] == Phase.LEG)
    circles = np.flatnonzero(reference.phase[on] == Phase.LOITER)
    on, straight = (column[circles[-1] + 1 if len(circles) else 0 :] for column in (on, straight))
    if not straight.any():
        return None
    found_m = max(float(reference.start_m[on[int(straight.argmax())]]), from_m)
    here = reference.at(found_m)
    left_m = math.dist((here.north_m, here.east_m), point[:2])
    half_m = math.dist(before[:2], point[:2]) / 2.0
    return found_m if left_m >= half_m - _SAME_M and here.curvature_radpm == 0.0 else None


def _laps(reference: Reference, place: int, from_m: float, begin_m: float) -> Iterator[Joint]:
    """The ends of all laps of a wait but the last, which ends where the wait does."""
    row = int(np.searchsorted(reference.start_m, reference.waypoint_path_m[place] - _SAME_M))
    ends_m = []
    while (row := row - ARCS) > 0 and reference.start_m[row] >= max(from_m, begin_m):
        if reference.phase[row] != Phase.LOITER:
            break
        ends_m.append(float(reference.start_m[row]))
    for end_m in reversed(ends_m):
        yield Joint(end_m, place, True, reference.at(end_m).time_s)


def joined(reference: Reference, from_m: float, joint: Joint, onward: Reference) -> Reference:
    """A reference from the aircraft's place on, that is left at a joint for another one.

    Position, course and altitude go on without a jump, and so does the time: what is left of a shared leg is
    flown at the speed that brings the aircraft to the waypoint behind it when the new path asks for it.

    Args:
        reference: followed so far.
        from_m: where along it the aircraft is, plane metres.
        joint: where it is left.
        onward: without lead-in; it begins at the waypoint before the joint's and shares the leg between the
            two, or at the end of the lap.

    Raises:
        PathError: if the two do not meet at the joint.
    """
    at = reference.at(joint.path_m)
    start = onward.at(0.0)
    on_m = 0.0 if joint.circling else math.dist((start.north_m, start.east_m), (at.north_m, at.east_m))
    later_s = 0.0 if joint.circling else onward.at(onward.waypoint_path_m[1]).time_s - joint.time_s
    _require_same(at, onward.at(on_m))
    segments = part(reference, from_m, joint.path_m, later_s)
    rest = part(onward, on_m, onward.end_m)
    if not joint.circling:
        rest = _retimed(rest, at.time_s + later_s, float(onward.waypoint_path_m[1]) - on_m)
    rest[0] = rest[0]._replace(start_altitude_m=at.altitude_m)
    kept_m = reference.waypoint_path_m[: joint.place]
    ahead_m = onward.waypoint_path_m[1:] - on_m + joint.path_m  # the first is the leg's beginning, or a lap's
    return Reference.of([*segments, *rest], np.concatenate([kept_m[kept_m > from_m], ahead_m]) - from_m)


def _require_same(old: tuple[float, ...], new: tuple[float, ...]) -> None:
    apart_m = math.dist(old[:2], new[:2])
    turn_rad = abs(math.remainder(old[4] - new[4], 2.0 * math.pi))
    if apart_m > _SAME_M or turn_rad > 1e-6:
        raise PathError(
            f"the new path lies {apart_m:.3f} m and {math.degrees(turn_rad):.4f} deg off where the old one "
            "is to be left; lay it through the waypoint before"
        )


def _retimed(segments: list[Segment], begin_s: float, until_m: float) -> list[Segment]:
    """The segments up to a distance, from another time on at proportionally other speeds."""
    end_m, done = 0.0, []
    for segment in segments:
        end_m += segment.length_m
        done.append(segment)
        if end_m > until_m - _SAME_M:
            break
    first_s, last_s = done[0].start_time_s, done[-1].end_time_s
    slope = (last_s - begin_s) / (last_s - first_s)
    moved = [
        segment._replace(
            start_time_s=last_s - slope * (last_s - segment.start_time_s),
            end_time_s=last_s - slope * (last_s - segment.end_time_s),
        )
        for segment in done
    ]
    return [*moved, *segments[len(done) :]]
