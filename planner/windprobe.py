"""The wind along one flight, read quickly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from planner.axis import EVERYWHERE, Span
from planner.corners import Corners, Place, Values

if TYPE_CHECKING:
    from planner.windfield import WindField


_KNOWN_CELLS = 64

_Bounds = tuple[float, float, float, float, float, float, float, float]
_Polynomial = tuple[float, ...]
_Cell = tuple[float, float, float, float, _Polynomial, _Polynomial, _Polynomial]
_Wind = tuple[float, float, float]
_Four = tuple[float, float, float, float]

_ANY_HEIGHT = Span(0, 0, -EVERYWHERE, EVERYWHERE, 0.0)


class WindProbe:
    """Reads the wind along a flight: quick while the aircraft stays in one cell and between two times.

    In a cell each component is a polynomial of degree one in each of the fractions along the axes. To find
    its coefficients pays from the second point in a cell on, so the first one's wind is the weighted mean of
    the corners. The coefficients are kept as plain numbers, those of other cells too: routes along the nodes
    of a grid lead from cell to cell and back all the time.
    """

    __slots__ = ("_bounds", "_cell", "_corners", "_field", "_known", "_mean", "_place", "_read")

    def __init__(self, field: WindField) -> None:
        self._field, self._corners = field, Corners(field)
        self._place, self._read = self._corners.place, self._corners.read
        self._mean = _mean_of_level if field.height_m is None else _mean
        self._bounds: _Bounds = (math.inf, -math.inf) * 4  # of no cell at all
        self._cell: _Cell
        self._known: dict[int, tuple[_Bounds, _Cell] | None] = {}

    def __call__(self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float = 0.0) -> _Wind:
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
            wind = self._entered(time_s, lat_rad, lon_rad, altitude_m)
            if wind:
                return wind
            t_low, _, y_low, _, x_low, _, z_low, _ = self._bounds
        t_inverse, y_inverse, x_inverse, z_inverse, north, east, down = self._cell
        t, y, x = (time_s - t_low) * t_inverse, (lat_rad - y_low) * y_inverse, (lon_rad - x_low) * x_inverse
        if not z_inverse:
            return _level(north, t, y, x), _level(east, t, y, x), _level(down, t, y, x) if down else 0.0
        z = (altitude_m - z_low) * z_inverse
        return (
            _between(north, t, y, x, z),
            _between(east, t, y, x, z),
            _between(down, t, y, x, z) if down else 0.0,
        )

    def _entered(self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float) -> _Wind | None:
        """The wind at the first point in a cell; at a later one None, with the cell's polynomials at hand."""
        place = self._place(time_s, lat_rad, lon_rad, altitude_m)
        if place is None:
            self._bounds, self._cell = self._on_the_fringe(time_s, lat_rad, lon_rad, altitude_m)
            return None
        first, known = place[0], self._known
        if first not in known:
            if len(known) == _KNOWN_CELLS:
                known.clear()
            known[first] = None
            return self._mean(place, self._read(first))
        cell = known[first]
        if cell is None or not cell[0][4] <= lon_rad <= cell[0][5]:  # counted from another turn
            spans = self._corners.spans(first)
            cell = _cell(spans, self._turns_rad(lon_rad), self._read(first))
            known[first] = cell
        self._bounds, self._cell = cell
        return None

    def _on_the_fringe(
        self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float
    ) -> tuple[_Bounds, _Cell]:
        """The same of what lies beyond the outermost nodes, or on the last ones."""
        turns_rad = self._turns_rad(lon_rad)
        query = [time_s, altitude_m, lat_rad, lon_rad - turns_rad]
        if self._field.height_m is None:
            del query[1]
        spans = tuple(axis.span(value) for axis, value in zip(self._field.axes, query, strict=True))
        return _cell(spans, turns_rad, self._corners.beside(spans))

    def _turns_rad(self, lon_rad: float) -> float:
        """The turns by which a longitude is counted differently from the field's, zero or 2 pi times them."""
        return lon_rad - float(self._field.grid.unwrapped(lon_rad))


