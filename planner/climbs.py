"""Changes of level as moves of the wind-aware search: straight climbs and descents over some cells.

A change takes its time (see `levels.Climbing`), and the aircraft goes on meanwhile: the farther, the faster
it is over ground. So from each place there are moves of several lengths; the longest serves whatever the wind
is, a shorter one in those stages in which no wind beside it makes it too fast, and then instead of it. A move
is open while all cells beside its line are safe at both levels and at the heights of the weather between
them: wind is linear in height from one of those to the next, so whatever is met on the way is a blend of
theirs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import permutations
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from planner.air import Air, Chart
from planner.intervals import MARGIN, Offset, SafeIntervals
from planner.levels import Climbing, Levels
from planner.moves import Change, Moves, mean_scale, plane_vectors

Number = TypeVar("Number", bound=np.generic)

_WINDS = (-1.0, 0.0, 1.0)  # along the moves, of the strongest: what moves of several lengths are for
_ROUNDING_MPS = 0.1  # courses bend a little on the way


def at_every_level(moves: Moves, levels: Levels) -> Moves:
    """The moves of one level at each of them, none between."""
    if levels.count == 1:
        return moves
    return Moves(
        moves.offsets,
        moves.swept,
        _tall(moves.length_m, levels),
        _tall(moves.course, levels),
    )


def with_climbs(
    moves: Moves, chart: Chart, climbing: Climbing, airspeed_mps: float, strongest_mps: float
) -> Moves:
    """The moves of one level at each of them, and those from every flown level to every other.

    Args:
        moves: of one level, whose courses changes of level take, too.
        chart: with the levels.
        climbing: how fast levels are changed.
        airspeed_mps: true airspeed, at most.
        strongest_mps: of the wind where it is no hazard.
    """
    levels = chart.levels
    same = at_every_level(moves, levels)
    offsets, lengths, courses = list(same.offsets), [same.length_m], [same.course]
    changes = []
    for here, there in permutations(np.flatnonzero(levels.flown).tolist(), 2):  # also past those between
        from_m, to_m = levels.height_m[[here, there]].tolist()
        least_s, rate_mps = float(climbing.least_s(from_m, to_m)), float(climbing.rate_mps(from_m, to_m))
        for along, (north, east) in enumerate(moves.offsets):
            if max(abs(north), abs(east)) > 1:
                continue
            cell_m = float(moves.length_m[along].min())
            counts = {
                max(math.ceil(least_s * (airspeed_mps + share * strongest_mps) / cell_m), 1)
                for share in _WINDS
            }
            shortest = len(offsets)
            for cells in sorted(counts):
                needed_s = 0.0 if cells == max(counts) else least_s
                change = Change(len(offsets), along, shortest, here, there, cells, needed_s, rate_mps)
                vectors = plane_vectors(chart, cells * north, cells * east)[np.newaxis]
                changes.append(change)
                offsets.append((cells * north + (there - here) * levels.band, cells * east))
                lengths.append(_tall(np.abs(vectors) / mean_scale(chart, cells * north), levels))
                courses.append(_tall((vectors / np.abs(vectors)).astype(np.complex64), levels))
    return Moves(
        tuple(offsets),
        same.swept,
        np.concatenate(lengths),
        np.concatenate(courses),
        tuple(changes),
        levels,
    )


def note_joint_end(
    joint: NDArray[np.int16],
    intervals: SafeIntervals,
    stage: int,
    moves: Moves,
    air: Air,
    span_s: tuple[float, float],
    airspeed_mps: float,
) -> None:
    """`SafeIntervals.joint_end` of the changes of level.

    Closed are also those that a tail wind would make faster than the aircraft climbs, and those of which a
    shorter one is open.

    Args:
        joint: where to note it, [change, place]; zero, or as noted for another stage.
        intervals: of the tall sheet.
        stage: the stage.
        moves: with the changes.
        air: which is flown through.
        span_s: from the stage's beginning to its end.
        airspeed_mps: true airspeed.
    """
    levels = moves.levels
    assert levels is not None
    ends = intervals.run_end[stage].reshape(-1, intervals.width)[MARGIN:-MARGIN, MARGIN:-MARGIN]
    framed = joint.reshape(len(joint), -1, intervals.width)[:, MARGIN:-MARGIN, MARGIN:-MARGIN]
    tails = _Tails(air, moves, span_s)
    until: dict[tuple[int, int, int, int], NDArray[np.int16]] = {}  # a climb's are those of the descent
    served = np.zeros(ends.shape, dtype=np.bool_)
    for number, change in enumerate(moves.changes):
        line = _Line(*moves.offsets[change.along], change.cells, (levels.rows, ends.shape[1]))
        rows, columns = line.places
        if rows.start >= rows.stop or columns.start >= columns.stop:
            continue
        low, high = sorted((change.here, change.there))
        key = low, high, change.along, change.cells
        if key not in until:
            until[key] = line.along(np.minimum, _through(np.minimum, levels, ends, low, high))
        first = change.here * levels.band
        place = slice(first + rows.start, first + rows.stop), columns
        here = framed[number][place]
        here[...] = until[key]
        if change.least_s:
            tail_mps = line.along(np.maximum, _through(np.maximum, levels, tails.of(change), low, high))
            fastest_mps = airspeed_mps + tail_mps + _ROUNDING_MPS
            here[fastest_mps * change.least_s > moves.length_m[change.move, place[0], np.newaxis]] = 0
        if change.move == change.shortest:
            served[place] = here > 0
        else:
            here[served[place]] = 0
            served[place] |= here > 0


class _Tails:
    """The strongest wind along a course in every cell of the tall sheet, while a stage's changes are made."""

    def __init__(self, air: Air, moves: Moves, span_s: tuple[float, float]) -> None:
        self._air, self._moves, self._span_s = air, moves, span_s
        self._known: dict[tuple[int, float], NDArray[np.float32]] = {}

    def of(self, change: Change) -> NDArray[np.float32]:
        """Of one change: whoever leaves last is on the way for the least that it takes, or need not mind."""
        key = change.along, change.least_s
        if key not in self._known:
            begin_s, end_s = self._span_s
            course = self._moves.course[change.along].conj()[:, np.newaxis]
            sheets = _sheets(self._air, begin_s, end_s + change.least_s)
            self._known[key] = np.max([(sheet * course).real for sheet in sheets], axis=0)
        return self._known[key]


