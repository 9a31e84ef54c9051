"""Finding where along a curve of lines and arcs a position is."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from aircraft.path import Floats

Indices = NDArray[np.intp]

WINDOW_M = 200.0
"""How far along the curve from where it is expected the nearest point is looked for; true metres."""

_TIE = 1e-4  # square metres of distance that a square metre from the expected point weighs: settles near-ties
_ANCHOR_M = 50.0
_CHUNK = 16384  # samples at a time, so that the working arrays stay in the cache


_new_tuple = tuple.__new__  # makes a named tuple of a tuple in a third of the time of its constructor


class Projection(NamedTuple):
    """The point of the reference nearest to a position."""

    path_m: float
    cross_track_m: float  # true metres, right of the course positive


class Projector:
    """The segments of a curve, each about its middle.

    `middle`: distance along the curve; `origin`: an arc's centre or a line's middle; `tangent`: unit vector
    of the course half-way; `radius`: 1/curvature with its sign, zero for a line. Arrays are plane metres,
    shape (segments,).
    """

    def __init__(
        self,
        north_m: Floats,
        east_m: Floats,
        course_rad: Floats,
        curvature: Floats,
        length_m: Floats,
        start_m: Floats,
        scale: Floats,
    ) -> None:
        curved = curvature != 0.0
        half = length_m / 2.0
        radius = np.divide(1.0, curvature, where=curved, out=np.zeros_like(curvature))
        course = course_rad + curvature * half
        self._tangent = np.cos(course), np.sin(course)
        self._origin = (
            np.where(curved, north_m - radius * np.sin(course_rad), north_m + half * self._tangent[0]),
            np.where(curved, east_m + radius * np.cos(course_rad), east_m + half * self._tangent[1]),
        )
        self._radius, self._half, self._start, self._scale = radius, half, start_m, scale
        self._next_start = np.append(start_m[1:], np.inf)
        self._starts: list[float] = start_m.tolist()
        self._end_m = float(start_m[-1] + length_m[-1])
        columns = (*self._origin, *self._tangent, radius, half, start_m + half, scale)
        self._rows = list(zip(*(column.tolist() for column in columns), strict=True))

    def project(self, north_m: float, east_m: float, near_path_m: float) -> Projection:
        """See `Reference.project`."""
        starts, rows = self._starts, self._rows
        if near_path_m < 0.0:
            near_path_m = 0.0
        elif near_path_m > self._end_m:
            near_path_m = self._end_m
        i = bisect_right(starts, near_path_m) - 1
        window_m = WINDOW_M * rows[i][7]
        high_m = near_path_m + window_m
        low_m = near_path_m - window_m
        while i > 0 and starts[i] > low_m:
            i -= 1
        count = len(rows)
        best = math.inf
        path_m = cross_m = 0.0
        while i < count and starts[i] <= high_m:
            origin_n, origin_e, tangent_n, tangent_e, radius, half, middle, scale = rows[i]
            i += 1
            from_n, from_e = north_m - origin_n, east_m - origin_e
            forward = from_n * tangent_n + from_e * tangent_e
            right = from_e * tangent_n - from_n * tangent_e
            if radius == 0.0:  # no min and max: function calls are what takes the time here
                here = forward if -half < forward < half else half if forward > 0.0 else -half
                off = forward - here
                squared = off * off + right * right
            else:
                size = abs(radius)
                outward = -right if radius > 0.0 else right
                here = min(max(math.atan2(forward, outward) * size, -half), half)
                sine, cosine = math.sin(here / size), math.cos(here / size)
                off = forward * cosine - outward * sine
                beyond = outward * cosine + forward * sine - size
                squared = off * off + beyond * beyond
                right = -beyond if radius > 0.0 else beyond
            away = middle + here - near_path_m
            squared += _TIE * away * away
            if squared < best:
                best = squared
                path_m = middle + here
                cross_m = right / scale
        return _new_tuple(Projection, (path_m, cross_m))

    def project_many(
        self, north_m: Floats, east_m: Floats, near_path_m: Floats, lead_m: float
    ) -> tuple[Floats, Floats]:
        """See `Reference.project_many`."""
        path_m, cross_m = np.empty(len(near_path_m)), np.empty(len(near_path_m))
        near_path_m = self._followed_m(north_m, east_m, near_path_m, lead_m)
        for begin in range(0, len(near_path_m), _CHUNK):
            part = slice(begin, begin + _CHUNK)
            path_m[part], cross_m[part] = self._nearest(north_m[part], east_m[part], near_path_m[part])
        return path_m, cross_m

    def _followed_m(self, north_m: Floats, east_m: Floats, near_path_m: Floats, lead_m: float) -> Floats:
        """Where the samples are, to some metres: the lead on `near_path_m` followed from anchor to anchor."""
        if len(near_path_m) == 0:
            return near_path_m
        steps_m = np.hypot(np.diff(north_m, prepend=north_m[0]), np.diff(east_m, prepend=east_m[0]))
        flown_m = np.cumsum(steps_m)  # a flight that is late flies on when its schedule has come to the end
        marks = [np.floor(way_m / _ANCHOR_M) for way_m in (near_path_m, flown_m)]
        anchors = np.flatnonzero(np.any([np.diff(mark, prepend=-np.inf) for mark in marks], axis=0))
        leads_m = []
        for north, east, near in zip(
            north_m[anchors].tolist(), east_m[anchors].tolist(), near_path_m[anchors].tolist(), strict=True
        ):
            lead_m = self.project(north, east, near + lead_m).path_m - near
            leads_m.append(lead_m)
        followed_m: Floats = near_path_m + np.interp(np.arange(len(near_path_m)), anchors, leads_m)
        return followed_m

    def _nearest(self, north_m: Floats, east_m: Floats, near_path_m: Floats) -> tuple[Floats, Floats]:
        """`project` for arrays: each sample's own segment, then those before and behind it in its window."""
        first = np.maximum(np.searchsorted(self._start, near_path_m, side="right") - 1, 0)
        low_m = near_path_m - WINDOW_M * self._scale[first]
        high_m = near_path_m + WINDOW_M * self._scale[first]
        best = np.full(near_path_m.shape, np.inf)
        path_m, cross_m = np.empty_like(best), np.empty_like(best)

        def compare(which: Indices, segment: Indices) -> None:
            on_path_m, right_m, squared = self._on_segment(north_m[which], east_m[which], segment)
            squared += _TIE * (on_path_m - near_path_m[which]) ** 2
            better = squared < best[which]
            chosen = which[better]
            best[chosen] = squared[better]
            path_m[chosen] = on_path_m[better]
            cross_m[chosen] = right_m[better]

        which, segment = np.arange(len(best)), first
        while len(which):
            compare(which, segment)
            more = (segment > 0) & (self._start[segment] > low_m[which])
            which, segment = which[more], segment[more] - 1
        which, segment = np.arange(len(best)), first + 1
        while True:
            more = self._next_start[segment - 1] <= high_m[which]
            which, segment = which[more], segment[more]
            if not len(which):
                return path_m, cross_m
            compare(which, segment)
            segment = segment + 1

    def _on_segment(self, north_m: Floats, east_m: Floats, i: Indices) -> tuple[Floats, Floats, Floats]:
        """The nearest point of one segment for each position: path_m, cross-track and squared distance."""
        tangent_n, tangent_e = self._tangent[0][i], self._tangent[1][i]
        from_n, from_e = north_m - self._origin[0][i], east_m - self._origin[1][i]
        forward = from_n * tangent_n + from_e * tangent_e
        right = from_e * tangent_n - from_n * tangent_e
        radius, half = self._radius[i], self._half[i]
        here = np.clip(forward, -half, half)
        off = forward - here
        curved = np.flatnonzero(radius)
        if len(curved):
            side, size = np.sign(radius[curved]), np.abs(radius[curved])
            outward = -right[curved] * side
            ahead = forward[curved]
            arc = np.clip(np.arctan2(ahead, outward) * size, -half[curved], half[curved])
            sine, cosine = np.sin(arc / size), np.cos(arc / size)
            here[curved] = arc
            off[curved] = ahead * cosine - outward * sine
            right[curved] = -side * (outward * cosine + ahead * sine - size)
        return self._start[i] + half + here, right / self._scale[i], off * off + right * right
