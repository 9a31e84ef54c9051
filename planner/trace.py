"""Routes out of a sweep: the steps between two keeps run once more, in a window around each route."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planner.ground import Cell, Occupancy
from planner.hazards import OFFSETS, Move
from planner.labels import UNREACHED, FlatGrid, Ints, Scratch, advance, drift
from planner.sweep import FLYABLE_ORDER, Keep, Swept, blocked, largest_leaving, wait_gain

Indices = NDArray[np.intp]


def routes(swept: Swept, ends: Sequence[tuple[Cell, int]]) -> list[tuple[Cell, ...]]:
    """The cells occupied from departure to each end.

    Of equally good predecessors the first in the order STAY, NORTH, SOUTH, EAST, WEST is taken.

    Args:
        swept: the sweep.
        ends: a reached cell and the step of arrival there, for each route.

    Returns:
        For each end the cell at each step from the departure's to the arrival's.
    """
    steps = np.array([step for _, step in ends], dtype=np.intp)
    cells = np.array([cell for cell, _ in ends], dtype=np.intp).reshape(-1, 2)
    columns = swept.ground.shape[1]
    trail = np.zeros((len(ends), swept.ground.clock.step_count), dtype=np.int32)
    trail[np.arange(len(ends)), steps] = cells @ (columns, 1)
    upper = swept.ground.clock.step_count - 1
    for keep in reversed(swept.keeps):
        active = np.flatnonzero(steps > keep.step)
        if active.size:
            top = int(steps[active].max())
            window = _Window(swept, keep, cells[active], upper - keep.step)
            history = window.run(keep.step, top)
            for step in range(top, keep.step, -1):
                here = np.flatnonzero(steps[active] == step)
                moving = active[here]
                leaving = history[step - keep.step - 1]
                cells[moving] = window.predecessors(leaving, step, here, cells[moving])
                steps[moving] = step - 1
                trail[moving, step - 1] = cells[moving] @ (columns, 1)
        upper = keep.step
    named = {code: divmod(code, columns) for code in np.unique(trail).tolist()}
    return [
        tuple(map(named.__getitem__, codes[swept.first_step : step + 1].tolist()))
        for codes, (_, step) in zip(trail, ends, strict=True)
    ]


class _Window:
    """The surroundings of some cells, one below the other in one flat grid.

    Each reaches `radius` cells from its centre. After i steps it is right up to radius - i cells from there,
    which is all that a route back to the keep needs. Where these squares would be larger than the grid
    together, the grid itself is the only window.
    """

    def __init__(self, swept: Swept, keep: Keep, centres: Indices, radius: int) -> None:
        self.swept = swept
        shape = swept.ground.shape
        side = 2 * radius + 1
        if len(centres) * side * side < shape[0] * shape[1]:
            self.size, self.origins = (side, side), centres - radius
        else:
            self.size, self.origins = shape, np.zeros((1, 2), dtype=np.intp)
        self.flat = FlatGrid(len(self.origins) * self.size[0], self.size[1])
        rows = (self.origins[:, :1] + np.arange(self.size[0]))[:, :, None]
        columns = (self.origins[:, 1:] + np.arange(self.size[1]))[:, None, :]
        self.inside = (rows >= 0) & (rows < shape[0]) & (columns >= 0) & (columns < shape[1])
        self.rows = np.clip(rows, 0, shape[0] - 1)
        self.columns = np.clip(columns, 0, shape[1] - 1)
        kept = FlatGrid(*shape).index(self.rows, self.columns) - keep.first_row * (shape[1] + 1)
        there = self.inside & (kept >= 0) & (kept < keep.labels.size)
        self.labels = self._lay(np.where(there, keep.labels[np.where(there, kept, 0)], UNREACHED))
        self.flyable: dict[int, Ints | None] = {}

    def _lay(self, sheet: NDArray[np.int64]) -> Ints:
        return self.flat.lay(sheet.reshape(self.flat.rows, self.flat.columns), UNREACHED)

    def _gains(self, stage: int) -> Ints:
        swept = self.swept
        blocked = swept.ground.hazard[stage][self.rows, self.columns] | ~self.inside
        values = swept.worth.sheets[stage][self.rows, self.columns]
        return self._lay(swept.point.sheet(values, swept.worth.factor, blocked))

    def _leaving(self, stage: int) -> Ints | None:
        flyable = self.swept.ground.flyable
        if flyable is None:
            return None
        if stage not in self.flyable:
            largest = largest_leaving(flyable[stage][:, self.rows, self.columns])
            self.flyable[stage] = np.stack([self._lay(largest[move]) for move in FLYABLE_ORDER])
        return self.flyable[stage]

    def run(self, begin: int, end: int) -> list[Ints]:
        """The labels that leave for each of the steps after `begin` up to `end`, all in one stage."""
        swept, clock = self.swept, self.swept.ground.clock
        scratch = Scratch(self.flat.size)
        stage, before = clock.stage_of_step(begin + 1), clock.stage_of_step(begin)
        inner = self._gains(stage)
        gains = inner
        if stage != before and swept.ground.occupancy is Occupancy.STRICT:
            np.copyto(self.labels, UNREACHED, where=blocked(inner))
            gains = np.where(blocked(self._gains(before)), UNREACHED, inner)
        amount = swept.point.whole(swept.worth.wait) if swept.worth.wait_grows else 0
        history = []
        for step in range(begin + 1, end + 1):
            if amount:
                drift(self.labels, swept.point.wait_mask, amount, scratch)
            history.append(self.labels.copy())
            wait = wait_gain(swept.worth, swept.point, step - swept.first_step)
            leaving = self._leaving(clock.stage_of_step(step - 1))
            advance(self.labels, (1, self.flat.rows), self.flat.width, wait, gains, leaving, scratch)
            np.maximum(self.labels, UNREACHED, out=self.labels)
            gains = inner
        return history

    def predecessors(self, leaving: Ints, step: int, which: Indices, cells: Indices) -> Indices:
        """The cells from which the best labels came to the given cells of the given windows."""
        swept, flat = self.swept, self.flat
        window = np.minimum(which, len(self.origins) - 1)
        offsets = cells - self.origins[window]
        at = flat.index(window * self.size[0] + offsets[:, 0], offsets[:, 1])
        may_leave = self._leaving(swept.ground.clock.stage_of_step(step - 1))
        incoming = np.empty((len(Move), at.size), dtype=np.int64)
        incoming[0] = leaving[at] + wait_gain(swept.worth, swept.point, step - swept.first_step)
        for order, move in enumerate(FLYABLE_ORDER):
            rows, columns = OFFSETS[move]
            source = at - rows * flat.width - columns
            incoming[order + 1] = leaving[source]
            if may_leave is not None:
                np.minimum(incoming[order + 1], may_leave[order, source], out=incoming[order + 1])
        return np.asarray(cells - _STEPS[incoming.argmax(axis=0)])


_STEPS = np.array([OFFSETS[move] for move in Move], dtype=np.intp)
