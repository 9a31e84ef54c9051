"""Where the rows and columns of a weather file lie on the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.whereabouts import area_text
from sim.errors import WeatherError
from sim.weather.axes import Axes

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

_ROUNDING_DEG = 1e-9

Floats = NDArray[np.float64]
Places = NDArray[np.intp]

Bounds = tuple[float, float, float, float]
"""South, north, west and east [deg]; east is greater than west."""


class Window(NamedTuple):
    """Part of a ground: positions of rows and columns, and their longitudes counted to rise through it.

    On a curved ground `lat_deg` and `lon_deg` have two dimensions.
    """

    rows: Places
    columns: Places
    lat_deg: Floats
    lon_deg: Floats

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and of columns."""
        return self.rows.size, self.columns.size


@dataclass(frozen=True, eq=False)
class Ground:
    """Latitudes and longitudes of a variable.

    A regular ground has its latitudes sorted to rise, shape (rows,), and its longitudes likewise, shape
    (columns,); `row_order` and `column_order` say where they are in the file. A curved one has both of shape
    (rows, columns), as in the file. Longitudes have no jump, and the westernmost is from -180 to 180 [deg].
    """

    lat_deg: Floats
    lon_deg: Floats
    row_order: Places
    column_order: Places
    curved: bool
    x_rises: bool = True

    def places(self, window: Window) -> tuple[slice | Places, slice | Places]:
        """Where the rows and columns of a window are in the file."""
        return _run(self.row_order[window.rows]), _run(self.column_order[window.columns])

    def same_as(self, other: Ground) -> bool:
        """Whether another ground is the same to a thousandth of a degree."""
        if self.lat_deg.shape != other.lat_deg.shape or self.lon_deg.shape != other.lon_deg.shape:
            return False
        turned = self.lon_deg - other.lon_deg
        turned -= 360.0 * np.rint(turned / 360.0)
        return float(np.abs(self.lat_deg - other.lat_deg).max()) < 1e-3 and float(np.abs(turned).max()) < 1e-3

    def describe(self) -> str:
        """Size and area, for messages."""
        rows, columns = self.row_order.size, self.column_order.size
        area_deg = (self.lat_deg.min(), self.lat_deg.max(), self.lon_deg.min(), self.lon_deg.max())
        return f"{rows} x {columns} points from {area_text(*area_deg)}"

    def window(self, area_deg: Bounds | None, spare: int = 0) -> Window:
        """The rows and columns around an area, all without one; `spare` more on each side.

        Raises:
            WeatherError: if the area holds less than two rows or columns.
        """
        if area_deg is None:
            rows, columns = np.arange(self.row_order.size), np.arange(self.column_order.size)
            return Window(rows, columns, self.lat_deg, self.lon_deg)
        return self._curved_window(area_deg, spare) if self.curved else self._regular_window(area_deg)

    def _regular_window(self, area_deg: Bounds) -> Window:
        south, north, west, east = area_deg
        turned = _turned(self.lon_deg, west, east)
        order = np.argsort(turned, kind="stable")
        order = order[np.concatenate(([True], np.diff(turned[order]) > 1e-9))]
        rows = _around(self.lat_deg, south, north, "latitude")
        columns = _around(turned[order], west, east, "longitude")
        return Window(rows, order[columns], self.lat_deg[rows], turned[order][columns])

    def _curved_window(self, area_deg: Bounds, spare: int) -> Window:
        south, north, west, east = area_deg
        lon_deg = _turned(self.lon_deg, west, east)
        margin = spare * max(spacing_deg(self.lat_deg, lon_deg))
        widened = margin / math.cos(math.radians(min(max(abs(south), abs(north)), 89.0)))
        inside = (self.lat_deg > south - margin) & (self.lat_deg < north + margin)
        inside &= (lon_deg > west - widened) & (lon_deg < east + widened)
        rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
        if rows.size < 2 or columns.size < 2:
            raise WeatherError(
                f"it has {self.describe()}, and nothing in {area_text(*area_deg)}; choose an area inside"
            )
        rows, columns = np.arange(rows[0], rows[-1] + 1), np.arange(columns[0], columns[-1] + 1)
        part = np.ix_(rows, columns)
        return Window(rows, columns, self.lat_deg[part], lon_deg[part])


