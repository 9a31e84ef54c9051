"""A reference laid anew in flight: it begins where the aircraft is, and passes the waypoints that are left.

What it takes over from the old one agrees with that in position, course and altitude to the last digit, so
that an aircraft goes over from one to the other without noticing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from aircraft.errors import PathError
from aircraft.path import Phase, Segment, along
from aircraft.reference import Reference

_NOTHING_M = 1e-6  # pieces shorter than this are rounding


def part(reference: Reference, from_m: float, to_m: float, later_s: float = 0.0) -> list[Segment]:
    """The segments between two distances along a reference [plane metres], those at the ends cut there.

    `later_s` is added to all their times.
    """
    columns = (
        reference.north_m,
        reference.east_m,
        reference.course_rad,
        reference.curvature,
        reference.length_m,
        reference.scale,
        reference.phase,
        reference.start_time_s,
        reference.end_time_s,
        reference.start_altitude_m,
        reference.end_altitude_m,
        reference.start_m,
    )
    first = max(int(np.searchsorted(reference.start_m, from_m, side="right")) - 1, 0)
    last = int(np.searchsorted(reference.start_m, to_m, side="left"))
    pieces = []
    for *row, start_m in zip(*(column[first:last].tolist() for column in columns), strict=True):
        segment = Segment(*row)._replace(phase=Phase(row[6]))
        piece = _between(segment, max(from_m - start_m, 0.0), min(to_m - start_m, segment.length_m))
        if piece.length_m > _NOTHING_M:
            begin_s, end_s = piece.start_time_s + later_s, piece.end_time_s + later_s
            pieces.append(piece._replace(start_time_s=begin_s, end_time_s=end_s))
    return pieces


def _between(segment: Segment, from_m: float, to_m: float) -> Segment:
    """A piece of a segment; an end that is not cut off stays exactly as it was."""
    if to_m < segment.length_m:
        time_s, altitude_m = _on_the_way(segment, to_m)
        segment = segment._replace(length_m=to_m, end_time_s=time_s, end_altitude_m=altitude_m)
    if from_m > 0.0:
        time_s, altitude_m = _on_the_way(segment, from_m)
        north_m, east_m = along(*segment[:4], from_m)
        segment = segment._replace(
            north_m=north_m,
            east_m=east_m,
            course_rad=segment.course_rad + segment.curvature * from_m,
            length_m=segment.length_m - from_m,
            start_time_s=time_s,
            start_altitude_m=altitude_m,
        )
    return segment


def _on_the_way(segment: Segment, along_m: float) -> tuple[float, float]:
    """Time and altitude at a distance along a segment."""
    share = along_m / segment.length_m
    return (
        segment.start_time_s + share * (segment.end_time_s - segment.start_time_s),
        segment.start_altitude_m + share * (segment.end_altitude_m - segment.start_altitude_m),
    )


def with_detour(
    reference: Reference, from_m: float, leave_m: float, detour: Sequence[Segment], rejoin_m: float
) -> Reference:
    """What is left of a reference, with a detour in it.

    From `rejoin_m` on it is the old one with its times; before `leave_m` it is that, too, but as much earlier
    or later as the times of the detour's beginning ask. Waypoints between these two are passed no more.

    Args:
        reference: the one followed so far.
        from_m: where along it the new one begins, plane metres, as the two below.
        leave_m: where it is left for the detour.
        detour: begins where it is left and ends where it is joined again, at its time there.
        rejoin_m: where it is joined again, not before `leave_m`.

    Raises:
        PathError: if these places are not in order, or no waypoint is left.
    """
    last_m = float(reference.waypoint_path_m[-1])
    if not (0.0 <= from_m <= leave_m <= rejoin_m <= last_m and from_m < last_m):
        raise PathError(
            f"a detour from {from_m:.1f} m, off the path at {leave_m:.1f} m and on it again at "
            f"{rejoin_m:.1f} m, is not in this order before the last waypoint at {last_m:.1f} m; lay another"
        )
    later_s = detour[0].start_time_s - reference.at(leave_m).time_s if detour else 0.0
    before = part(reference, from_m, leave_m, later_s)
    segments = [*before, *detour, *part(reference, rejoin_m, reference.end_m)]
    longer_m = sum(segment.length_m for segment in detour) - (rejoin_m - leave_m)
    waypoints_m = reference.waypoint_path_m[reference.waypoint_path_m > from_m]
    waypoints_m = waypoints_m[(waypoints_m < leave_m) | (waypoints_m >= rejoin_m)]
    waypoints_m = waypoints_m - from_m + np.where(waypoints_m >= rejoin_m, longer_m, 0.0)
    return Reference.of(segments, waypoints_m)
