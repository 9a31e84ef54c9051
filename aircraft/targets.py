"""What a curve asks for at distances along it, one after the other and each near the last."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence

from aircraft.path import Phase, Row, Target

_new_tuple = tuple.__new__  # makes a named tuple of a tuple in a third of the time of its constructor

_Stretch = tuple[
    float, float, float, float, float, float, float, float, float, float, float, float, Phase, float
]
"""Its ends; where it is counted from; altitude, time and course there and their slopes; what is constant."""


class Targets:
    """Remembers the stretch that was asked for last, so that most questions need no search."""

    __slots__ = ("_last", "_starts", "_stretches")

    def __init__(self, starts: Sequence[float], rows: Sequence[Row]) -> None:
        """Take the segments of a curve, and where along it each begins, plane metres.

        Before the first and behind the last come stretches without end, on which nothing changes.
        """
        end_m = starts[-1] + rows[-1].length_m
        self._starts = [-math.inf, *starts, end_m]
        self._stretches = [
            _stretch(-math.inf, starts[0], starts[0], rows[0], 0.0),
            *map(_stretch, starts, [*starts[1:], end_m], starts, rows, [1.0] * len(rows)),
            _stretch(end_m, math.inf, starts[-1], rows[-1], 0.0, rows[-1].length_m),
        ]
        self._last = self._stretches[0]

    def at(self, path_m: float) -> Target:
        """What is asked for at a distance along the curve."""
        stretch = self._last
        if not stretch[0] <= path_m < stretch[1]:
            stretch = self._last = self._stretches[bisect_right(self._starts, path_m) - 1]
        (
            _,
            _,
            start_m,
            altitude_m,
            climb_slope,
            time_s,
            time_slope,
            course_rad,
            curvature,
            curvature_radpm,
            speed_mps,
            climb_mps,
            phase,
            straight_to_m,
        ) = stretch
        along_m = path_m - start_m
        return _new_tuple(
            Target,
            (
                altitude_m + climb_slope * along_m,
                time_s + time_slope * along_m,
                course_rad + curvature * along_m,
                curvature_radpm,
                speed_mps,
                climb_mps,
                phase,
                straight_to_m,
            ),
        )


def _stretch(
    low_m: float, high_m: float, start_m: float, row: Row, changing: float, along_m: float = 0.0
) -> _Stretch:
    """A segment between two distances; with `changing` zero, all of it as the segment is at `along_m`."""
    return (
        low_m,
        high_m,
        start_m,
        row.altitude_m + row.climb_slope * along_m,
        row.climb_slope * changing,
        row.time_s + row.time_slope * along_m,
        row.time_slope * changing,
        row.course_rad + row.curvature * along_m,
        row.curvature * changing,
        row.curvature * row.scale,
        row.speed_mps,
        row.climb_mps,
        row.phase,
        -math.inf if row.curvature and changing else high_m,
    )
