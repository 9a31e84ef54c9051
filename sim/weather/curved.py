"""Wind on the grid of a map projection: turned to east and north, and laid on latitudes and longitudes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial import KDTree

from planner.whereabouts import place_text
from sim.errors import WeatherError
from sim.weather.ground import Bounds, Window, spacing_deg

Floats = NDArray[np.float64]
FieldArray = NDArray[np.float32] | NDArray[np.float64]

_ROUNDS = 12
_NEAR_CELLS = 1e-3


def east_and_north(
    along_x: FieldArray, along_y: FieldArray, window: Window, *, x_rises: bool
) -> tuple[FieldArray, FieldArray]:
    """Components along a map's axes turned to east and north, shapes (..., rows, columns).

    The x axis runs along the rows; how it lies is taken from the positions of the points, so no projection
    has to be known. The y axis is 90 deg to its left, as on every conformal map and on a rotated globe.

    Args:
        along_x: component along the rows.
        along_y: component across them.
        window: the points.
        x_rises: whether x rises from the first column to the last.
    """
    narrow = np.cos(np.radians(window.lat_deg))
    order: Literal[1, 2] = 2 if window.columns.size > 2 else 1
    east: Floats = np.gradient(window.lon_deg, axis=1, edge_order=order) * narrow
    north: Floats = np.asarray(np.gradient(window.lat_deg, axis=1, edge_order=order), dtype=np.float64)
    length = np.hypot(east, north) * (1.0 if x_rises else -1.0)
    cosine, sine = (part / length for part in (east, north))
    eastward, northward = along_x * cosine - along_y * sine, along_x * sine + along_y * cosine
    if along_x.dtype == np.float32:
        return eastward.astype(np.float32), northward.astype(np.float32)
    return eastward.astype(np.float64), northward.astype(np.float64)


@dataclass(frozen=True, eq=False)
class Regridding:
    """From a curved ground to evenly spaced latitudes and longitudes, bilinear between the curved points.

    Attributes:
        lat_deg: of the new rows, rising, shape (R,).
        lon_deg: of the new columns, rising, shape (C,).
        row: where each new point lies among the old rows, fractional, shape (R, C).
        column: likewise among the old columns.
    """

    lat_deg: Floats
    lon_deg: Floats
    row: Floats
    column: Floats

    def of(self, values: FieldArray) -> FieldArray:
        """Values (..., rows, columns) of the old points on the new ones, (..., R, C)."""
        rows, columns = values.shape[-2:]
        south = np.clip(self.row.astype(np.intp), 0, rows - 2)
        west = np.clip(self.column.astype(np.intp), 0, columns - 2)
        up, right = self.row - south, self.column - west
        result = np.empty((*values.shape[:-2], *self.row.shape), dtype=values.dtype)
        for place in np.ndindex(values.shape[:-2]):  # sheet by sheet, which takes little memory
            sheet = values[place].astype(np.float64)
            low = (1.0 - right) * sheet[south, west] + right * sheet[south, west + 1]
            high = (1.0 - right) * sheet[south + 1, west] + right * sheet[south + 1, west + 1]
            result[place] = (1.0 - up) * low + up * high
        return result


def regridding(window: Window, area_deg: Bounds | None) -> Regridding:
    """The way from a window of a curved ground to a regular grid of about the same spacing.

    Args:
        window: the curved points.
        area_deg: what the regular grid is to cover; without it, that between the ground's four edges.

    Raises:
        WeatherError: if the area reaches outside the ground, or no rectangle fits between its edges.
    """
    south, north, west, east = area_deg or _between_edges(window)
    step = min(spacing_deg(window.lat_deg, window.lon_deg))
    widest = step / math.cos(math.radians((south + north) / 2.0))
    lat_deg = np.linspace(south, north, max(math.ceil((north - south) / step), 1) + 1)
    lon_deg = np.linspace(west, east, max(math.ceil((east - west) / widest), 1) + 1)
    row, column = _positions(window, lat_deg, lon_deg, step)
    if np.isnan(row).any():
        first = np.argwhere(np.isnan(row))[0]
        raise WeatherError(
            f"its grid does not reach {place_text(lat_deg[first[0]], lon_deg[first[1]], 3)}; "
            "choose an area inside, in [grid]"
        )
    return Regridding(lat_deg, lon_deg, row, column)


def _positions(window: Window, lat_deg: Floats, lon_deg: Floats, step: float) -> tuple[Floats, Floats]:
    """Fractional rows and columns of new points among the old ones, NaN outside, by Newton's method.

    It starts at the nearest old point and solves for where bilinear latitude and longitude are those wanted.
    """
    scale = math.cos(math.radians(float(lat_deg.mean())))
    old = np.stack([window.lat_deg, window.lon_deg * scale])
    wanted = np.stack([part.ravel() for part in np.meshgrid(lat_deg, lon_deg * scale, indexing="ij")])
    nearest = KDTree(old.reshape(2, -1).T).query(wanted.T)[1]
    place = np.array(np.unravel_index(nearest, window.lat_deg.shape), dtype=np.float64)
    slopes = [[np.gradient(part, axis=axis) for axis in (0, 1)] for part in old]
    last = np.array(window.lat_deg.shape, dtype=np.float64)[:, np.newaxis] - 1.0
    for _ in range(_ROUNDS):
        off = wanted - np.stack([map_coordinates(part, place, order=1, mode="nearest") for part in old])
        (a, b), (c, d) = (
            [map_coordinates(slope, place, order=1, mode="nearest") for slope in pair] for pair in slopes
        )
        determinant = a * d - b * c
        moves = np.stack([d * off[0] - b * off[1], a * off[1] - c * off[0]]) / determinant
        place = np.clip(place + np.nan_to_num(moves), 0.0, last)
    off = wanted - np.stack([map_coordinates(part, place, order=1, mode="nearest") for part in old])
    place[:, np.hypot(*off) > _NEAR_CELLS * step] = np.nan
    shape = lat_deg.size, lon_deg.size
    return place[0].reshape(shape), place[1].reshape(shape)


def _between_edges(window: Window) -> Bounds:
    """The latitudes and longitudes between the southern and northern, western and eastern edges."""
    lat_deg, lon_deg = window.lat_deg, window.lon_deg
    if abs(lat_deg[-1].mean() - lat_deg[0].mean()) < abs(lat_deg[:, -1].mean() - lat_deg[:, 0].mean()):
        lat_deg, lon_deg = lat_deg.T, lon_deg.T  # a map that lies on its side
    rows, columns = (
        sorted((lat_deg[0], lat_deg[-1]), key=np.mean),
        sorted((lon_deg[:, 0], lon_deg[:, -1]), key=np.mean),
    )
    south, north = float(rows[0].max()), float(rows[1].min())
    west, east = float(columns[0].max()), float(columns[1].min())
    if not (south < north and west < east):
        raise WeatherError(
            "its grid lies so that no rectangle of latitudes and longitudes fits between its edges; "
            "give the mission's area in [grid]"
        )
    return south, north, west, east
