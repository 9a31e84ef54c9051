"""Cells of gridded wind: in which one a point lies, and the values at its corners as plain numbers."""

from __future__ import annotations

import math
import struct
from bisect import bisect_right
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from planner.axis import Axis, Span

if TYPE_CHECKING:
    from planner.windfield import FieldArray, WindField

Values = tuple[float, ...]
"""At the corners of a cell, [time, (height,) north, east] one after the other."""

Place = tuple[int, float, float, float, float]
"""The number of a cell's first corner, and the fractions of it in time, north, east and up."""

_Read = Callable[[int], Values]
_TURN_RAD = 2.0 * math.pi


class Corners:
    """Finds and reads the cells of a field.

    To find a cell costs as much as to read it, so that is done with plain numbers. An array in memory is
    read by one `struct` for all the corners, that leaves out the bytes between them.
    """

    __slots__ = (
        "_down",
        "_east",
        "_field",
        "_heights",
        "_lats",
        "_lons",
        "_north",
        "_shape",
        "_size",
        "_times",
    )

    def __init__(self, field: WindField) -> None:
        grid, self._field = field.grid, field
        self._times = _steps(field.axes[0])
        self._heights = None if field.height_m is None else _steps(field.axes[1])
        self._lats = grid.south_rad, 1.0 / grid.north_step_rad, grid.rows - 1
        self._lons = grid.west_rad, 1.0 / grid.east_step_rad, grid.columns - 1, _TURN_RAD / grid.east_step_rad
        self._shape: tuple[int, ...] = field.north_mps.shape
        self._size: int = field.north_mps.dtype.itemsize
        self._north, self._east = _reader(field.north_mps, self._size), _reader(field.east_mps, self._size)
        self._down = None if field.down_mps is None else _reader(field.down_mps, self._size)

    def place(self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float) -> Place | None:
        """Where a point lies; None if it is beyond the outermost nodes of an axis."""
        south_rad, per_rad, last_row = self._lats
        y = (lat_rad - south_rad) * per_rad
        west_rad, per_rad, last_column, turn = self._lons
        x = (lon_rad - west_rad) * per_rad
        if not 0.0 <= x < last_column:  # as counted from another turn, it may be
            x += turn if x < 0.0 else -turn
        times, per_s = self._times
        if not (0.0 <= y < last_row and 0.0 <= x < last_column and times[0] <= time_s < times[-1]):
            return None
        time, row, column = bisect_right(times, time_s) - 1, int(y), int(x)
        t = (time_s - times[time]) * per_s[time]
        if self._heights is None:
            _, rows, columns = self._shape
            return (time * rows + row) * columns + column, t, y - row, x - column, 0.0
        heights, per_m = self._heights
        if not heights[0] <= altitude_m < heights[-1]:
            return None
        height = bisect_right(heights, altitude_m) - 1
        _, layers, rows, columns = self._shape
        first = ((time * layers + height) * rows + row) * columns + column
        return first, t, y - row, x - column, (altitude_m - heights[height]) * per_m[height]

    def spans(self, first: int) -> tuple[Span, ...]:
        """The extent of a cell along each axis."""
        nodes = np.unravel_index(first, self._shape)
        return tuple(axis.after(int(node)) for axis, node in zip(self._field.axes, nodes, strict=True))

    def read(self, first: int) -> tuple[Values, Values, Values]:
        """North, east and down [m/s] at the corners of a cell; nothing where the component is zero."""
        begin = first * self._size
        return self._north(begin), self._east(begin), self._down(begin) if self._down else ()

    def beside(self, spans: Sequence[Span]) -> tuple[Values, Values, Values]:
        """The same of any spans of the axes, those beyond the outermost nodes too."""
        field, place = self._field, np.ix_(*((span.first, span.second) for span in spans))
        parts = field.north_mps, field.east_mps, field.down_mps
        north, east, down = (() if part is None else tuple(part[place].ravel().tolist()) for part in parts)
        return north, east, down


def _steps(axis: Axis) -> tuple[list[float], list[float]]:
    """The nodes of an axis, and the inverse distance from each to the next."""
    return axis.nodes.tolist(), (1.0 / np.diff(axis.nodes)).tolist()


def _reader(values: FieldArray, size: int) -> _Read:
    """Reads the corners of the cell whose first one begins at a byte, in arrays of values of `size` bytes."""
    has_cells = min(values.shape) > 1
    in_memory = has_cells and isinstance(values, np.ndarray) and values.flags.c_contiguous
    if in_memory and values.itemsize == size:
        return partial(_layout(values).unpack_from, values.data.cast("B"))
    shape = values.shape

    def looked_up(begin: int) -> Values:
        nodes = np.unravel_index(begin // size, shape)
        corners = values[tuple(slice(int(node), int(node) + 2) for node in nodes)]
        return tuple(corners.ravel().tolist())

    return looked_up


def _layout(values: FieldArray) -> struct.Struct:
    """The corners of a cell as they lie in memory, from the first to the last one."""
    size, number = values.itemsize, values.dtype.char
    layout, length, apart = f"2{number}", 2, 1
    for nodes in values.shape[:0:-1]:  # two rows of one height, those of two heights, all these of two times
        apart *= nodes
        layout, length = f"{layout}{(apart - length) * size}x{layout}", apart + length
    return struct.Struct(layout)
