"""The wind of a stage's area as it is recorded: thinned, and in steps, for the eyes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from recordings.errors import BadRecordingError

Wind = NDArray[np.float32]

STEP_MPS = 2.0**-4
"""What is recorded is rounded to a multiple of it."""

_NODES_ACROSS = 96  # at least, where there are as many cells; wind changes little from one to the next
_VALUES = np.dtype("<i2")


class Thinned(NamedTuple):
    """`every`: cells from one recorded value to the next. `content`: 16-bit integers, north then east."""

    every: int
    content: bytes


def thinned(north_mps: Wind, east_mps: Wind) -> Thinned:
    """Wind, [north, east] on a grid, as it is recorded."""
    every = max(1, max(north_mps.shape) // _NODES_ACROSS)
    nodes = np.stack([north_mps, east_mps])[:, ::every, ::every]
    steps = np.rint(nodes / STEP_MPS).clip(-(2**15), 2**15 - 1)
    return Thinned(every, steps.astype(_VALUES).tobytes())


def filled(recorded: Thinned, shape: tuple[int, int]) -> tuple[Wind, Wind]:
    """The wind on all cells of a grid: linear between those that were recorded, constant beyond the last.

    Raises:
        BadRecordingError: if there are too many or too few of them.
    """
    counts = tuple(-(-cells // recorded.every) for cells in shape)
    if len(recorded.content) != 2 * counts[0] * counts[1] * _VALUES.itemsize:
        raise BadRecordingError(
            f"the wind on {shape} cells, every {recorded.every}, has {len(recorded.content)} bytes"
        )
    nodes = np.frombuffer(recorded.content, _VALUES).reshape(2, *counts).astype(np.float32) * STEP_MPS
    for axis, cells in enumerate(shape, start=1):
        nodes = _between(nodes, np.arange(cells) / recorded.every, axis)
    north_mps, east_mps = nodes.astype(np.float32)
    return north_mps, east_mps


def _between(nodes: NDArray[np.floating], at: NDArray[np.float64], axis: int) -> NDArray[np.floating]:
    """Values at fractional places of an axis."""
    last = nodes.shape[axis] - 1
    low = np.minimum(at.astype(np.int64), last)
    share = np.where(low < last, at - low, 0.0).reshape([-1 if i == axis else 1 for i in range(nodes.ndim)])
    below, above = nodes.take(low, axis), nodes.take(np.minimum(low + 1, last), axis)
    mixed: NDArray[np.floating] = below + share * (above - below)
    return mixed
