"""Waiting in wind: as many whole laps of a circle, at one airspeed, as take exactly the time to wait."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from aircraft.errors import PathError
from aircraft.path import Floats

ARCS = 16
"""Arcs to a lap, each with its own ground speed."""

STRONGEST_WIND = 0.8
"""Of the airspeed; above it the upwind half of a lap hardly moves, and there are no loiters."""

_SAMPLES = 4  # of the ground speed, in each arc


@dataclass(frozen=True, slots=True)
class Laps:
    """`radius_m`: true metres. `arc_times_s`: seconds on each arc, shape (laps, ARCS), in sum the wait."""

    radius_m: float
    arc_times_s: Floats


def fit_laps(
    wait_s: float,
    *,
    radius_max_m: float,
    airspeed_mps: float,
    course_rad: float,
    right: bool,
    wind_after: Callable[[float], tuple[float, float]],
    where: str,
) -> Laps:
    """The fewest whole laps that fill a wait at a constant airspeed, on a circle no wider than allowed.

    Over ground the speed at a course is w_t + sqrt(V^2 - w_n^2), with w_t and w_n the wind along and across
    it; the time of a lap is the integral of R / speed over the course, so it is proportional to R, and R is
    what is fitted. With two or more laps it comes out above half of what is allowed (two thirds for three).

    Args:
        wait_s: time to spend.
        radius_max_m: largest radius, true metres.
        airspeed_mps: true airspeed to hold.
        course_rad: course at the beginning and end of each lap.
        right: sense of turn.
        wind_after: wind toward (north_mps, east_mps) at seconds after the beginning of the wait.
        where: names the waypoint in messages.

    Raises:
        PathError: if the wait is shorter than half a lap, or the wind too strong for the airspeed.
    """
    laps = 1
    while True:
        winds = np.array([wind_after((lap + 0.5) * wait_s / laps) for lap in range(laps)], dtype=np.float64)
        strongest_mps = float(np.hypot(winds[:, 0], winds[:, 1]).max())
        if not strongest_mps <= STRONGEST_WIND * airspeed_mps:
            raise PathError(
                f"the wind of {strongest_mps:.1f} m/s at {where} is too strong to circle in at an airspeed "
                f"of {airspeed_mps:.1f} m/s (limit {STRONGEST_WIND * airspeed_mps:.1f} m/s); "
                "wait elsewhere or at a higher loiter airspeed"
            )
        unit_times_s = _unit_times_s(winds, airspeed_mps, course_rad, right)
        radius_m = wait_s / float(unit_times_s.sum())
        if radius_m <= radius_max_m:
            break
        laps = max(laps + 1, math.ceil(laps * radius_m / radius_max_m))
    if radius_m < 0.5 * radius_max_m and laps == 1:
        raise PathError(
            f"the wait of {wait_s:.1f} s at {where} is shorter than half a lap of the loiter circle "
            f"({0.5 * radius_max_m * wait_s / radius_m:.1f} s at {radius_max_m:.0f} m radius); "
            "wait longer, not at all, or on a smaller circle"
        )
    return Laps(radius_m, unit_times_s * radius_m)


def lap_s(
    radius_m: float, *, airspeed_mps: float, course_rad: float, right: bool, wind: tuple[float, float]
) -> float:
    """How long one lap takes in a wind toward (north_mps, east_mps) that does not change; see `fit_laps`.

    Infinite where that is too strong to circle in.
    """
    if not math.hypot(*wind) <= STRONGEST_WIND * airspeed_mps:
        return math.inf
    return radius_m * float(_unit_times_s(np.array([wind]), airspeed_mps, course_rad, right).sum())


def _unit_times_s(winds_mps: Floats, airspeed_mps: float, course_rad: float, right: bool) -> Floats:
    """Seconds on each arc of each lap of a circle of one metre radius, shape (laps, ARCS)."""
    count = ARCS * _SAMPLES
    turned_rad = (np.arange(count) + 0.5) * (2.0 * math.pi / count)
    course = course_rad + (turned_rad if right else -turned_rad)
    cosine, sine = np.cos(course), np.sin(course)
    tailwind = winds_mps[:, :1] * cosine + winds_mps[:, 1:] * sine
    crosswind = winds_mps[:, 1:] * cosine - winds_mps[:, :1] * sine
    speed = tailwind + np.sqrt(airspeed_mps**2 - crosswind**2)
    times_s: Floats = (2.0 * math.pi / count / speed).reshape(len(winds_mps), ARCS, _SAMPLES).sum(axis=2)
    return times_s
