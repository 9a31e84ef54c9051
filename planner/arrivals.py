"""Earliest arrivals: the cells that can be occupied at each step, all at once as bits.

Nothing but reach is asked here, so a step over the whole grid is a dozen operations on a few thousand words.
A route is read backwards out of the sheets of the steps before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.bits import BitGrid, Words, spread
from planner.ground import Cell, Ground, Occupancy
from planner.hazards import OFFSETS, Bools, Move

NEVER = -1
"""The arrival step of a cell that is not reached within the horizon."""


@dataclass(frozen=True, slots=True)
class Arrivals:
    """Which cells can be occupied when.

    `layers`: packed cells that can be occupied, shape [step, words], empty before `first_step`.
    """

    ground: Ground
    first_step: int
    grid: BitGrid
    layers: Words

    def occupied(self, step: int) -> Bools:
        """The cells that can be occupied at a step, [north, east]."""
        return self.grid.unpack(self.layers[step])

    def can_occupy(self, cell: Cell) -> Bools:
        """At which steps a cell can be occupied, shape [step]."""
        word, bit = self.grid.place(cell)
        return (self.layers[:, word] >> np.uint64(bit) & np.uint64(1)).astype(np.bool_)

    def step_at(self, cell: Cell) -> int | None:
        """The earliest arrival at a cell, or None."""
        occupied = self.can_occupy(cell)
        first = int(occupied.argmax())
        return first if occupied[first] else None

    def steps_at(self, cells: Sequence[Cell]) -> NDArray[np.int32]:
        """The earliest arrival at each of some cells, NEVER where there is none."""
        places = [self.grid.place(cell) for cell in cells]
        words, bits = np.array(places, dtype=np.int64).reshape(-1, 2).T
        occupied = self.layers[:, words] >> bits.astype(np.uint64) & np.uint64(1)
        first = occupied.argmax(axis=0)
        return np.where(occupied.any(axis=0), first, NEVER).astype(np.int32)

    def field(self) -> NDArray[np.int32]:
        """The earliest arrival at every cell, shape [north, east], NEVER where there is none."""
        seen = np.zeros(self.grid.size, dtype=np.uint64)
        hits: list[tuple[NDArray[np.intp], Words, NDArray[np.int32]]] = []
        for step in range(self.first_step, len(self.layers)):
            fresh = self.layers[step] & ~seen
            words = np.flatnonzero(fresh)
            seen |= fresh
            hits.append((words, fresh[words], np.full(words.size, step, dtype=np.int32)))
        words, fresh, step_of = (np.concatenate(part) for part in zip(*hits, strict=True))
        bits = np.unpackbits(fresh.astype("<u8").view(np.uint8), bitorder="little")
        found = np.flatnonzero(bits)
        hit, bit = found >> 6, found & 63
        width = self.grid.width
        steps = np.full(self.ground.shape, NEVER, dtype=np.int32)
        steps[words[hit] // width - 1, words[hit] % width * 64 + bit] = step_of[hit]
        return steps

    def route(self, goal: Cell) -> tuple[Cell, ...] | None:
        """A route of earliest arrival, as the cell occupied at each step from `first_step`; or None.

        Of the predecessors that serve, the first in the order STAY, NORTH, SOUTH, EAST, WEST is taken.
        """
        arrival = self.step_at(goal)
        if arrival is None:
            return None
        octets = self.layers.astype("<u8", copy=False).view(np.uint8)
        flat = octets.reshape(-1).data
        a_step, a_row = self.grid.size * 8, self.grid.width * 8
        plain = self.ground.occupancy is Occupancy.PAPER and self.ground.flyable is None
        cells = [goal]
        row, column = goal
        for step in range(arrival, self.first_step, -1):
            base = (step - 1) * a_step + a_row
            for move, rows, columns in _BACKWARD:
                r, c = row - rows, column - columns
                if c < 0 or not flat[base + r * a_row + (c >> 3)] >> (c & 7) & 1:
                    continue
                if plain or self.ground.may_move(step, (r, c), move):
                    row, column = r, c
                    break
            cells.append((row, column))
        return tuple(reversed(cells))


_BACKWARD = [(move, *offset) for move, offset in OFFSETS.items()]


def sweep_arrivals(ground: Ground, start: Cell, *, first_step: int = 0) -> Arrivals:
    """Find which cells can be occupied at each step.

    Args:
        ground: where and how one may move.
        start: the cell occupied at `first_step`.
        first_step: the step of departure.

    Returns:
        The arrivals; empty if the start is in hazard at departure.

    Raises:
        OutsideGridError: if the start lies off the grid.
    """
    ground.check_cell("start", start)
    clock = ground.clock
    grid = BitGrid(*ground.shape)
    layers = np.zeros((clock.step_count, grid.size), dtype=np.uint64)
    safe = grid.pack(~ground.hazard)
    word, bit = grid.place(start)
    layers[first_step, word] = np.uint64(1 << bit)
    layers[first_step] &= safe[clock.stage_of_step(first_step)]
    leaving = None
    work = np.empty(grid.size, dtype=np.uint64)
    reached = layers[first_step]
    width = grid.width
    first_row = last_row = start[0] + 1
    for step in range(first_step + 1, clock.step_count):
        stage, before = clock.stage_of_step(step), clock.stage_of_step(step - 1)
        begins = stage != before
        if ground.flyable is not None and (step == first_step + 1 or clock.stage_of_step(step - 2) != before):
            leaving = grid.pack(ground.flyable[before, Move.NORTH :])
        if begins and ground.occupancy is Occupancy.STRICT:
            reached = reached & safe[stage]
        first_row, last_row = max(1, first_row - 1), min(grid.rows, last_row + 1)
        words = first_row * width, (last_row + 1) * width
        layer = layers[step]
        spread(reached, layer, words, width, leaving, work)
        inner = layer[words[0] : words[1]]
        np.bitwise_and(inner, safe[stage, words[0] : words[1]], inner)
        if begins and ground.occupancy is Occupancy.STRICT:
            inner &= safe[before, words[0] : words[1]]
        reached = layer
    return Arrivals(ground, first_step, grid, layers)
