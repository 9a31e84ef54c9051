"""Safe intervals: the unbroken runs of stages in which a cell can be occupied.

The cells lie in a frame of `MARGIN` hazardous ones, so that moves near the border need no check of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.hazards import Bools

MARGIN = 2
"""Hazardous rows and columns around the grid: as far as the longest move reaches."""

Offset = tuple[int, int]


@dataclass(frozen=True, eq=False)
class SafeIntervals:
    """Runs of safe stages, numbered cell by cell; "place" is a cell's index in the framed, flattened grid.

    `width`: columns of the framed grid. `run_end`: first stage after the run that holds a stage, 0 if the
    cell is not safe in it, shape [stage, place]. `run`: number of that run, -1 if none, [stage, place].
    `place`: of each run, `begin` and `end` its stages, shape (runs,).
    """

    width: int
    run_end: NDArray[np.int16]
    run: NDArray[np.int32]
    place: NDArray[np.int32]
    begin: NDArray[np.int16]
    end: NDArray[np.int16]

    @classmethod
    def of(cls, hazard: Bools) -> SafeIntervals:
        """The intervals of hazard matrices [stage, north, east]."""
        stages = len(hazard)
        safe = np.pad(~hazard, ((0, 0), (MARGIN, MARGIN), (MARGIN, MARGIN))).reshape(stages, -1)
        run_end = np.zeros(safe.shape, dtype=np.int16)
        end = np.zeros(safe.shape[1], dtype=np.int16)
        for stage in range(stages - 1, -1, -1):
            end = np.where(safe[stage], np.where(end > 0, end, np.int16(stage + 1)), np.int16(0))
            run_end[stage] = end
        begins = safe.copy()
        begins[1:] &= ~safe[:-1]
        place, begin = np.nonzero(begins.T)
        first_run = np.concatenate([[0], np.cumsum(begins.sum(axis=0))[:-1]])
        run = first_run + np.cumsum(begins, axis=0) - 1
        run[~safe] = -1
        return cls(
            width=hazard.shape[2] + 2 * MARGIN,
            run_end=run_end,
            run=run.astype(np.int32),
            place=place.astype(np.int32),
            begin=begin.astype(np.int16),
            end=run_end[begin, place],
        )

    def place_of(self, row: int, column: int) -> int:
        """A cell's place."""
        return (row + MARGIN) * self.width + column + MARGIN

    def cell_of(self, place: int) -> tuple[int, int]:
        """A place's cell (row, column)."""
        row, column = divmod(place, self.width)
        return row - MARGIN, column - MARGIN

    def joint_end(self, stage: int, swept: Sequence[Sequence[Offset]]) -> NDArray[np.int16]:
        """First stage in which a move can no longer be made if it can be in `stage`, else 0.

        Args:
            stage: the stage.
            swept: for each move, offsets (rows, columns) of all cells that have to be safe.

        Returns:
            Shape [move, place], by the place that the move leaves.
        """
        ends = self.run_end[stage]
        reach = MARGIN * (self.width + 1)
        inner = slice(reach, ends.size - reach)
        joint = np.zeros((len(swept), ends.size), dtype=np.int16)
        for row, offsets in zip(joint, swept, strict=True):
            row[inner] = ends[inner]
            for rows, columns in offsets:
                shift = rows * self.width + columns
                np.minimum(row[inner], ends[reach + shift : ends.size - reach + shift], out=row[inner])
        return joint