@dataclass(frozen=True)
class _Line:
    """A straight line over so many cells, a number of steps north and east, on sheets of a shape.

    Rows lie a little closer together toward a pole, so that a long diagonal leaves the corners of its squares
    by as little: the cells beside those count, too.
    """

    north: int
    east: int
    cells: int
    shape: tuple[int, int]

    @property
    def places(self) -> tuple[slice, slice]:
        """The rows and columns that it can begin at."""
        reach = self.cells * self.north, self.cells * self.east
        rows, columns = (
            slice(max(0, -far), size - max(0, far)) for far, size in zip(reach, self.shape, strict=True)
        )
        return rows, columns

    @property
    def beside(self) -> list[Offset]:
        """The cells beside it, as offsets from its beginning."""
        diagonal = self.north != 0 and self.east != 0
        wide = 0 if not diagonal else 1 if self.cells == 1 else 2
        return [
            (at * self.north, (at + off) * self.east)
            for at in range(self.cells + 1)
            for off in range(-wide, wide + 1)
            if 0 <= at + off <= self.cells
        ]

    def along(self, fold: np.ufunc, sheet: NDArray[Number]) -> NDArray[Number]:
        """A sheet's values beside it folded, for every place that it can begin at."""
        rows, columns = self.places
        folded: NDArray[Number] = sheet[rows, columns].copy()
        for north, east in self.beside:
            up, right = slice(rows.start + north, rows.stop + north), columns.start + east
            fold(folded, sheet[up, right : columns.stop + east], out=folded)
        return folded


def _through(fold: np.ufunc, levels: Levels, tall: NDArray[Number], low: int, high: int) -> NDArray[Number]:
    """The values of each cell folded over the levels from one to another."""
    folded: NDArray[Number] = fold.reduce(levels.parts(tall)[low : high + 1])
    return folded


def _sheets(air: Air, begin_s: float, end_s: float) -> NDArray[np.complex64]:
    """The wind at the times of the air from one before a span to one after it."""
    first = max(int(np.searchsorted(air.time_s, begin_s, side="right")) - 1, 0)
    return air.wind_mps[first : int(np.searchsorted(air.time_s, end_s)) + 1]


def _tall(of_rows: NDArray[Number], levels: Levels) -> NDArray[Number]:
    """Values [move, row] at every level, [move, row of the tall sheet]."""
    banded = np.pad(of_rows, ((0, 0), (0, MARGIN)), mode="edge")
    return np.tile(banded, (1, levels.count))[:, :-MARGIN]
