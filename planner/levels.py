"""Levels: the altitudes that a plan may choose among, one above the other in one tall sheet.

The sheets [north, east] of all levels lie in one sheet [row, east], the lowest first, with `MARGIN` rows
that nobody may enter between them. A cell of it says level and place at once, and whatever knows cells and
moves (safe intervals, sweeps, labels) knows levels too; a change of level is a move like any other, to a row
that lies farther off. With one level the tall sheet is the sheet itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.errors import PlannerError
from planner.hazards import Bools
from planner.intervals import MARGIN
from planner.windfield import Floats

Cell = tuple[int, int]
Sheets = TypeVar("Sheets", bound=np.generic)

_SAME_M = 1e-6


@dataclass(frozen=True, slots=True)
class Climbing:
    """How fast levels are changed, both positive [m/s]: what a plan asks of the aircraft at most."""

    up_mps: float
    down_mps: float

    def __post_init__(self) -> None:
        if not (self.up_mps > 0.0 and self.down_mps > 0.0):
            raise PlannerError(
                f"levels are changed at {self.up_mps} m/s up and {self.down_mps} m/s down; "
                "both have to be above 0, or leave out levels_m"
            )

    def rate_mps(self, from_m: ArrayLike, to_m: ArrayLike) -> Floats:
        """How fast the change from one height to another is at most; 0 for none."""
        up_m = np.asarray(to_m, dtype=np.float64) - np.asarray(from_m, dtype=np.float64)
        return np.where(up_m > 0.0, self.up_mps, np.where(up_m < 0.0, self.down_mps, 0.0))

    def least_s(self, from_m: ArrayLike, to_m: ArrayLike) -> Floats:
        """How long the change from one height to another takes at least; 0 for none."""
        up_m = np.asarray(to_m, dtype=np.float64) - np.asarray(from_m, dtype=np.float64)
        return np.where(up_m > 0.0, up_m / self.up_mps, -up_m / self.down_mps)


@dataclass(frozen=True, eq=False)
class Levels:
    """The levels over a grid.

    `height_m`: rising, shape (H,). `flown`: at which of them one may stay; the others are heights of the
    weather between two of those, and are only passed. `rows`: of the grid.
    """

    height_m: Floats
    flown: Bools
    rows: int

    @classmethod
    def one(cls, altitude_m: float, rows: int) -> Levels:
        """A single altitude."""
        return cls(np.array([altitude_m]), np.array([True]), rows)

    @classmethod
    def among(cls, height_m: Floats, levels_m: ArrayLike, rows: int) -> Levels:
        """The given levels, each one of the heights of a wind field, and the heights between them.

        Raises:
            PlannerError: if the field has no such height.
        """
        wanted_m = np.unique(np.asarray(levels_m, dtype=np.float64))
        for level_m in wanted_m.tolist():
            if not np.isclose(height_m, level_m, rtol=0.0, atol=_SAME_M).any():
                raise PlannerError(
                    f"the wind is not laid out at the level of {level_m:.0f} m, but at "
                    f"{', '.join(f'{height:.0f}' for height in height_m)} m; give it that height"
                )
        inner = np.asarray(height_m[(height_m > wanted_m[0] - _SAME_M) & (height_m < wanted_m[-1] + _SAME_M)])
        flown = np.isclose(inner[:, np.newaxis], wanted_m, rtol=0.0, atol=_SAME_M).any(axis=1)
        return cls(inner, flown, rows)

    @property
    def band(self) -> int:
        """Rows from one level to the next."""
        return self.rows + MARGIN

    @property
    def count(self) -> int:
        """Heights, flown or passed."""
        return self.height_m.size

    def at(self, altitude_m: float) -> int:
        """The number of the level at an altitude."""
        return int(np.abs(self.height_m - altitude_m).argmin())

    def cell(self, level: int, cell: Cell) -> Cell:
        """A cell of a level in the tall sheet."""
        return level * self.band + cell[0], cell[1]

    def split(self, cell: Cell) -> tuple[int, Cell]:
        """Level and cell of a cell of the tall sheet."""
        level, row = divmod(cell[0], self.band)
        return level, (row, cell[1])

    def parts(self, tall: NDArray[Sheets]) -> list[NDArray[Sheets]]:
        """The sheets [..., north, east] of each level."""
        begins = range(0, self.count * self.band, self.band)
        return [tall[..., begin : begin + self.rows, :] for begin in begins]


def stacked(sheets: NDArray[Sheets], fill: Any) -> NDArray[Sheets]:
    """Sheets [..., level, north, east] as tall ones [..., row, east], `fill` in the rows between levels."""
    *leading, count, rows, columns = sheets.shape
    tall = np.full((*leading, count, rows + MARGIN, columns), fill, dtype=sheets.dtype)
    tall[..., :rows, :] = sheets
    return tall.reshape(*leading, count * (rows + MARGIN), columns)[..., :-MARGIN, :]
