"""The flyable curve through a plan's waypoints: legs, fillets and loiter circles, with a time on each point.

Plane geometry in the metres of the planner's local frame (`planner.grid.LocalFrame`): those metres are
stretched by the local `scale`, plane metres = scale x true metres.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from aircraft.errors import PathError
from aircraft.laying import Style, lay
from aircraft.path import (
    Floats,
    PathPoint,
    Phase,
    ReferencePoint,
    ReferencePoints,
    Row,
    Segment,
    Target,
    WindAt,
)
from aircraft.projection import Projection, Projector
from aircraft.targets import Targets

__all__ = [
    "PathPoint",
    "Phase",
    "Projection",
    "Reference",
    "ReferencePoint",
    "ReferencePoints",
    "Target",
    "WindAt",
]


@dataclass(frozen=True, eq=False)
class Reference:
    """Segments of constant curvature, one array entry each, in the order they are flown (shape (n,)).

    All lengths and positions are plane metres, `curvature` is per plane metre (right turn positive),
    times are on the clock of the waypoints, earlier than the first of them in the lead-in. Within a segment
    course, time and altitude run linearly with distance. The arrays become read-only.
    `waypoint_path_m`: distance along the reference at which each path point is passed, shape (points,); of a
    reference that was laid anew in flight (`aircraft.relaying`) only of the points that were left to pass.
    """

    north_m: Floats
    east_m: Floats
    course_rad: Floats
    curvature: Floats
    length_m: Floats
    start_m: Floats
    start_time_s: Floats
    end_time_s: Floats
    start_altitude_m: Floats
    end_altitude_m: Floats
    scale: Floats
    phase: NDArray[np.int64]
    waypoint_path_m: Floats

    def __post_init__(self) -> None:
        for field in fields(self):
            array = getattr(self, field.name)
            if array.shape != self.start_m.shape and field.name != "waypoint_path_m":
                raise PathError(
                    f"{field.name} has the shape {array.shape}, start_m {self.start_m.shape}; "
                    "a reference needs one entry for each segment in all of its arrays"
                )
            array.setflags(write=False)

    @classmethod
    def through(
        cls,
        points: Sequence[PathPoint],
        *,
        turn_radius_m: float,
        loiter_radius_m: float,
        lead_in_s: float,
        wind_at: WindAt | None = None,
        loiter_airspeed_mps: float = 28.0,
        bank_max_rad: float = math.radians(35.0),
        circling_rad: float | None = None,
    ) -> Reference:
        """Lay the curve through the points, and pass the point of it nearest to each at its time.

        Corners are circular fillets that cut the waypoint by r (1/cos(turn/2) - 1); turns of more than
        120 degrees are bulbs through the waypoint (`corners.bulb`). Points repeated at one place are a wait:
        whole laps of a circle that begins and ends at the point, on the side that the path turns to there
        and otherwise to the right, at one airspeed in the wind (`loiters.fit_laps`). Where legs are short
        the radii shrink until a corner takes no more than half of each leg. Between waypoints the altitude
        runs linearly with distance, and the time at one airspeed through the wind (`timing`). Before the
        first waypoint comes a straight stretch on the course of the first leg, north if there is none.

        Args:
            points: in the order flown, two or more; plane positions, times rising.
            turn_radius_m: smallest of corners, true metres.
            loiter_radius_m: largest of loiter circles, which stay within twice that of their waypoint.
            lead_in_s: duration of the stretch before the first waypoint, at the first leg's ground speed.
            wind_at: for the times and for the radii of corners; still air if None.
            loiter_airspeed_mps: true airspeed on loiter circles.
            bank_max_rad: corners are so wide that 0.72 of its tangent is enough at the highest speed over
                ground in them, in the wind of their place and time; the rest is for gusts and lateness.
            circling_rad: where the first points are a wait under way, the course at the ends of its laps.

        Raises:
            PathError: if there are fewer than two points, times do not rise, a wait is shorter than half a
                lap, or the wind too strong to circle in.
        """
        style = Style(turn_radius_m, loiter_radius_m, lead_in_s, loiter_airspeed_mps, bank_max_rad, wind_at)
        segments = lay(points, style, circling_rad)
        waypoint_path_m = np.interp(
            [point.time_s for point in points],
            [segments[0].start_time_s, *(segment.end_time_s for segment in segments)],
            np.cumsum([0.0, *(segment.length_m for segment in segments)]),
        )
        return cls.of(segments, waypoint_path_m)

    @classmethod
    def of(cls, segments: Sequence[Segment], waypoint_path_m: Floats) -> Reference:
        """The curve of these segments in the order flown, each beginning where the one before it ends."""
        columns = [np.array(column) for column in zip(*segments, strict=True)]
        north, east, course, curvature, length, scale, phase, start_s, end_s, start_h, end_h = columns
        start_m = np.concatenate([[0.0], np.cumsum(length)[:-1]])
        return cls(
            north,
            east,
            course,
            curvature,
            length,
            start_m,
            start_s,
            end_s,
            start_h,
            end_h,
            scale,
            phase.astype(np.int64),
            waypoint_path_m,
        )

    @cached_property
    def end_m(self) -> float:
        """Length of the whole reference, plane metres: the largest `path_m`."""
        return float(self.start_m[-1] + self.length_m[-1])

    @property
    def duration_s(self) -> float:
        """From the beginning of the lead-in to the last waypoint."""
        return float(self.end_time_s[-1] - self.start_time_s[0])

    def at(self, path_m: float) -> ReferencePoint:
        """The reference at a distance along it; before its beginning and behind its end, as there.

        Where two segments meet, speed, climb, curvature and phase are those of the later one.
        """
        starts, rows = self._rows
        i = max(0, bisect_right(starts, path_m) - 1)
        (
            north_m,
            east_m,
            course_rad,
            curvature,
            length_m,
            time_s,
            time_slope,
            altitude_m,
            climb_slope,
            speed_mps,
            climb_mps,
            scale,
            phase,
        ) = rows[i]
        along_m = min(max(path_m - starts[i], 0.0), length_m)
        half_rad = 0.5 * curvature * along_m
        chord_m = along_m * math.sin(half_rad) / half_rad if abs(half_rad) > 1e-9 else along_m
        return ReferencePoint(
            north_m + chord_m * math.cos(course_rad + half_rad),
            east_m + chord_m * math.sin(course_rad + half_rad),
            altitude_m + climb_slope * along_m,
            time_s + time_slope * along_m,
            course_rad + 2.0 * half_rad,
            curvature * scale,
            speed_mps,
            climb_mps,
            scale,
            phase,
        )

    @cached_property
    def target(self) -> Callable[[float], Target]:
        """What `at` says of a distance, without the position: asked several times a round, so quick."""
        return Targets(*self._rows).at

    def at_many(self, path_m: Floats) -> ReferencePoints:
        """`at` for an array of distances."""
        i = np.maximum(np.searchsorted(self.start_m, path_m, side="right") - 1, 0)
        along_m = np.clip(path_m - self.start_m[i], 0.0, self.length_m[i])
        share = along_m / self.length_m[i]
        half_rad = 0.5 * self.curvature[i] * along_m
        chord_m = along_m * np.sinc(half_rad / np.pi)
        course_rad = self.course_rad[i] + half_rad
        taken_s = self.end_time_s[i] - self.start_time_s[i]
        climbed_m = self.end_altitude_m[i] - self.start_altitude_m[i]
        return ReferencePoints(
            self.north_m[i] + chord_m * np.cos(course_rad),
            self.east_m[i] + chord_m * np.sin(course_rad),
            self.start_altitude_m[i] + share * climbed_m,
            self.start_time_s[i] + share * taken_s,
            course_rad + half_rad,
            self.curvature[i] * self.scale[i],
            self.length_m[i] / self.scale[i] / taken_s,
            climbed_m / taken_s,
            self.scale[i],
            self.phase[i],
        )

    def path_at_time(self, time_s: float) -> float:
        """The distance along the reference at which it is at a time; its ends outside its times."""
        starts, rows = self._rows
        i = max(0, bisect_right(self._start_times, time_s) - 1)
        row = rows[i]
        along_m = (time_s - row.time_s) / row.time_slope
        return starts[i] + min(max(along_m, 0.0), row.length_m)

    def path_at_times(self, time_s: Floats) -> Floats:
        """`path_at_time` for an array of times."""
        times_s = np.append(self.start_time_s, self.end_time_s[-1])
        path_m: Floats = np.interp(time_s, times_s, np.append(self.start_m, self.end_m))
        return path_m

    @cached_property
    def project(self) -> Callable[[float, float, float], Projection]:
        """The nearest point of the reference not far along it from an expected one.

        Where the curve runs over itself (laps, reversals) the nearer of equals to `near_path_m` is taken.
        Called with `north_m` and `east_m`, the position in plane metres, and `near_path_m`, where along the
        reference it is expected, within `projection.WINDOW_M` true metres.
        """
        return self._projector.project

    def project_many(
        self, north_m: Floats, east_m: Floats, near_path_m: Floats, lead_m: float = 0.0
    ) -> tuple[Floats, Floats]:
        """`project` for the samples of one flight: (path_m, cross_track_m), arrays of shape (samples,).

        The samples are followed along the curve in the order flown: how far each is ahead of or behind
        `near_path_m` is looked for close to what it was just before. So a flight that is late by a kilometre,
        or by laps of a loiter, is still found where it is.

        Args:
            north_m: positions, plane metres, shape (samples,).
            east_m: positions, plane metres, shape (samples,).
            near_path_m: about where along the reference, such as `path_at_times` of the samples' times.
            lead_m: how far ahead of that the first sample is, within the window of `project`.
        """
        return self._projector.project_many(north_m, east_m, near_path_m, lead_m)

    @cached_property
    def _projector(self) -> Projector:
        return Projector(
            self.north_m,
            self.east_m,
            self.course_rad,
            self.curvature,
            self.length_m,
            self.start_m,
            self.scale,
        )

    @cached_property
    def _start_times(self) -> list[float]:
        times_s: list[float] = self.start_time_s.tolist()
        return times_s

    @cached_property
    def _rows(self) -> tuple[list[float], list[Row]]:
        """Where each segment starts, and the rest of it, as plain floats: numpy scalars are slow singly."""
        taken_s = self.end_time_s - self.start_time_s
        climbed_m = self.end_altitude_m - self.start_altitude_m
        columns = (
            self.north_m,
            self.east_m,
            self.course_rad,
            self.curvature,
            self.length_m,
            self.start_time_s,
            taken_s / self.length_m,
            self.start_altitude_m,
            climbed_m / self.length_m,
            self.length_m / self.scale / taken_s,
            climbed_m / taken_s,
            self.scale,
        )
        phases = map(Phase, self.phase.tolist())
        rows = [Row(*row) for row in zip(*(column.tolist() for column in columns), phases, strict=True)]
        return self.start_m.tolist(), rows
