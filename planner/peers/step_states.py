"""(step, cell) as one number, for the searches that expand such states one at a time.

State = step x cells + row x columns + column. One byte a state keeps the move that first led there.
"""

from __future__ import annotations

import numpy as np

from planner.hazards import OFFSETS, Move
from planner.peers.moves import Moves
from planner.peers.route import PeerRoute
from planner.staged import Cell, StagedProblem

EXPANSION_LIMIT = 20_000_000
"""States expanded before a search gives up without a proof: about a minute, some hundred megabytes."""

GAVE_UP = PeerRoute(reason=f"gave up after {EXPANSION_LIMIT:,} expansions, without a proof")


class StepStates:
    """States of one problem, the distance of each cell to the goal in moves, and where a way came from.

    `last`: the last step at which the goal is safe, -1 if it never is; nothing beyond needs a look.
    """

    def __init__(self, problem: StagedProblem, goal: Cell) -> None:
        rows, columns = problem.hazard.shape[1:]
        self._columns = int(columns)
        self.cell_count = int(rows * columns)
        safe = np.flatnonzero(~problem.hazard[(slice(None), *goal)])
        self.last = (int(safe[-1]) + 1) * problem.clock.steps_per_stage - 1 if safe.size else -1
        self.distance = [
            abs(row - goal[0]) + abs(column - goal[1]) for row in range(rows) for column in range(columns)
        ]
        self._moves = Moves(problem)
        self._offsets = [north * columns + east for north, east in OFFSETS.values()]
        self._came = bytearray(self.cell_count * (max(self.last, 0) + 1))  # move + 1, zero: not met

    def index(self, cell: Cell) -> int:
        """The flat index of a cell."""
        return cell[0] * self._columns + cell[1]

    def meet(self, state: int, move: int) -> bool:
        """Note the move that led to a state; False if another did before."""
        if self._came[state]:
            return False
        self._came[state] = move + 1
        return True

    def successors(self, state: int) -> list[tuple[int, int, int]]:
        """(state, its distance to the goal, the move) of all that can follow and still be in time."""
        step, index = divmod(state, self.cell_count)
        if step >= self.last:
            return []
        left, following = self.last - step - 1, state + self.cell_count
        return [
            (following + offset, self.distance[index + offset], move)
            for move, (may, offset) in enumerate(zip(self._moves.table(step), self._offsets, strict=True))
            if may[index] and self.distance[index + offset] <= left
        ]

    def route_to(self, state: int) -> PeerRoute:
        """The way by which a state was met from step 0."""
        cells = []
        while True:
            step, index = divmod(state, self.cell_count)
            cells.append(divmod(index, self._columns))
            if not step:
                return PeerRoute(tuple(reversed(cells)))
            state -= self.cell_count + self._offsets[Move(self._came[state] - 1)]
