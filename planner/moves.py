"""The moves of the wind-aware search: where they lead, what they sweep, how long and on which course."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.air import Chart
from planner.errors import PlannerError
from planner.intervals import Offset
from planner.levels import Levels
from planner.windfield import Floats

_AXIS = ((1, 0), (0, 1), (-1, 0), (0, -1))
_DIAGONAL = ((1, 1), (1, -1), (-1, -1), (-1, 1))
_NO_SUCH_MOVE_M = 1e6  # on a grid too small for a move it has this length, so that it is not the shortest
_KNIGHT = ((1, 2), (2, 1), (2, -1), (1, -2), (-1, -2), (-2, -1), (-2, 1), (-1, 2))


class Change(NamedTuple):
    """A move that changes level.

    `move`: its number; `along`: of the move that keeps the level on its course; `shortest`: of the one from
    the same level to the same on that course that covers the fewest cells. `here`, `there`: the levels;
    `cells`: how many it covers. `least_s`: how long it has to take; 0 where it is so long that it cannot take
    less. `rate_mps`: up or down, at most.
    """

    move: int
    along: int
    shortest: int
    here: int
    there: int
    cells: int
    least_s: float
    rate_mps: float


@dataclass(frozen=True, eq=False)
class Moves:
    """All moves, and their geometry from each row; they are straight on the Mercator plane.

    `offsets`: (rows, columns) of each. `swept`: offsets of the cells around the squares between cell centres
    that the move passes: the wind on it is a blend of theirs, so it is safe if they are. `length_m`: true
    length [move, row]. `course`: cos + i sin of the course, complex64 [move, row]. Moves off the grid repeat
    the outermost row's geometry. `changes`: of level (see `planner.climbs`), the last of the moves, which are
    not among `swept`; `levels`: where there are such.
    """

    offsets: tuple[Offset, ...]
    swept: tuple[tuple[Offset, ...], ...]
    length_m: Floats
    course: NDArray[np.complex64]
    changes: tuple[Change, ...] = ()
    levels: Levels | None = None

    @classmethod
    def on(cls, chart: Chart, neighbours: int = 8) -> Moves:
        """The moves to 4, 8 or 16 neighbours.

        Raises:
            PlannerError: for another number.
        """
        kinds = {4: _AXIS, 8: _AXIS + _DIAGONAL, 16: _AXIS + _DIAGONAL + _KNIGHT}
        if neighbours not in kinds:
            raise PlannerError(f"moves lead to 4, 8 or 16 neighbours, not {neighbours}")
        offsets = kinds[neighbours]
        vectors = np.array([plane_vectors(chart, *offset) for offset in offsets])
        scale = np.array([mean_scale(chart, rows) for rows, _ in offsets])
        return cls(
            offsets=offsets,
            swept=tuple(_swept(*offset) for offset in offsets),
            length_m=np.abs(vectors) / scale,
            course=(vectors / np.abs(vectors)).astype(np.complex64),
        )


def plane_vectors(chart: Chart, rows: int, columns: int) -> NDArray[np.complex128]:
    """Plane vectors north + i east of a move from each row."""
    last = chart.north_m.size - 1
    if last < abs(rows) or chart.east_m.size - 1 < abs(columns):
        return np.full(last + 1, _NO_SUCH_MOVE_M * complex(rows, columns))
    start = np.clip(np.arange(last + 1), max(0, -rows), last - max(0, rows))
    east_m = np.sign(columns) * (chart.east_m[abs(columns)] - chart.east_m[0])
    return np.asarray(chart.north_m[start + rows] - chart.north_m[start] + 1j * east_m)


def mean_scale(chart: Chart, rows: int) -> Floats:
    """Plane metres per true metre on a move from each row: the mean of its ends."""
    last = chart.scale.size - 1
    start = np.clip(np.arange(last + 1), min(max(0, -rows), last), max(last - max(0, rows), 0))
    return 0.5 * (chart.scale[start] + chart.scale[np.clip(start + rows, 0, last)])


def _swept(rows: int, columns: int) -> tuple[Offset, ...]:
    """The corners of every square passed; of an axis move, which runs between two squares, its two ends."""
    return tuple(
        (row, column)
        for row in range(min(0, rows), max(0, rows) + 1)
        for column in range(min(0, columns), max(0, columns) + 1)
    )
