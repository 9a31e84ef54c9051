"""The wind triangle: ground speed along a course at a true airspeed, and the time that an edge takes.

The ground speed on an edge is taken linear in time between the times of the air. It depends on time only,
so the distance covered by a time is one rising function of it, S(t), and an aircraft that leaves at t arrives
at S^-1(S(t) + length): who leaves first arrives first, exactly.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from planner.windfield import Floats


def ground_speed(along_mps: Any, across_mps: Any, airspeed_mps: Any) -> Any:
    """Speed over ground on a course [m/s] while the nose points up wind by the drift.

    Args:
        along_mps: wind toward the course's end; scalar or array.
        across_mps: wind to the side of it, either sign.
        airspeed_mps: true airspeed; scalar or array.

    Returns:
        Along + sqrt(airspeed^2 - across^2); not a number where the cross wind exceeds the airspeed.
    """
    return along_mps + np.sqrt(airspeed_mps * airspeed_mps - across_mps * across_mps)


class SpeedAt(Protocol):
    """Ground speeds of some of the edges at one time of the air."""

    def __call__(self, place: int, which: NDArray[np.intp]) -> Floats:
        """`place`: index of the time. `which`: the edges, shape (n,); their speeds come back, (n,) [m/s]."""
        ...


def arrival_times(
    depart_s: Floats, length_m: Floats, time_s: Floats, place: int, speed_at: SpeedAt
) -> Floats:
    """When edges that are left within one span of the air's times have been flown.

    Args:
        depart_s: shape (n,), each between `time_s[place]` and `time_s[place + 1]`.
        length_m: of each edge, shape (n,).
        time_s: times of the air, rising, shape (K,).
        place: the span in which all are left.
        speed_at: ground speeds, positive until the arrival; what they are later does not matter, so that they
            may be negative or not a number in cells that have become hazardous by then.

    Returns:
        Shape (n,) [s]; infinite beyond the last time.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        return _arrival_times(depart_s, length_m, time_s, place, speed_at)


def _arrival_times(
    depart_s: Floats, length_m: Floats, time_s: Floats, place: int, speed_at: SpeedAt
) -> Floats:
    arrive_s = np.full(depart_s.shape, np.inf)
    which = np.arange(depart_s.size)
    from_s, left_m = depart_s, length_m
    before = speed_at(place, which)
    while which.size and place + 1 < time_s.size:
        low_s, high_s = float(time_s[place]), float(time_s[place + 1])
        after = speed_at(place + 1, which)
        slope = (after - before) / (high_s - low_s)
        speed = before + slope * (from_s - low_s)
        in_span_m = 0.5 * (speed + after) * (high_s - from_s)
        inside = left_m <= in_span_m
        # the root of speed d + slope d^2 / 2 = length, in the form that keeps its digits
        square = np.maximum(speed * speed + 2.0 * slope * left_m, 0.0)
        took_s = 2.0 * left_m / (speed + np.sqrt(square))
        arrive_s[which[inside]] = np.minimum(from_s + took_s, high_s)[inside]
        beyond = ~inside
        which, before, left_m = which[beyond], after[beyond], (left_m - in_span_m)[beyond]
        from_s = np.full(which.shape, high_s)
        place += 1
    return arrive_s
