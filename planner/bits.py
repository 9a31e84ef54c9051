"""Sheets of bits: a cell is one bit of a 64-bit word, a row a few words, the grid one run of words.

Each row ends in at least one bit that no cell uses, and a row of zeros lies before the first and after the
last, so that the four neighbours of all cells are shifts of the whole run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.ground import Cell
from planner.hazards import Bools

Words = NDArray[np.uint64]

_WORD = 64
_ONE, _TOP = np.uint64(1), np.uint64(_WORD - 1)


@dataclass(frozen=True, slots=True)
class BitGrid:
    """How a grid of rows and columns is packed."""

    rows: int
    columns: int

    @property
    def width(self) -> int:
        """Words a row."""
        return self.columns // _WORD + 1

    @property
    def size(self) -> int:
        """Words in all."""
        return (self.rows + 2) * self.width

    def pack(self, sheets: Bools) -> Words:
        """Pack [..., north, east] into [..., words]."""
        leading = sheets.shape[:-2]
        packed = np.zeros((*leading, self.rows + 2, self.width * 8), dtype=np.uint8)
        octets = np.packbits(sheets, axis=-1, bitorder="little")
        packed[..., 1:-1, : octets.shape[-1]] = octets
        return packed.view("<u8").astype(np.uint64, copy=False).reshape(*leading, self.size)

    def unpack(self, words: Words) -> Bools:
        """Unpack [..., words] into [..., north, east]."""
        octets = words.astype("<u8", copy=False).reshape(*words.shape[:-1], self.rows + 2, self.width)
        inner = np.ascontiguousarray(octets[..., 1:-1, :]).view(np.uint8)
        return np.unpackbits(inner, axis=-1, count=self.columns, bitorder="little").view(np.bool_)

    def place(self, cell: Cell) -> tuple[int, int]:
        """The word that holds a cell, and its bit in it."""
        return (cell[0] + 1) * self.width + cell[1] // _WORD, cell[1] % _WORD


def spread(
    reached: Words, into: Words, words: tuple[int, int], width: int, leaving: Words | None, work: Words
) -> None:
    """Write the cells reached in one step, waiting included, whether safe or not.

    Args:
        reached: cells occupied before the step.
        into: where to write.
        words: the first word to write and the one after the last, at least a row from both ends.
        width: words a row.
        leaving: [north, south, east, west][words], the cells that may be left in each direction, or None.
        work: a run of words to work in.
    """
    begin, end = words
    north = south = east = west = reached
    if leaving is not None:
        north, south, east, west = (reached & way for way in leaving)
    target, carried = into[begin:end], work[begin:end]
    left_shift, right_shift, join = np.left_shift, np.right_shift, np.bitwise_or
    left_shift(east[begin:end], _ONE, target)
    right_shift(east[begin - 1 : end - 1], _TOP, carried)
    join(target, carried, target)
    right_shift(west[begin:end], _ONE, carried)
    join(target, carried, target)
    left_shift(west[begin + 1 : end + 1], _TOP, carried)
    join(target, carried, target)
    join(target, reached[begin:end], target)
    join(target, north[begin - width : end - width], target)
    join(target, south[begin + width : end + width], target)
