"""When a flight passed the waypoints of its plan, from its progress along the reference."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from aircraft.reference import Reference

Floats = NDArray[np.float64]

PASSED_M = 1.0
"""A waypoint counts as passed from this plane distance on: a flight may end a step before its last one."""


def progress_m(reference: Reference, north_m: Floats, east_m: Floats, path_m: Floats) -> Floats:
    """Distance along the reference, and straight on behind its end, where projections stop; plane metres."""
    end = reference.at(reference.end_m)
    north, east = np.cos(end.course_rad), np.sin(end.course_rad)
    beyond_m = (north_m - end.north_m) * north + (east_m - end.east_m) * east
    at_end = path_m >= reference.end_m - 1e-6
    extended_m: Floats = path_m + np.where(at_end, np.maximum(beyond_m, 0.0), 0.0)
    return extended_m


def passing_times_s(waypoint_path_m: Floats, time_s: Floats, path_m: Floats) -> Floats:
    """The time at which progress first reaches each waypoint, between samples linearly; NaN if it never does.

    Args:
        waypoint_path_m: distance of each waypoint along the reference, plane metres, shape (waypoints,).
        time_s: of the samples, rising, shape (samples,).
        path_m: progress at the samples, plane metres; where it falls back, the farthest so far counts.
    """
    farthest_m = np.maximum.accumulate(path_m)
    end_m = farthest_m[-1]
    aim_m = np.minimum(waypoint_path_m, end_m)
    after = np.searchsorted(farthest_m, aim_m)
    before = np.maximum(after - 1, 0)
    way_m = farthest_m[after] - farthest_m[before]
    share = np.divide(aim_m - farthest_m[before], way_m, out=np.ones_like(aim_m), where=way_m > 0.0)
    passed_s = time_s[before] + share * (time_s[after] - time_s[before])
    reached: Floats = np.where(waypoint_path_m <= end_m + PASSED_M, passed_s, np.nan)
    return reached
