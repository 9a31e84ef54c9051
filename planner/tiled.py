"""Gridded values too large for memory: read from where they lie, tile by tile, when they are asked for."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Read = Callable[[int, slice, slice, slice], tuple[NDArray[Any], ...]]
"""(time, heights, rows, columns) -> each component there, shape [height, north, east]."""

TILE_CELLS = 64
"""Rows and columns of a tile: an aircraft crosses one of 1 km cells in half an hour."""

_KEPT = 64
_FEW = 4  # tiles to a time, of which a question keeps what it reads


class Tiles:
    """The components of a field, with the tiles that were read last.

    `shape`: (times, heights, rows, columns).
    """

    def __init__(self, read: Read, shape: tuple[int, int, int, int]) -> None:
        self._read, self.shape = read, shape
        self._kept: OrderedDict[tuple[int, int, int], tuple[NDArray[Any], ...]] = OrderedDict()

    def part(self, component: int, ranges: tuple[slice, ...]) -> NDArray[Any]:
        """A component at runs of times, heights, rows and columns; shape [time, height, north, east]."""
        times, heights, rows, columns = ranges
        tiles = [slice(run.start // TILE_CELLS, (run.stop - 1) // TILE_CELLS + 1) for run in (rows, columns)]
        few = (tiles[0].stop - tiles[0].start) * (tiles[1].stop - tiles[1].start) <= _FEW
        if not few:
            return np.stack([self._read(time, heights, rows, columns)[component] for time in _each(times)])
        sheets = [
            np.concatenate(
                [
                    np.concatenate(
                        [self._tile(time, row, column)[component] for column in _each(tiles[1])], axis=2
                    )
                    for row in _each(tiles[0])
                ],
                axis=1,
            )
            for time in _each(times)
        ]
        south, west = (run.start * TILE_CELLS for run in tiles)
        within = (
            slice(rows.start - south, rows.stop - south),
            slice(columns.start - west, columns.stop - west),
        )
        return np.stack(sheets)[:, heights, *within]

    def _tile(self, time: int, row: int, column: int) -> tuple[NDArray[Any], ...]:
        key = time, row, column
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        _, heights, rows, columns = self.shape
        found = self._read(time, slice(0, heights), _run(row, rows), _run(column, columns))
        self._kept[key] = found
        if len(self._kept) > _KEPT:
            self._kept.popitem(last=False)
        return found


class TiledArray:
    """One component, as far as a `WindField` uses an array: shape, type, indexing, times a number.

    Indices are whole numbers, slices, or arrays of whole numbers that broadcast together.
    """

    def __init__(self, tiles: Tiles, component: int, *, flat: bool = False, factor: float = 1.0) -> None:
        """A view.

        Args:
            tiles: where the values come from.
            component: which of theirs.
            flat: without the axis of heights, of which there is one.
            factor: what they are multiplied by.
        """
        self._tiles, self._component, self._flat, self._factor = tiles, component, flat, factor
        times, heights, rows, columns = tiles.shape
        self.shape = (times, rows, columns) if flat else (times, heights, rows, columns)
        self.ndim = len(self.shape)
        self.dtype = np.dtype(np.float32)

    def __rmul__(self, factor: float) -> TiledArray:
        return TiledArray(self._tiles, self._component, flat=self._flat, factor=float(factor) * self._factor)

    def __getitem__(self, key: Any) -> NDArray[Any]:
        keys = list(key) if isinstance(key, tuple) else [key]
        keys += [slice(None)] * (self.ndim - len(keys))
        runs, within = zip(
            *(_bounded(one, size) for one, size in zip(keys, self.shape, strict=True)), strict=True
        )
        if self._flat:
            values = self._tiles.part(self._component, (runs[0], slice(0, 1), *runs[1:]))[:, 0]
        else:
            values = self._tiles.part(self._component, runs)
        values = values[tuple(within)]
        return values if self._factor == 1.0 else np.asarray(np.float32(self._factor) * values)


def is_tiled(values: object) -> bool:
    """Whether values are read when they are asked for."""
    return isinstance(values, TiledArray)


def _each(run: slice) -> range:
    return range(run.start, run.stop)


def _run(tile: int, size: int) -> slice:
    return slice(tile * TILE_CELLS, min((tile + 1) * TILE_CELLS, size))


def _bounded(key: Any, size: int) -> tuple[slice, Any]:
    """The run of an axis that an index touches, and the index within that run."""
    if isinstance(key, slice):
        start, stop, step = key.indices(size)
        return slice(start, stop), slice(None, None, step)
    places = np.asarray(key)
    low = int(places.min())
    return slice(low, int(places.max()) + 1), (places - low if places.ndim else int(places) - low)
