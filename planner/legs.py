"""Straight legs in any direction: when they have been flown, and whether they keep clear of hazard.

A leg is cut where it crosses the lines through the cell centres, so that each piece lies in one square
between four of them. Wind is bilinear there, so anywhere on the piece it is a blend of the four winds; speed
is a convex function of wind, so it is no higher than the highest of the four: a piece is below the threshold
if the four cells are safe in every stage from its entry to its exit. So is the corridor around it: beyond
the square's side wind is a blend of the winds beyond its two ends, and those lie in the rooms that
`hazards.hazard_stages` has kept below the threshold around the cells. (On a leg along a row or a column only
the cells on it have weight.)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.air import Air, Chart
from planner.intervals import MARGIN, SafeIntervals
from planner.levels import Climbing
from planner.windfield import Floats
from planner.windtriangle import ground_speed

Ints = NDArray[np.intp]

_ENOUGH_S = 1e-3  # times that agree to this between two rounds are final
_ROUNDS_MAX = 30
_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Country:
    """All that legs are flown through: chart, air, safe intervals and the length of a stage.

    `climbing`: how fast levels are changed, where there are several.
    `begin_s`: when ways begin, since departure.
    """

    chart: Chart
    air: Air
    intervals: SafeIntervals
    stage_s: float
    begin_s: float = 0.0
    climbing: Climbing | None = None


@dataclass(frozen=True, eq=False)
class Legs:
    """Legs from one cell to several, cut into pieces; the last pieces of short ones have no length.

    Every second cut, beginning with the second, is in the middle between its neighbours: it serves the
    integration. `share`: of the plane length at which the pieces meet, shape [leg, cut]. `row`, `column`:
    fractional, of the cuts, [leg, cut], the row that of the grid. `true_m`: true metres for each unit of
    share, [leg, cut]. `course`: cos + i sin, [leg]. `ends_m`: altitude at either end, [leg, 2], between which
    it is even in share; `level`: fractional, of the cuts, [leg, cut]; None where there is one level alone.
    """

    share: Floats
    row: Floats
    column: Floats
    true_m: Floats
    course: NDArray[np.complex128]
    ends_m: Floats | None = None
    level: Floats | None = None

    @property
    def length_m(self) -> Floats:
        """True length of each piece, [leg, piece]."""
        return 0.5 * (self.true_m[:, 1:] + self.true_m[:, :-1]) * np.diff(self.share)


def lay_legs(chart: Chart, start: tuple[int, int], rows: Ints, columns: Ints) -> Legs:
    """Lay legs from the centre of a cell to those of others, shape (legs,), each another than the first.

    Where there are several levels, rows are those of the tall sheet.
    """
    levels = chart.levels
    level, (row, column) = levels.split(start)
    of_ends, rows = np.divmod(rows, levels.band)
    up, right = rows - row, columns - column
    crossings = np.sort(
        np.concatenate(
            [
                np.broadcast_to([0.0, 1.0], (rows.size, 2)),
                _shares(chart.north_m, row, rows),
                _shares(chart.east_m, column, columns),
            ],
            axis=1,
        ),
        axis=1,
    )
    share = np.empty((rows.size, 2 * crossings.shape[1] - 1))
    share[:, ::2] = crossings
    share[:, 1::2] = 0.5 * (crossings[:, 1:] + crossings[:, :-1])
    vector = chart.north_m[rows] - chart.north_m[row] + 1j * (chart.east_m[columns] - chart.east_m[column])
    north_m = chart.north_m[row] + share * vector.real[:, np.newaxis]
    row_at = np.interp(north_m, chart.north_m, np.arange(chart.north_m.size))
    row_at[up == 0] = row  # exactly on the line, in spite of rounding
    column_at = np.where(right[:, np.newaxis] == 0, column, column + share * right[:, np.newaxis])
    scale = np.interp(row_at, np.arange(chart.scale.size), chart.scale)
    plane_m = np.abs(vector)
    laid = Legs(share, row_at, column_at, plane_m[:, np.newaxis] / scale, vector / plane_m)
    if levels.count == 1:
        return laid
    ends_m = levels.height_m[np.stack([np.full_like(of_ends, level), of_ends], axis=1)]
    altitude_m = ends_m[:, :1] + share * np.diff(ends_m)
    level_at = np.interp(altitude_m, levels.height_m, np.arange(levels.count))
    level_at[:, 0], level_at[:, -1] = level, of_ends  # exactly, in spite of rounding
    return replace(laid, ends_m=ends_m, level=level_at)


def _shares(line_m: Floats, first: int, last: Ints) -> Floats:
    """Where each leg crosses the lines between its ends: shares [leg, crossing], filled up with 1."""
    apart = last - first
    steps = np.arange(1, int(np.abs(apart).max(initial=1)))
    crossed = np.where(
        steps < np.abs(apart)[:, np.newaxis], first + np.sign(apart)[:, np.newaxis] * steps, -1
    )
    whole_m = np.where(apart == 0, 1.0, line_m[last] - line_m[first])
    return np.where(crossed < 0, 1.0, (line_m[crossed] - line_m[first]) / whole_m[:, np.newaxis])


def fly(country: Country, legs: Legs, depart_s: float, airspeed_mps: float | Floats) -> Floats:
    """When the cuts of legs are passed at a true airspeed [s since departure], shape [leg, cut].

    One airspeed serves all legs, or an array of shape [leg, 1] each its own. In a change of level, what is
    left of it beside the greatest climb counts.

    Time is the integral of length over ground speed (by Simpson's rule); the wind in it is that at the time
    of passage, found by repeated substitution (the wind changes little in the seconds by which a round is
    off). Infinite where the wind does not let the aircraft go on, or the rounds do not end.
    """
    if legs.ends_m is not None and country.climbing is not None:
        rate_mps = country.climbing.rate_mps(*legs.ends_m.T)[:, np.newaxis]
        airspeed_mps = np.sqrt(np.square(airspeed_mps) - np.square(rate_mps))
    time_s = depart_s + legs.share * legs.true_m / airspeed_mps
    apart = (legs.share[:, 2::2] - legs.share[:, :-2:2]) / 24.0
    real = apart > 0.0
    took_s = np.empty((len(time_s), time_s.shape[1] - 1))
    course = legs.course.conj()[:, np.newaxis]
    blend = _Blend(country.air, country.chart, legs)
    for _ in range(_ROUNDS_MAX):
        wind = blend.wind(time_s) * course
        with np.errstate(invalid="ignore", divide="ignore"):
            speed_mps = ground_speed(wind.real, wind.imag, airspeed_mps)
            pace = np.where(speed_mps > 0.0, legs.true_m / speed_mps, np.nan)
            first, middle, last = pace[:, :-2:2], pace[:, 1::2], pace[:, 2::2]
            took_s[:, ::2] = np.where(real, apart * (5.0 * first + 8.0 * middle - last), 0.0)
            took_s[:, 1::2] = np.where(real, apart * (5.0 * last + 8.0 * middle - first), 0.0)
        np.maximum(took_s, 0.0, out=took_s)  # where wind is so rough that the rule fails, it is hazard anyway
        took_s[np.isnan(took_s)] = np.inf
        before_s, time_s = time_s, time_s.copy()
        time_s[:, 1:] = depart_s + np.cumsum(took_s, axis=1)
        known = np.isfinite(time_s)
        settled = np.where(known, np.abs(np.where(known, time_s, 0.0) - before_s), 0.0) < _ENOUGH_S
        if settled.all():
            break
    time_s[~settled] = np.inf
    return time_s


class _Blend:
    """The wind at fixed places as a function of time."""

    def __init__(self, air: Air, chart: Chart, legs: Legs) -> None:
        row, column = legs.row, legs.column
        rows, columns = chart.levels.rows, air.wind_mps.shape[2]
        low_row = np.minimum(row.astype(np.intp), max(rows - 2, 0))
        low_column = np.minimum(column.astype(np.intp), max(columns - 2, 0))
        up, right = row - low_row, column - low_column
        corner = low_row * columns + low_column
        north, east = (columns if rows > 1 else 0), (1 if columns > 1 else 0)
        both = up * right
        self.corners = [
            (corner, 1.0 - up - right + both),
            (corner + east, right - both),
            (corner + north, up - both),
            (corner + north + east, both),
        ]
        if legs.level is not None:
            self.corners = _at_levels(self.corners, legs.level, chart.levels.band * columns)
        self.time_s = air.time_s
        self.sheets = air.wind_mps.reshape(-1)
        self.size = air.wind_mps.shape[1] * columns
        self.first = np.full(row.shape, -1, dtype=np.intp)
        self.wind_mps, self.change_mps = np.zeros((2, *row.shape), dtype=np.complex128)

    def wind(self, time_s: Floats) -> NDArray[np.complex128]:
        """North + i east at a time for each place; before the first and behind the last time, as there."""
        place = np.interp(time_s, self.time_s, np.arange(self.time_s.size))
        first = np.minimum(place.astype(np.intp), self.time_s.size - 2)
        moved = np.nonzero(first != self.first)
        if moved[0].size:
            self._read(moved, first[moved])
        wind_mps: NDArray[np.complex128] = self.wind_mps + (place - first) * self.change_mps
        return wind_mps

    def _read(self, where: tuple[NDArray[np.intp], ...], first: Ints) -> None:
        """Take over the wind of the span of time that some places have come into."""
        low, high = np.zeros((2, first.size), dtype=np.complex128)
        for corner, weight in self.corners:
            at, share = first * self.size + corner[where], weight[where]
            low += share * self.sheets[at]
            high += share * self.sheets[at + self.size]
        self.first[where] = first
        self.wind_mps[where] = low
        self.change_mps[where] = high - low


def _at_levels(corners: list[tuple[Ints, Floats]], level: Floats, sheet: int) -> list[tuple[Ints, Floats]]:
    """The corners at the levels around each place, so many places apart; with their weights."""
    low = np.floor(level).astype(np.intp)
    up = level - low
    around = [(low, 1.0 - up)]
    if up.any():
        around.append((np.where(up > 0.0, low + 1, low), up))
    return [(corner + at * sheet, weight * share) for at, share in around for corner, weight in corners]


def are_safe(country: Country, legs: Legs, time_s: Floats) -> NDArray[np.bool_]:
    """Whether legs flown at such times keep clear of hazard, shape (legs,).

    A change of level has to at all levels that it touches, all along; and to be nowhere faster than it may.
    """
    intervals = country.intervals
    stages = len(intervals.run)
    known = np.isfinite(time_s)
    stage = np.where(known, np.floor(np.where(known, time_s, 0.0) / country.stage_s), stages).astype(np.intp)
    entered, left = np.minimum(stage[:, :-1], stages - 1), stage[:, 1:]
    middle_row, middle_column = (0.5 * (cuts[:, 1:] + cuts[:, :-1]) for cuts in (legs.row, legs.column))
    low_row, low_column = np.floor(middle_row).astype(np.intp), np.floor(middle_column).astype(np.intp)
    high_row, high_column = np.ceil(middle_row).astype(np.intp), np.ceil(middle_column).astype(np.intp)
    clear = np.ones(entered.shape, dtype=np.bool_)
    corners = (
        (low_row, low_column),
        (low_row, high_column),
        (high_row, low_column),
        (high_row, high_column),
    )
    for first_row in _first_rows(country.chart, legs):
        for row, column in corners:
            place = (row + first_row + MARGIN) * intervals.width + column + MARGIN
            clear &= intervals.run_end[entered, place] > left
    safe = (clear | (np.diff(legs.share) <= 0.0)).all(axis=1)
    if legs.ends_m is not None and country.climbing is not None:
        least_s = country.climbing.least_s(*legs.ends_m.T)[:, np.newaxis] * np.diff(legs.share)
        safe &= (np.diff(time_s) >= least_s * (1.0 - _ROUNDING)).all(axis=1)
    return np.asarray(safe)


def _first_rows(chart: Chart, legs: Legs) -> Iterator[Ints | int]:
    """Where the sheets begin of all levels that legs touch, one level of each leg after the other."""
    if legs.level is None:
        yield 0
        return
    low, high = legs.level.min(axis=1).astype(np.intp), np.ceil(legs.level.max(axis=1)).astype(np.intp)
    for above in range(int((high - low).max(initial=0)) + 1):
        yield (np.minimum(low + above, high) * chart.levels.band)[:, np.newaxis]