def _cell(spans: Sequence[Span], turns_rad: float, corners: Sequence[Values]) -> tuple[_Bounds, _Cell]:
    """Bounds and polynomials of a cell from the values at its corners."""
    time, *between, lat, lon = spans
    height = between[0] if between else _ANY_HEIGHT
    polynomial = _polynomial if height.inverse else _polynomial_of_level
    north, east, down = (polynomial(values) if values else () for values in corners)
    bounds = (
        *(time.low, time.high, lat.low, lat.high),
        *(lon.low + turns_rad, lon.high + turns_rad, height.low, height.high),
    )
    return bounds, (time.inverse, lat.inverse, lon.inverse, height.inverse, north, east, down)


def _mean(place: Place, corners: tuple[Values, Values, Values]) -> _Wind:
    """The mean of sixteen corners, weighted by their nearness along each axis; written out, for speed."""
    _, t, y, x, z = place
    (a, b, c, d, e, f, g, h, i, j, k, m, n, o, p, q), east, down = corners
    aa, bb, cc, dd, ee, ff, gg, hh, ii, jj, kk, mm, nn, oo, pp, qq = east
    before, south, west, under = 1.0 - t, 1.0 - y, 1.0 - x, 1.0 - z
    sw, se, nw, ne = south * west, south * x, y * west, y * x
    first, second, third, fourth = before * under, before * z, t * under, t * z
    return (
        first * (sw * a + se * b + nw * c + ne * d)
        + second * (sw * e + se * f + nw * g + ne * h)
        + third * (sw * i + se * j + nw * k + ne * m)
        + fourth * (sw * n + se * o + nw * p + ne * q),
        first * (sw * aa + se * bb + nw * cc + ne * dd)
        + second * (sw * ee + se * ff + nw * gg + ne * hh)
        + third * (sw * ii + se * jj + nw * kk + ne * mm)
        + fourth * (sw * nn + se * oo + nw * pp + ne * qq),
        _mean(place, (down, down, ()))[0] if down else 0.0,
    )


def _mean_of_level(place: Place, corners: tuple[Values, Values, Values]) -> _Wind:
    """The same of eight, where wind is the same at every height."""
    (_, t, y, x, _), (north, east, down) = place, corners
    south, west = 1.0 - y, 1.0 - x
    in_plane = south * west, south * x, y * west, y * x
    return (
        _weighed_level(north, in_plane, t),
        _weighed_level(east, in_plane, t),
        _weighed_level(down, in_plane, t) if down else 0.0,
    )


def _weighed_level(corners: Values, in_plane: _Four, t: float) -> float:
    a, b, c, d, e, f, g, h = corners
    south_west, south_east, north_west, north_east = in_plane
    return (1.0 - t) * (south_west * a + south_east * b + north_west * c + north_east * d) + t * (
        south_west * e + south_east * f + north_west * g + north_east * h
    )


def _polynomial_of_level(corners: Values) -> _Polynomial:
    """Of 1, x, y, xy, t, tx, ty, txy, at the lower height: differences in time, then north, then east."""
    a, b, c, d, e, f, g, h = corners if len(corners) == 8 else (*corners[:4], *corners[8:12])
    at, bt, north, north_t = e - a, f - b, c - a, (g - c) - (e - a)
    return (
        a,
        b - a,
        north,
        (d - b) - north,
        at,
        bt - at,
        north_t,
        ((h - d) - bt) - north_t,
    )


def _polynomial(corners: Values) -> _Polynomial:
    """That of the lower height, then of what the upper one has more."""
    lower, upper = (*corners[:4], *corners[8:12]), (*corners[4:8], *corners[12:])
    more = tuple(high - low for low, high in zip(lower, upper, strict=True))
    return _polynomial_of_level(lower) + _polynomial_of_level(more)


def _level(polynomial: _Polynomial, t: float, y: float, x: float) -> float:
    """A polynomial of eight coefficients at fractions of a cell."""
    a, b, c, d, e, f, g, h = polynomial
    return a + b * x + (c + d * x) * y + (e + f * x + (g + h * x) * y) * t


def _between(polynomial: _Polynomial, t: float, y: float, x: float, z: float) -> float:
    """One of sixteen: `_level` of the first eight, and z times that of the others."""
    a, b, c, d, e, f, g, h, i, j, k, m, n, o, p, q = polynomial
    xy = x * y
    return (
        a
        + b * x
        + c * y
        + d * xy
        + (e + f * x + g * y + h * xy) * t
        + z * (i + j * x + k * y + m * xy + (n + o * x + p * y + q * xy) * t)
    )
