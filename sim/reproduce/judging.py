"""What becomes of a planned route in the truth."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

import numpy as np

from planner.ground import Cell, Ground, Occupancy


class Fate(StrEnum):
    """What a policy's plan for one goal came to."""

    SAFE = "safe"
    LOST = "lost"
    NO_ROUTE = "no route"
    ABSTAINED = "abstained"


def first_hazard(cells: Sequence[Cell], truth: Ground, first_step: int = 0) -> int | None:
    """The first step of a route at which it is in hazard, by the truth's rule of occupancy; None if never.

    Args:
        cells: occupied at each step from `first_step` on, all within the horizon.
        truth: the hazard as it turned out.
        first_step: the step of departure.
    """
    clock = truth.clock
    steps = np.arange(first_step, first_step + len(cells))
    stages = steps // clock.steps_per_stage
    rows, columns = np.array(cells, dtype=np.intp).reshape(-1, 2).T
    met = truth.hazard[stages, rows, columns]
    if truth.occupancy is Occupancy.STRICT:  # a move that crosses into a stage has to be safe in both
        met[1:] |= truth.hazard[stages[:-1], rows[1:], columns[1:]]
        met[:-1] |= truth.hazard[stages[1:], rows[:-1], columns[:-1]]
    hit = np.flatnonzero(met)
    return int(steps[hit[0]]) if hit.size else None