def find_ground(variable: xr.DataArray, axes: Axes) -> Ground:
    """The ground of a variable whose axes are known.

    Raises:
        WeatherError: if a latitude or longitude is no number.
    """
    lat_deg, lon_deg = (_angles_deg(variable[name], axes) for name in (axes.lat, axes.lon))
    if not axes.curved:
        lon_deg = _from_180_west(np.unwrap(lon_deg, period=360.0))  # 359, 0 becomes 359, 360
        rows, columns = np.argsort(lat_deg, kind="stable"), np.argsort(lon_deg, kind="stable")
        return Ground(lat_deg[rows], lon_deg[columns], rows, columns, curved=False)
    lon_deg = _from_180_west(np.unwrap(np.unwrap(lon_deg, period=360.0, axis=1), period=360.0, axis=0))
    rows, columns = (np.arange(size) for size in lat_deg.shape)
    return Ground(lat_deg, lon_deg, rows, columns, True, _rises(variable, axes.ground[1]))


def spacing_deg(lat_deg: Floats, lon_deg: Floats) -> tuple[float, float]:
    """The mean distance between neighbours along the rows and along the columns of a curved ground [deg]."""
    narrow = np.cos(np.radians(lat_deg))
    along = [
        float(
            np.median(
                np.hypot(np.diff(lat_deg, axis=axis), (np.diff(lon_deg, axis=axis)) * _middle(narrow, axis))
            )
        )
        for axis in (0, 1)
    ]
    return along[0], along[1]


def _middle(values: Floats, axis: int) -> Floats:
    return values[1:] if axis == 0 else values[:, 1:]


def _angles_deg(values: xr.DataArray, axes: Axes) -> Floats:
    alone = {str(dim): 0 for dim in values.dims if dim not in axes.ground}
    angles = np.asarray(
        values.isel(alone).transpose(*(d for d in axes.ground if d in values.dims)).values, float
    )
    if not np.isfinite(angles).all():
        raise WeatherError(
            f"{values.name} has values that are no numbers; give every row and column its place"
        )
    if values.attrs.get("units") in ("radian", "radians", "rad"):
        angles = np.degrees(angles)
    return angles


def _rises(variable: xr.DataArray, dim: str) -> bool:
    """Whether a map's coordinate rises along its dimension, as it does if nothing else is said."""
    if variable.attrs.get("GRIB_iScansNegatively") == 1:
        return False
    if dim not in variable.coords or variable[dim].ndim != 1 or variable[dim].size < 2:
        return True
    ends = np.asarray(variable[dim].values, dtype=np.float64)
    return bool(ends[-1] > ends[0])


def _from_180_west(lon_deg: Floats) -> Floats:
    """Longitudes without a jump, counted so that the westernmost lies from -180 to 180, as plans count."""
    return np.asarray(lon_deg - 360.0 * np.floor((lon_deg.min() + 180.0) / 360.0))


def _turned(lon_deg: Floats, west: float, east: float) -> Floats:
    return np.asarray(lon_deg - 360.0 * np.rint((lon_deg - (west + east) / 2.0) / 360.0))


def _around(nodes: Floats, low: float, high: float, what: str) -> Places:
    """From the last node below to the first one above."""
    first = max(int(np.searchsorted(nodes, low + _ROUNDING_DEG, side="right")) - 1, 0)
    end = int(np.searchsorted(nodes, high - _ROUNDING_DEG, side="left")) + 1
    rows = np.arange(first, min(end, nodes.size))
    if rows.size < 2 or low > nodes[-1] or high < nodes[0]:
        raise WeatherError(
            f"its {what} runs from {nodes[0]:.3f} to {nodes[-1]:.3f} and has less than two values from "
            f"{low:.3f} to {high:.3f} deg; choose an area inside"
        )
    return rows


def _run(places: Places) -> slice | Places:
    """A slice, which files read faster, where the places follow each other, in either direction."""
    steps = np.diff(places)
    if places.size > 1 and (steps == 1).all():
        return slice(int(places[0]), int(places[-1]) + 1)
    if places.size > 1 and (steps == -1).all():
        return slice(int(places[0]), int(places[-1]) - 1 if places[-1] else None, -1)
    return places
