"""Where to wait: a way that stays out of hazard as long as possible, with little moving about."""

from __future__ import annotations

import numpy as np

from planner.arrivals import sweep_arrivals
from planner.ground import Cell, Ground
from planner.sweep import Worth, sweep
from planner.trace import routes

LEAVING_STEPS = 2
"""For so long after a forecast is issued a place has to be safe, so that it can be left when it is known."""


def stay(ground: Ground, start: Cell, *, first_step: int) -> tuple[Cell, ...] | None:
    """The cells of the route that is safe longest.

    Of the cells in which it may end the one nearest to the start, in moves, and of the ways there the one
    with most waits.

    Args:
        ground: where and how one may move.
        start: the cell occupied at `first_step`.
        first_step: from when on.

    Returns:
        The cell at each step from `first_step` on; None if the start is in hazard then.
    """
    arrivals = sweep_arrivals(ground, start, first_step=first_step)
    alive = np.flatnonzero(arrivals.layers.any(axis=1))
    if not len(alive):
        return None
    last = int(alive[-1])
    cells = np.argwhere(arrivals.occupied(last))
    nearest = cells[np.abs(cells - np.array(start)).sum(axis=1).argmin()]
    end = int(nearest[0]), int(nearest[1])
    if last == first_step:
        return (end,)
    nothing = Worth(
        np.zeros(ground.hazard.shape), 0.0, 0.0
    )  # of equally good labels that with more waits stays
    swept = sweep(ground, nothing, start, [end], first_step=first_step)
    (found,) = routes(swept, [(end, last)])
    return found
