"""Labels as integers: what one step does to the best label of each cell.

A label is the value of a route, in fixed point, with the count of its waits in the lowest bits; so the larger
of two integers is the better label, and of two equally good ones that with more waits, the shorter route.
The grid lies flat in memory with a border of unreachable cells. All four neighbours then are shifts of one
row of numbers, and the best of them takes two maxima instead of four: the neighbours of x are at
x - w, x - 1, x + 1 and x + w, which is {x - w, x + 1} and the same two moved on by w - 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.hazards import Bools

Ints = NDArray[np.int64]

UNREACHED = -(1 << 60)
"""A label of no route; every real label is at least 0. Added once more to a label it kills it."""

STEPS_BETWEEN_CLAMPS = 5  # UNREACHED times 7 still fits 64 bits

_LABEL_BITS = 58


@dataclass(frozen=True, slots=True)
class FixedPoint:
    """Values as integers: `scale` units to 1, then `wait_bits` lower bits that count waits."""

    scale: float
    wait_bits: int

    @classmethod
    def for_values(cls, largest: float, step_count: int) -> FixedPoint:
        """The finest one in which values up to `largest` and waits up to `step_count` fit."""
        wait_bits = step_count.bit_length()
        exponent = _LABEL_BITS - wait_bits - math.frexp(max(largest, 1e-9))[1]
        return cls(math.ldexp(1.0, min(exponent, 60)), wait_bits)

    @property
    def wait_mask(self) -> int:
        """The bits that count waits."""
        return (1 << self.wait_bits) - 1

    def whole(self, value: float) -> int:
        """A value as the integer that is added to labels."""
        return round(value * self.scale) << self.wait_bits

    def sheet(self, values: NDArray[np.float64], factor: float, blocked: Bools) -> Ints:
        """Values times a factor as integers, and UNREACHED where blocked."""
        whole = np.rint(values * (factor * self.scale)).astype(np.int64)
        whole <<= self.wait_bits
        whole[blocked] = UNREACHED
        return whole

    def values(self, labels: Ints) -> NDArray[np.float64]:
        """The values of labels, -inf where unreached."""
        return np.where(labels < 0, -np.inf, (labels >> self.wait_bits) / self.scale)

    def waits(self, labels: Ints) -> Ints:
        """The waits of labels."""
        return np.asarray(labels & self.wait_mask)


@dataclass(frozen=True, slots=True)
class FlatGrid:
    """A grid of rows and columns laid flat, with a border row at both ends and one border column."""

    rows: int
    columns: int

    @property
    def width(self) -> int:
        """Cells from one row to the next."""
        return self.columns + 1

    @property
    def size(self) -> int:
        """Cells in all, the border included."""
        return (self.rows + 2) * self.width + 2

    def index(self, row: NDArray[np.intp] | int, column: NDArray[np.intp] | int) -> NDArray[np.intp]:
        """Where a cell lies."""
        return np.asarray((np.asarray(row) + 1) * self.width + column)

    def lay(self, sheet: NDArray[np.int64], border: int) -> Ints:
        """A sheet [north, east] laid flat."""
        flat = np.full(self.size, border, dtype=np.int64)
        inner = flat[self.width : self.width * (self.rows + 1)].reshape(self.rows, self.width)
        inner[:, : self.columns] = sheet
        return flat


class Scratch:
    """Two work arrays, made once for all steps."""

    def __init__(self, size: int) -> None:
        self.one = np.empty(size, dtype=np.int64)
        self.two = np.empty(size, dtype=np.int64)


def drift(labels: Ints, wait_mask: int, amount: int, scratch: Scratch) -> None:
    """Raise every label by `amount` for each of its waits, in place."""
    raised = scratch.one[: labels.size]
    np.bitwise_and(labels, wait_mask, out=raised)
    np.multiply(raised, amount, out=raised)
    np.add(labels, raised, out=labels)


def advance(
    labels: Ints,
    rows: tuple[int, int],
    width: int,
    wait: int,
    gains: Ints,
    flyable: Ints | None,
    scratch: Scratch,
) -> None:
    """Replace the label of every cell in the rows by the best incoming one, in place.

    Args:
        labels: the flat grid's labels.
        rows: first and last row to change, counted from 1, as row 0 is border.
        width: of the flat grid.
        wait: what waiting adds to a label, the count of waits included.
        gains: what each cell adds to a label that enters it or waits there.
        flyable: [north, south, east, west][cell] by the cell that is left, the largest label that may leave
            it in that direction; None where all moves can be made.
        scratch: work arrays.
    """
    first, last = rows[0] * width, (rows[1] + 1) * width
    begin, end = first - width, last + width + 1
    inner = labels[first:last]
    arriving = scratch.one[first:last]
    if flyable is None:
        pairs = scratch.two[begin : last + 2]
        np.maximum(labels[begin : last + 2], labels[begin + width - 1 : end], out=pairs)
        np.maximum(scratch.two[first - width : last - width], scratch.two[first + 1 : last + 1], out=arriving)
    else:
        leaving = scratch.two[begin:end]
        arriving.fill(UNREACHED)
        for move, shift in enumerate((width, -width, 1, -1)):
            np.minimum(labels[begin:end], flyable[move, begin:end], out=leaving)
            np.maximum(arriving, scratch.two[first - shift : last - shift], out=arriving)
    inner += wait
    np.maximum(inner, arriving, out=inner)
    inner += gains[first:last]
