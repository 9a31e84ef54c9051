"""One stage's map as a graph, for the systems that do not know that it changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from planner.hazards import OFFSETS, Move
from planner.staged import Cell, StagedProblem


def stage_graph(
    problem: StagedProblem, stage: int, cost: NDArray[np.float64] | None = None
) -> sparse.csr_array[np.float64]:
    """The moves that can be made in one stage, if it lasted for ever.

    Args:
        problem: hazard and flyable moves.
        stage: whose map is taken.
        cost: what entering each cell costs, shape [north, east], positive; one each where None.

    Returns:
        Square matrix of costs by flat index (row times columns plus column) of the cell left and entered.
    """
    safe = ~problem.hazard[stage]
    rows, columns = safe.shape
    index = np.arange(safe.size).reshape(safe.shape)
    framed = np.pad(safe, 1)
    left, entered = [], []
    for move, (north, east) in OFFSETS.items():
        if move is Move.STAY:
            continue
        may = framed[1 + north : 1 + north + rows, 1 + east : 1 + east + columns].copy()
        if problem.flyable is not None:
            may &= problem.flyable[stage, move]
        left.append(index[may])
        entered.append(index[may] + north * columns + east)
    targets = np.concatenate(entered)
    costs = np.ones(targets.size) if cost is None else cost.ravel()[targets]
    size = safe.size
    return sparse.csr_array((costs, (np.concatenate(left), targets)), shape=(size, size))


def way_back(
    predecessors: NDArray[np.int32], start: Cell, goal: Cell, columns: int
) -> tuple[Cell, ...] | None:
    """The cells from start to goal by a table of predecessors (negative: not reached), None without a way."""
    origin, at = start[0] * columns + start[1], goal[0] * columns + goal[1]
    cells = [goal]
    while at != origin:
        at = int(predecessors[at])
        if at < 0:
            return None
        cells.append(divmod(at, columns))
    return tuple(reversed(cells))
