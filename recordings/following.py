"""A flight against the references that it followed, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from aircraft.reference import Reference
from recordings.passing import passing_times_s, progress_m
from recordings.recording import Issue

Floats = NDArray[np.float64]


class Followed(NamedTuple):
    """Each sample against the reference of its time, and each waypoint by the reference that it was left in.

    Of samples, shape (samples,): way left to the last waypoint [plane metres], errors to the right, above and
    late positive, phase of the reference at the nearest point of it. Of waypoints, shape (waypoints,): when
    passed, NaN if never, and the point of the reference there, plane metres, with its phase.
    """

    to_go_m: Floats
    cross_track_m: Floats
    altitude_error_m: Floats
    time_error_s: Floats
    phase: NDArray[np.int64]
    passed_s: Floats
    nearest_north_m: Floats
    nearest_east_m: Floats
    waypoint_phase: NDArray[np.int64]


def follow(
    issues: Sequence[Issue],
    firsts: Sequence[int],
    time_s: Floats,
    north_m: Floats,
    east_m: Floats,
    altitude_m: Floats,
) -> Followed:
    """Measure the samples of one flight, shape (samples,) each, positions in plane metres.

    A reference passes those of its waypoints that the next one has no more; the last, all of its own.

    Args:
        issues: the references, in the order followed.
        firsts: of each the first waypoint that it passes, counted in the plan of its time.
        time_s: when, since departure.
        north_m: where.
        east_m: where.
        altitude_m: above the ellipsoid.
    """
    begins = np.searchsorted(time_s, [issue.time_s for issue in issues])
    begins[0] = 0  # lead-in and clock may differ by rounding
    ends = np.append(begins[1:], len(time_s))
    last = firsts[-1] + len(issues[-1].reference.waypoint_path_m)
    counts = np.diff([*firsts, last]).tolist()
    parts = [
        _follow(
            issue.reference,
            issue is not issues[0],
            count,
            *(column[begin:end] for column in (time_s, north_m, east_m, altitude_m)),
        )
        for issue, count, begin, end in zip(issues, counts, begins, ends, strict=True)
    ]
    return Followed(*map(np.concatenate, zip(*parts, strict=True)))


def _follow(
    reference: Reference,
    relaid: bool,
    count: int,
    time_s: Floats,
    north_m: Floats,
    east_m: Floats,
    altitude_m: Floats,
) -> Followed:
    """The samples of one reference, and its first waypoints, which were not left to the next one.

    One that was laid anew begins where the aircraft was, however late or early it was there.
    """
    near_m = reference.path_at_times(time_s)
    lead_m = -float(near_m[0]) if relaid and len(near_m) else 0.0
    path_m, cross_track_m = reference.project_many(north_m, east_m, near_m, lead_m)
    waypoints_m = reference.waypoint_path_m[:count]
    passed_s = np.full(len(waypoints_m), np.nan)
    if len(time_s):
        passed_s = passing_times_s(waypoints_m, time_s, progress_m(reference, north_m, east_m, path_m))
    beside, nearest = reference.at_many(path_m), reference.at_many(waypoints_m)
    return Followed(
        reference.waypoint_path_m[-1] - path_m,
        cross_track_m,
        altitude_m - beside.altitude_m,
        time_s - beside.time_s,
        beside.phase,
        passed_s,
        nearest.north_m,
        nearest.east_m,
        nearest.phase,
    )
