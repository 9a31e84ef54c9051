"""Which cells can be occupied next: the rules of the staged problem as look-up tables."""

from __future__ import annotations

import numpy as np

from planner.hazards import OFFSETS, Bools
from planner.staged import Cell, Occupancy, StagedProblem

_MOVE_OF = {offset: move for move, offset in OFFSETS.items()}


class Moves:
    """Answers for one problem, a table for each pair of stages that a move can touch."""

    def __init__(self, problem: StagedProblem) -> None:
        self.problem = problem
        self._rows, self._columns = problem.hazard.shape[1:]
        self._tables: dict[tuple[int, int], tuple[bytes, ...]] = {}

    def leaving(self, step: int, cell: Cell) -> list[Cell]:
        """The cells that may be occupied at `step` + 1 from `cell` at `step`, staying first."""
        table = self.table(step)
        row, column = cell
        index = row * self._columns + column
        return [
            (row + rows, column + columns)
            for may, (rows, columns) in zip(table, OFFSETS.values(), strict=True)
            if may[index]
        ]

    def may(self, step: int, here: Cell, there: Cell) -> bool:
        """Whether the move between two cells that are one move apart, or the same, can be made at `step`."""
        table = self.table(step)
        move = _MOVE_OF[there[0] - here[0], there[1] - here[1]]
        inside = 0 <= here[0] < self._rows and 0 <= here[1] < self._columns
        return inside and bool(table[move][here[0] * self._columns + here[1]])

    def table(self, step: int) -> tuple[bytes, ...]:
        """For each `Move`, by flat index of the cell left at `step`, whether it can be made."""
        clock = self.problem.clock
        stages = clock.stage_of_step(step), clock.stage_of_step(step + 1)
        if stages not in self._tables:
            self._tables[stages] = tuple(may.tobytes() for may in allowed_moves(self.problem, *stages))
        return self._tables[stages]


def allowed_moves(problem: StagedProblem, before: int, after: int) -> list[Bools]:
    """Whether each move can be made, by the cell that it leaves.

    Args:
        problem: hazard, flyable moves and the rule of occupancy.
        before: the stage in which the move begins.
        after: the stage in which it ends.

    Returns:
        One array [north, east] for each `Move`, in their order.
    """
    safe = ~problem.hazard[after]
    if problem.occupancy is Occupancy.STRICT:
        safe &= ~problem.hazard[before]
    rows, columns = safe.shape
    framed = np.pad(safe, 1)
    allowed = []
    for move, (north, east) in OFFSETS.items():
        may = framed[1 + north : 1 + north + rows, 1 + east : 1 + east + columns].copy()
        if problem.occupancy is Occupancy.STRICT:
            may &= safe
        if problem.flyable is not None:
            may &= problem.flyable[before, move]
        allowed.append(may)
    return allowed
