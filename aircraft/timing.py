"""The schedule between two waypoints: one airspeed, so that ground speed follows wind and course."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from aircraft.path import Floats, WindAt

_SLOWEST = 0.25  # share of the mean ground speed below which no stretch is timed, however strong the wind
_FASTEST_MPS = 400.0
_HALVINGS = 32


class Stretch(NamedTuple):
    """A short piece of path about its middle: plane position, course, and true length."""

    north_m: float
    east_m: float
    course_rad: float
    length_m: float


def times_at_one_airspeed(
    stretches: Sequence[Stretch], begin_s: float, end_s: float, wind_at: WindAt | None
) -> Floats:
    """When the end of each stretch is reached, at the one airspeed that takes the whole time.

    Over ground the speed at a course is w_t + sqrt(V^2 - w_n^2), with w_t and w_n the wind along and across
    it; the sum of length over speed falls with V, which is found by halving. The wind is taken at the time
    that an even speed would give each stretch.

    Args:
        stretches: in the order flown.
        begin_s: at the beginning of the first.
        end_s: at the end of the last.
        wind_at: still air, and so one ground speed, if None.

    Returns:
        Shape (stretches,); the last is exactly `end_s`.
    """
    length_m = np.array([stretch.length_m for stretch in stretches])
    ends_m = np.cumsum(length_m)
    took_s = length_m
    if wind_at is not None and len(stretches) > 1:
        even_s = begin_s + (ends_m - length_m / 2.0) / ends_m[-1] * (end_s - begin_s)
        winds = np.array(
            [
                wind_at(stretch.north_m, stretch.east_m, time_s)
                for stretch, time_s in zip(stretches, even_s.tolist(), strict=True)
            ]
        )
        course_rad = np.array([stretch.course_rad for stretch in stretches])
        cosine, sine = np.cos(course_rad), np.sin(course_rad)
        along_mps = winds[:, 0] * cosine + winds[:, 1] * sine
        across_mps = winds[:, 1] * cosine - winds[:, 0] * sine
        took_s = _times_s(length_m, along_mps, across_mps, end_s - begin_s)
    done = np.cumsum(took_s)
    times_s: Floats = begin_s + done / done[-1] * (end_s - begin_s)
    times_s[-1] = end_s
    return times_s


def _times_s(length_m: Floats, along_mps: Floats, across_mps: Floats, whole_s: float) -> Floats:
    """Seconds on each stretch at the airspeed with which they come to the whole."""
    slowest_mps = _SLOWEST * float(length_m.sum()) / whole_s
    low_mps, high_mps = 0.0, _FASTEST_MPS
    for _ in range(_HALVINGS):
        airspeed_mps = 0.5 * (low_mps + high_mps)
        ahead_mps = np.sqrt(np.maximum(airspeed_mps * airspeed_mps - across_mps * across_mps, 0.0))
        times_s: Floats = length_m / np.maximum(along_mps + ahead_mps, slowest_mps)
        if times_s.sum() > whole_s:
            low_mps = airspeed_mps
        else:
            high_mps = airspeed_mps
    return times_s
