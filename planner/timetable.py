"""Legs as a plan shows them: waypoints in time, and their figures."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from planner.earliest import Cell
from planner.grid import Grid
from planner.hazards import StageClock
from planner.legs import Country, Legs, fly, lay_legs
from planner.plans import Waypoint
from planner.way import Leg
from planner.windfield import Floats

SPACING_S = 120.0
"""About this far apart in time are the waypoints on a leg, less where the ground speed changes much."""

_SPACING_MIN_S = 30.0
_OFF_MPS = 0.5  # what the ground speed on a leg may differ from its mean between two waypoints


def waypoints(
    country: Country, grid: Grid, clock: StageClock, start: Cell, legs: Sequence[Leg], altitude_m: float
) -> tuple[Waypoint, ...]:
    """The ends of legs and points between them, at the times of the flight at each leg's airspeed.

    A wait is two waypoints at one place. Points within a leg lie on its straight line on the Mercator plane.
    All are at the altitude given, unless there are several levels.
    """
    chart = country.chart
    row, column = chart.levels.split(start)[1]
    north_m, east_m, time_s = [chart.north_m[row]], [chart.east_m[column]], [country.begin_s]
    height_m = [altitude_m]
    for leg in legs:
        if leg.leave_s > time_s[-1]:
            north_m.append(north_m[-1])
            east_m.append(east_m[-1])
            height_m.append(height_m[-1])
            time_s.append(leg.leave_s)
        laid, cut_s = _timed(country, leg)
        at_s = _times(laid, cut_s)
        share = np.interp(at_s, cut_s, laid.share[0])
        share[-1] = 1.0
        from_m, to_m = (altitude_m, altitude_m) if laid.ends_m is None else laid.ends_m[0].tolist()
        height_m.extend((from_m + share * (to_m - from_m)).tolist())
        for line_m, (first, last), out in (
            (chart.north_m, (leg.start[0] % chart.levels.band, leg.end[0] % chart.levels.band), north_m),
            (chart.east_m, (leg.start[1], leg.end[1]), east_m),
        ):
            out.extend((line_m[first] + share * (line_m[last] - line_m[first])).tolist())
        time_s.extend(at_s.tolist())
    lat_rad, lon_rad = grid.frame.to_geodetic(np.array(north_m), np.array(east_m))
    lon_rad = grid.unwrapped(lon_rad)
    return tuple(
        Waypoint(math.degrees(lat), math.degrees(lon), height, time, clock.stage_at(time))
        for lat, lon, height, time in zip(lat_rad.tolist(), lon_rad.tolist(), height_m, time_s, strict=True)
    )


def _times(laid: Legs, cut_s: Floats) -> Floats:
    """Times of a leg's waypoints but the first, even: so many that one ground speed does between two."""
    took_s = float(cut_s[-1] - cut_s[0])
    count = max(round(took_s / SPACING_S), 1)
    real = np.diff(cut_s) > 0.0
    piece_mps = laid.length_m[0][real] / np.diff(cut_s)[real]
    middle_s = 0.5 * (cut_s[1:] + cut_s[:-1])[real]
    along_m = np.concatenate([[0.0], np.cumsum(laid.length_m[0])])
    while True:
        at_s = np.linspace(cut_s[0], cut_s[-1], count + 1)
        mean_mps = np.diff(np.interp(at_s, cut_s, along_m)) / np.diff(at_s)
        off_mps = piece_mps - mean_mps[np.searchsorted(at_s, middle_s, side="right") - 1]
        if np.abs(off_mps).max() < _OFF_MPS or took_s < 2.0 * count * _SPACING_MIN_S:
            return at_s[1:]
        count *= 2


def length_m(country: Country, legs: Sequence[Leg]) -> float:
    """True length of legs, loiters not counted [m]: plane lengths over the mean of the scale along them."""
    if not legs:
        return 0.0
    chart = country.chart
    (first_row, first_column), (last_row, last_column) = (
        np.array(ends).T for ends in ([leg.start for leg in legs], [leg.end for leg in legs])
    )
    first_row, last_row = first_row % chart.levels.band, last_row % chart.levels.band
    first_m, last_m = chart.north_m[first_row], chart.north_m[last_row]
    plane_m = np.hypot(last_m - first_m, chart.east_m[last_column] - chart.east_m[first_column])
    middle = np.interp(0.5 * (first_m + last_m), chart.north_m, chart.scale)
    per_plane_m = (1.0 / chart.scale[first_row] + 4.0 / middle + 1.0 / chart.scale[last_row]) / 6.0
    return float((plane_m * per_plane_m).sum())


def waiting_s(legs: Sequence[Leg], begin_s: float = 0.0) -> float:
    """Time spent between legs, and before the first."""
    return legs[-1].arrive_s - begin_s - sum(leg.arrive_s - leg.leave_s for leg in legs) if legs else 0.0


def cells_passed(country: Country, legs: Sequence[Leg]) -> list[tuple[float, Cell]]:
    """Times and nearest cells of every place where legs cross a line between cell centres, and their ends.

    Of a change of level, the cells at all levels that it touches.
    """
    band = country.chart.levels.band
    passed = []
    for leg in legs:
        passed.append((leg.leave_s, leg.start))
        if max(abs(leg.end[0] - leg.start[0]), abs(leg.end[1] - leg.start[1])) == 1:
            passed.append((leg.arrive_s, leg.end))
            continue
        laid, cut_s = _timed(country, leg)
        cells = np.rint(np.stack([laid.row[0], laid.column[0]])).astype(int).T.tolist()
        touched = sorted((leg.start[0] // band, leg.end[0] // band))
        passed.extend(
            (time_s, (level * band + row, column))
            for time_s, (row, column) in zip(cut_s.tolist(), cells, strict=True)
            for level in range(touched[0], touched[1] + 1)
        )
    return passed


def _timed(country: Country, leg: Leg) -> tuple[Legs, Floats]:
    """A leg laid, and when its cuts are passed, shape (cuts,)."""
    laid = lay_legs(country.chart, leg.start, *(np.array([index]) for index in leg.end))
    return laid, fly(country, laid, leg.leave_s, leg.airspeed_mps)[0]
