"""The wind along one flight, read quickly."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from planner.axis import EVERYWHERE, Span

if TYPE_CHECKING:
    from planner.windfield import FieldArray, WindField


_RECENT_CELLS = 4  # that meet along an edge, as a route has it

_Bounds = tuple[float, ...]
_Cell = tuple[float, float, float, float, tuple[float, ...], tuple[float, ...], tuple[float, ...]]

_ANY_HEIGHT = Span(0, 0, -EVERYWHERE, EVERYWHERE, 0.0)


class WindProbe:
    """Reads the wind along a flight: quick while the aircraft stays in one cell and between two times.

    In a cell each component is a polynomial of degree one in each of the fractions along the axes; its
    coefficients are kept as plain numbers, those of the last few cells too: routes along the nodes of a grid
    lead from cell to cell and back all the time.
    """

    __slots__ = ("_bounds", "_cell", "_field", "_recent")

    def __init__(self, field: WindField) -> None:
        self._field = field
        self._bounds: _Bounds = (math.inf, -math.inf) * 4  # of no cell at all
        self._cell: _Cell
        self._recent: list[tuple[_Bounds, _Cell]] = []

    def __call__(
        self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float = 0.0
    ) -> tuple[float, float, float]:
        """The wind (north, east, down) [m/s].

        Raises:
            OutsideFieldError: outside time, height or area, unless the field has `hold`.
        """
        t_low, t_high, y_low, y_high, x_low, x_high, z_low, z_high = self._bounds
        if not (
            t_low <= time_s <= t_high
            and y_low <= lat_rad <= y_high
            and x_low <= lon_rad <= x_high
            and z_low <= altitude_m <= z_high
        ):
            self._bounds, self._cell = self._entered(time_s, lat_rad, lon_rad, altitude_m)
            t_low, _, y_low, _, x_low, _, z_low, _ = self._bounds
        t_inverse, y_inverse, x_inverse, z_inverse, north, east, down = self._cell
        t, y, x = (time_s - t_low) * t_inverse, (lat_rad - y_low) * y_inverse, (lon_rad - x_low) * x_inverse
        if not z_inverse:
            return _level(north, t, y, x), _level(east, t, y, x), _level(down, t, y, x) if down else 0.0
        z = (altitude_m - z_low) * z_inverse
        return (
            _level(north, t, y, x) + z * _level(north[8:], t, y, x),
            _level(east, t, y, x) + z * _level(east[8:], t, y, x),
            _level(down, t, y, x) + z * _level(down[8:], t, y, x) if down else 0.0,
        )

    def _entered(
        self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float
    ) -> tuple[_Bounds, _Cell]:
        """The bounds and the polynomials of the cell around a point."""
        for known in self._recent:
            t_low, t_high, y_low, y_high, x_low, x_high, z_low, z_high = known[0]
            if (
                t_low <= time_s <= t_high
                and y_low <= lat_rad <= y_high
                and x_low <= lon_rad <= x_high
                and z_low <= altitude_m <= z_high
            ):
                return known
        made = self._made(time_s, lat_rad, lon_rad, altitude_m)
        self._recent = [made, *self._recent[: _RECENT_CELLS - 1]]
        return made

    def _made(
        self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float
    ) -> tuple[_Bounds, _Cell]:
        field = self._field
        shift_rad = lon_rad - float(field.grid.unwrapped(lon_rad))
        time, lat = field.axes[0].span(time_s), field.axes[-2].span(lat_rad)
        lon = field.axes[-1].span(lon_rad - shift_rad)
        height = _ANY_HEIGHT if field.height_m is None else field.axes[1].span(altitude_m)
        spans = (time, lat, lon) if field.height_m is None else (time, height, lat, lon)
        place = np.ix_(*((span.first, span.second) for span in spans))
        north, east, down = (
            () if values is None else _coefficients(values[place])
            for values in (field.north_mps, field.east_mps, field.down_mps)
        )
        bounds = (
            *(time.low, time.high, lat.low, lat.high),
            *(lon.low + shift_rad, lon.high + shift_rad, height.low, height.high),
        )
        return bounds, (time.inverse, lat.inverse, lon.inverse, height.inverse, north, east, down)


def _level(c: tuple[float, ...], t: float, y: float, x: float) -> float:
    """The polynomial whose first eight coefficients are given, at fractions of a cell."""
    return c[0] + c[1] * x + (c[2] + c[3] * x) * y + (c[4] + c[5] * x + (c[6] + c[7] * x) * y) * t


def _coefficients(corners: FieldArray) -> tuple[float, ...]:
    """Of 1, x, y, xy, t, tx, ty, txy, then those times z; from corners [time, (height,) north, east]."""
    if corners.ndim == 4:
        corners = np.moveaxis(corners, 1, 0)
    coefficients = corners.astype(np.float64)
    for axis in range(corners.ndim):  # from (value, next value) to (value, difference)
        coefficients = np.stack(
            (coefficients.take(0, axis), coefficients.take(1, axis) - coefficients.take(0, axis)), axis
        )
    return tuple(coefficients.ravel().tolist())
