"""The routes most likely to survive in one forecast, at a small price for each step.

The sweep of `planner.survival` with worth log(1 - p) - price. Without a price a detour of hours is taken for
the last tenth of a percent.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from planner.ground import Cell, Ground
from planner.survival import CERTAIN, survival_of
from planner.sweep import Worth, sweep
from planner.trace import routes
from sim.reproduce.outlook import Outlook, Way, Window


class Safest:
    """Searches a window of an outlook; only what is certain to be hazard is closed.

    All cells and steps that are asked for lie in the window; no way is looked for beyond it.
    """

    def __init__(
        self, outlook: Outlook, *, blur_cells: float, price: float, window: Window | None = None
    ) -> None:
        """See what is likely.

        Args:
            outlook: the forecast.
            blur_cells: of the share of members.
            price: of a step, in units of -log(1 - p).
            window: None for everywhere and all stages.
        """
        window = window or Window.whole()
        self._probability = outlook.ensemble.probability(blur_cells, window)
        clock = replace(outlook.clock, stage_count=len(self._probability))
        flyable = outlook.flyable
        if flyable is not None:
            flyable = flyable[window.stages, :, window.rows, window.columns]
        self._ground = Ground(self._probability >= CERTAIN, clock, outlook.occupancy, flyable)
        self._price = price
        self._south, self._west = window.rows.start or 0, window.columns.start or 0
        self._before = (window.stages.start or 0) * clock.steps_per_stage

    def chance(self, cells: Sequence[Cell], first_step: int) -> float:
        """The product of (1 - p) over the steps of a route."""
        inside = [self._inside(cell) for cell in cells]
        clock = self._ground.clock
        return survival_of(inside, first_step - self._before, self._probability, clock).at_least

    def find(self, start: Cell, goals: Sequence[Cell], first_step: int = 0) -> list[Way]:
        """The way to each goal from a start that is left at a step."""
        ground, begin, step = self._ground, self._inside(start), first_step - self._before
        found: list[Way] = [None] * len(goals)
        if ground.hazard[ground.clock.stage_of_step(step)][begin]:
            return found
        worth = np.log1p(-np.where(ground.hazard, 0.0, self._probability)) - self._price
        ends = [self._inside(goal) for goal in goals]
        swept = sweep(ground, Worth(worth, 1.0, float(-worth.min())), begin, ends, first_step=step)
        values = swept.values()
        best = {
            at: (end, int(values[:, at].argmax()))
            for at, end in enumerate(ends)
            if math.isfinite(values[:, at].max())
        }
        for at, cells in zip(best, routes(swept, list(best.values())), strict=True):
            found[at] = tuple((row + self._south, column + self._west) for row, column in cells)
        return found

    def _inside(self, cell: Cell) -> Cell:
        return cell[0] - self._south, cell[1] - self._west
