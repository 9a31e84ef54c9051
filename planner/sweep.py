"""The sweep: from a start, the best label of every cell at every step, and the routes behind them.

What the labels mean is given by `Worth`: the paper's score, its exact version for one arrival step, or the
chance to survive. Parents are not stored. Every few steps the labels are kept, and a route is found again by
running the steps between two keeps once more, in a window around it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.ground import Cell, Ground, Occupancy
from planner.hazards import Bools, Move, StageClock
from planner.labels import (
    STEPS_BETWEEN_CLAMPS,
    UNREACHED,
    FixedPoint,
    FlatGrid,
    Ints,
    Scratch,
    advance,
    drift,
)

KEEP_EVERY = 10
"""Steps between two keeps: shorter takes memory, longer takes time to find routes again."""

FLYABLE_ORDER = (Move.NORTH, Move.SOUTH, Move.EAST, Move.WEST)


@dataclass(frozen=True, slots=True)
class Worth:
    """What makes one route better than another at the same step and cell: the larger sum.

    A step in a cell adds `factor` times `sheets` [stage, north, east]; `largest` bounds what it adds.
    A wait adds `wait`, times the steps elapsed plus one if `wait_grows`.
    """

    sheets: NDArray[np.float64]
    factor: float
    largest: float
    wait: float = 0.0
    wait_grows: bool = False


@dataclass(frozen=True, slots=True)
class Keep:
    """The labels of some rows after a step; all others are unreached."""

    step: int
    first_row: int
    labels: Ints


@dataclass(frozen=True, slots=True)
class Swept:
    """What the sweep left behind.

    `at_goals`: labels, shape [step, goal]. `offset`: the value that every label began with.
    """

    ground: Ground
    worth: Worth
    point: FixedPoint
    start: Cell
    first_step: int
    at_goals: Ints
    offset: float
    keeps: tuple[Keep, ...]

    def values(self) -> NDArray[np.float64]:
        """The sum of worth at the goals, shape [step, goal], -inf where unreached."""
        return self.point.values(self.at_goals) - self.offset

    def waits(self) -> Ints:
        """The waits on the way to the goals, shape [step, goal]."""
        return self.point.waits(self.at_goals)


def wait_gain(worth: Worth, point: FixedPoint, elapsed: int) -> int:
    """What a wait that ends `elapsed` steps after departure adds to a label."""
    factor = elapsed + 1 if worth.wait_grows else 1
    return point.whole(worth.wait) * factor + 1


def sweep(
    ground: Ground,
    worth: Worth,
    start: Cell,
    goals: Sequence[Cell],
    *,
    first_step: int = 0,
    keep: bool = True,
) -> Swept:
    """Run every step from `first_step` to the horizon.

    Args:
        ground: where and how one may move.
        worth: what is to be made large.
        start: the cell occupied at `first_step`; it must be safe then.
        goals: cells whose labels are wanted.
        first_step: the step of departure.
        keep: whether routes are wanted; without, only the labels at the goals are.
    """
    clock = ground.clock
    flat = FlatGrid(*ground.shape)
    steps = clock.step_count - first_step
    negative_offset = steps * worth.largest
    growth = steps if worth.wait_grows else 1
    point = FixedPoint.for_values(2.0 * negative_offset + worth.wait * growth * (steps + 1), max(steps, 1))
    offset = (point.whole(negative_offset) >> point.wait_bits) / point.scale
    run = _Run(ground, worth, point, flat, first_step)
    labels = np.full(flat.size, UNREACHED, dtype=np.int64)
    run.enter(clock.stage_of_step(first_step))
    at = int(flat.index(*start))
    labels[at] = point.whole(offset) + run.gains[at]
    targets = flat.index(*np.array(goals, dtype=np.intp).reshape(-1, 2).T)
    at_goals = np.full((clock.step_count, len(goals)), UNREACHED, dtype=np.int64)
    at_goals[first_step] = labels[targets]
    keeps: list[Keep] = []
    first, last = start[0] + 1, start[0] + 1
    for step in range(first_step + 1, clock.step_count):
        if keeps_before(step, first_step, clock):
            first, last = _reached_rows(labels, flat, first, last)
            if keep:
                kept = labels[(first - 1) * flat.width : (last + 2) * flat.width + 1].copy()
                keeps.append(Keep(step - 1, first - 1, kept))
        first, last = max(1, first - 1), min(flat.rows, last + 1)
        run.step(labels, step, (first, last))
        at_goals[step] = labels[targets]
    return Swept(ground, worth, point, start, first_step, at_goals, offset, tuple(keeps))


def keeps_before(step: int, first_step: int, clock: StageClock) -> bool:
    """Whether the labels are kept before a step: at departure, and every few steps within each stage."""
    return step == first_step + 1 or step % clock.steps_per_stage % KEEP_EVERY == 0


def _reached_rows(labels: Ints, flat: FlatGrid, first: int, last: int) -> tuple[int, int]:
    """The first and the last row that hold a label, counted from 1; unchanged if none does.

    Rows that are left out are not looked after any more, so they are clamped here.
    """
    block = labels[first * flat.width : (last + 1) * flat.width]
    np.maximum(block, UNREACHED, out=block)
    rows = block.reshape(-1, flat.width).max(axis=1) >= 0
    if not rows.any():
        return first, last
    return first + int(rows.argmax()), last - int(rows[::-1].argmax())


class _Run:
    """The sheets of the stage at hand."""

    def __init__(
        self, ground: Ground, worth: Worth, point: FixedPoint, flat: FlatGrid, first_step: int
    ) -> None:
        self.ground, self.worth, self.point, self.flat = ground, worth, point, flat
        self.first_step = first_step
        self.scratch = Scratch(flat.size)
        self.drift = point.whole(worth.wait) if worth.wait_grows else 0
        self.gains: Ints = np.empty(0, dtype=np.int64)
        self.flyable: Ints | None = None

    def enter(self, stage: int) -> None:
        hazard = self.ground.hazard[stage]
        sheet = self.point.sheet(self.worth.sheets[stage], self.worth.factor, hazard)
        self.gains = self.flat.lay(sheet, UNREACHED)

    def may_leave(self, stage: int) -> None:
        """Take over the moves that can be flown in the stage in which they begin."""
        if self.ground.flyable is not None:
            self.flyable = np.stack(
                [
                    self.flat.lay(largest_leaving(self.ground.flyable[stage, move]), UNREACHED)
                    for move in FLYABLE_ORDER
                ]
            )

    def step(self, labels: Ints, step: int, rows: tuple[int, int]) -> None:
        clock, flat = self.ground.clock, self.flat
        stage, before = clock.stage_of_step(step), clock.stage_of_step(step - 1)
        gains = self.gains
        if step == self.first_step + 1 or clock.stage_of_step(max(step - 2, 0)) != before:
            self.may_leave(before)
        if stage != before:
            left = self.gains
            self.enter(stage)
            gains = self.gains
            if self.ground.occupancy is Occupancy.STRICT:
                np.copyto(labels, UNREACHED, where=blocked(self.gains))
                gains = np.where(blocked(left), UNREACHED, self.gains)
        reading = slice((rows[0] - 1) * flat.width, (rows[1] + 2) * flat.width + 1)
        if self.drift:
            drift(labels[reading], self.point.wait_mask, self.drift, self.scratch)
        wait = wait_gain(self.worth, self.point, step - self.first_step)
        advance(labels, rows, flat.width, wait, gains, self.flyable, self.scratch)
        if step % STEPS_BETWEEN_CLAMPS == 0 or stage != before or self.flyable is not None:
            np.maximum(labels[reading], UNREACHED, out=labels[reading])


def blocked(gains: Ints) -> Bools:
    """Cells that kill a label."""
    return np.asarray(gains <= UNREACHED)


def largest_leaving(flyable: Bools) -> Ints:
    """The largest label that may leave a cell: any, or none."""
    return np.where(flyable, np.int64(-UNREACHED), np.int64(UNREACHED))
