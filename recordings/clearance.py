"""How near a flight came to hazardous cells, in true metres, and when it was in closed ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pyproj
from numpy.typing import NDArray
from scipy.spatial import KDTree

from planner.grid import geodesic_m
from recordings.recording import HazardSheet

Floats = NDArray[np.float64]

_EVERY = 20  # samples from one that is looked at anyway to the next
_GEOCENTRIC = pyproj.Transformer.from_pipeline("+proj=cart +ellps=WGS84")


class Clearance(NamedTuple):
    """The nearest approach to a hazardous cell's centre, and the sample at which it was."""

    distance_m: float
    sample: int


def nearest_approach(
    sheets: Sequence[HazardSheet], time_s: Floats, lat_rad: Floats, lon_rad: Floats
) -> Clearance | None:
    """The smallest distance from a flight to a cell that is hazardous at the time; None if none ever is.

    Args:
        sheets: rising in time; each holds until the next, the last to the end.
        time_s: of the samples, rising, none before the first sheet.
        lat_rad: geodetic, shape (samples,).
        lon_rad: geodetic, shape (samples,).
    """
    bounds = np.searchsorted(time_s, [sheet.time_s for sheet in sheets[1:]])
    found = None
    for sheet, begin, end in zip(sheets, [0, *bounds], [*bounds, len(time_s)], strict=True):
        if begin == end or not sheet.hazard.any():
            continue
        rows, columns = np.nonzero(sheet.hazard)
        cell_lat_rad, cell_lon_rad = sheet.grid.lat_rad[rows], sheet.grid.lon_rad[columns]
        sample, cell = _nearest(
            _geocentric_m(cell_lat_rad, cell_lon_rad), _geocentric_m(lat_rad[begin:end], lon_rad[begin:end])
        )
        sample += int(begin)
        distance_m = float(
            geodesic_m(lat_rad[sample], lon_rad[sample], cell_lat_rad[cell], cell_lon_rad[cell])
        )
        if found is None or distance_m < found.distance_m:
            found = Clearance(distance_m, sample)
    return found


def clearances_m(sheets: Sequence[HazardSheet], time_s: Floats, lat_rad: Floats, lon_rad: Floats) -> Floats:
    """The distance of every sample to the nearest cell that is hazardous then; arguments as above.

    Infinite where no cell is. The nearest is found by chords, which are shorter than the way over the ground
    by less than a metre in 100 km, and measured by the geodesic.
    """
    distances_m = np.full(len(time_s), np.inf)
    bounds = np.searchsorted(time_s, [sheet.time_s for sheet in sheets[1:]])
    for sheet, begin, end in zip(sheets, [0, *bounds], [*bounds, len(time_s)], strict=True):
        if begin == end or not sheet.hazard.any():
            continue
        rows, columns = np.nonzero(sheet.hazard)
        cell_lat_rad, cell_lon_rad = sheet.grid.lat_rad[rows], sheet.grid.lon_rad[columns]
        here = slice(begin, end)
        _, nearest = KDTree(_geocentric_m(cell_lat_rad, cell_lon_rad)).query(
            _geocentric_m(lat_rad[here], lon_rad[here])
        )
        distances_m[here] = geodesic_m(
            lat_rad[here], lon_rad[here], cell_lat_rad[nearest], cell_lon_rad[nearest]
        )
    return distances_m


def in_closed_cells(
    sheets: Sequence[HazardSheet], time_s: Floats, lat_rad: Floats, lon_rad: Floats
) -> NDArray[np.bool_]:
    """Which samples lie in a cell that is hazardous at the time for another reason than the mean wind.

    Args:
        sheets: rising in time; each holds until the next, the last to the end.
        time_s: of the samples, rising, none before the first sheet.
        lat_rad: geodetic, shape (samples,).
        lon_rad: geodetic, shape (samples,).
    """
    inside = np.zeros(len(time_s), dtype=np.bool_)
    bounds = np.searchsorted(time_s, [sheet.time_s for sheet in sheets[1:]])
    for sheet, begin, end in zip(sheets, [0, *bounds], [*bounds, len(time_s)], strict=True):
        if begin == end or sheet.closed is None:
            continue
        rows, columns = (
            np.rint(index) for index in sheet.grid.indices(lat_rad[begin:end], lon_rad[begin:end])
        )
        on_grid = (rows >= 0) & (rows < sheet.grid.rows) & (columns >= 0) & (columns < sheet.grid.columns)
        cells = rows[on_grid].astype(np.intp), columns[on_grid].astype(np.intp)
        inside[begin:end][on_grid] = sheet.closed[cells]
    return inside


def _geocentric_m(lat_rad: Floats, lon_rad: Floats) -> Floats:
    """Positions on the ellipsoid as geocentric x, y, z: the nearest there is the nearest on the ground."""
    points = _GEOCENTRIC.transform(lon_rad, lat_rad, np.zeros_like(lat_rad), radians=True)
    return np.stack(points, axis=-1)


def _nearest(cells: Floats, samples: Floats) -> tuple[int, int]:
    """The (sample, cell) that are nearest to each other.

    Every twentieth sample is looked up first. The distance of those between is less by no more than the way
    flown since, so few of them are left to look up.
    """
    tree = KDTree(cells)
    looked_up = np.arange(0, len(samples), _EVERY)
    distances_m, _ = map(np.asarray, tree.query(samples[looked_up]))
    steps_m = np.linalg.norm(np.diff(samples, axis=0, prepend=samples[:1]), axis=1)
    flown_m = np.cumsum(steps_m)
    since = np.arange(len(samples)) // _EVERY
    at_least_m = distances_m[since] - (flown_m - flown_m[looked_up[since]])
    near = np.flatnonzero(at_least_m <= distances_m.min())
    distances_m, nearest = map(np.asarray, tree.query(samples[near]))
    best = int(np.argmin(distances_m))
    return int(near[best]), int(nearest[best])
