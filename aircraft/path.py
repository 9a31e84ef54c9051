"""What a path is laid through, the segments it is laid out of, and points on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

GRAVITY_MPS2 = 9.80665


class Phase(IntEnum):
    """What a stretch of the reference is."""

    LEAD_IN = 0
    LEG = 1
    TURN = 2
    LOITER = 3


class PathPoint(NamedTuple):
    """A waypoint in the plane. Two in a row at one position ask for a loiter of the time between them.

    `scale`: plane metres per true metre here (one in a plane that does not stretch).
    """

    north_m: float
    east_m: float
    altitude_m: float
    time_s: float
    scale: float


class Segment(NamedTuple):
    """A stretch of constant curvature, speed and climb; plane metres, curvature right turn positive."""

    north_m: float
    east_m: float
    course_rad: float
    curvature: float
    length_m: float
    scale: float
    phase: Phase
    start_time_s: float
    end_time_s: float
    start_altitude_m: float
    end_altitude_m: float


class Row(NamedTuple):
    """A segment as plain floats; slopes are per plane metre."""

    north_m: float
    east_m: float
    course_rad: float
    curvature: float
    length_m: float
    time_s: float
    time_slope: float
    altitude_m: float
    climb_slope: float
    speed_mps: float
    climb_mps: float
    scale: float
    phase: Phase


class ReferencePoint(NamedTuple):
    """The reference at one distance along it."""

    north_m: float
    east_m: float
    altitude_m: float
    time_s: float
    course_rad: float
    curvature_radpm: float  # per true metre, right turn positive
    speed_mps: float  # true ground speed of the schedule
    climb_mps: float
    scale: float
    phase: Phase


class Target(NamedTuple):
    """What the reference asks for at one distance along it: a `ReferencePoint` without its position.

    `straight_to_m`: as far along it, course, speed and climb are the same; -inf on a curve.
    """

    altitude_m: float
    time_s: float
    course_rad: float
    curvature_radpm: float
    speed_mps: float
    climb_mps: float
    phase: Phase
    straight_to_m: float


class ReferencePoints(NamedTuple):
    """The reference at many distances along it, arrays of one shape; units as in `ReferencePoint`."""

    north_m: Floats
    east_m: Floats
    altitude_m: Floats
    time_s: Floats
    course_rad: Floats
    curvature_radpm: Floats
    speed_mps: Floats
    climb_mps: Floats
    scale: Floats
    phase: NDArray[np.int64]


WindAt = Callable[[float, float, float], tuple[float, float]]
"""(north_m, east_m, time_s) -> wind toward (north_mps, east_mps), for timing loiter circles."""


def along(
    north_m: float, east_m: float, course_rad: float, curvature: float, distance_m: float
) -> tuple[float, float]:
    """The position (north_m, east_m) a distance along a line or circle that starts at a position and course.

    The chord of an arc: its length is the arc's times sin(x)/x with x half the angle turned, its course the
    mean of the first and the last.
    """
    half_rad = 0.5 * curvature * distance_m
    chord_m = distance_m * math.sin(half_rad) / half_rad if abs(half_rad) > 1e-9 else distance_m
    middle_rad = course_rad + half_rad
    return north_m + chord_m * math.cos(middle_rad), east_m + chord_m * math.sin(middle_rad)
