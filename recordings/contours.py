"""Lines where a quantity on a grid reaches a level, as whole curves, and such lines cut into dashes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from contourpy import contour_generator
from numpy.typing import NDArray

from recordings.recorder import WeatherSheet

Floats = NDArray[np.float64]


def hazard_edges(
    sheet: WeatherSheet, threshold_mps: float, east_km: Floats, north_km: Floats
) -> list[Floats]:
    """Where the strongest wind of a stage crosses the threshold, and around cells closed for another reason.

    Where only cells are known, it is their edges.

    Args:
        sheet: the weather.
        threshold_mps: wind speed above which a cell is hazardous.
        east_km: position of each column of its grid, shape (columns,).
        north_km: of each row, shape (rows,).

    Returns:
        Curves of two or more points (east_km, north_km) each; closed ones end where they begin.
    """
    if sheet.peak_mps is None:
        return level_lines(sheet.hazard.astype(np.float64), 0.5, east_km, north_km)
    edges = level_lines(sheet.peak_mps, threshold_mps, east_km, north_km)
    if sheet.closed is not None:
        edges += level_lines(sheet.closed.astype(np.float64), 0.5, east_km, north_km)
    return edges


def level_lines(
    values: NDArray[np.floating], level: float, east_km: Floats, north_km: Floats
) -> list[Floats]:
    """Where values, linear along the lines of a grid, reach a level (marching squares).

    A grid of a single row or column has none.
    """
    if min(values.shape) < 2:
        return []
    lines = contour_generator(east_km, north_km, values, name="serial").lines(level)
    return [np.asarray(line, np.float64) for line in lines if len(line) > 1]


def dashed(lines: Iterable[Floats], dash_km: float) -> list[Floats]:
    """Lines cut into dashes with gaps as long between them, the first and last dash of a line cut short."""
    dashes = []
    for line in lines:
        along_km = np.append(0.0, np.cumsum(np.hypot(*np.diff(line, axis=0).T)))
        for begin_km in np.arange(0.0, along_km[-1], 2.0 * dash_km):
            end_km = min(begin_km + dash_km, along_km[-1])
            inner = line[(along_km > begin_km) & (along_km < end_km)]
            ends = [[np.interp(at_km, along_km, axis) for axis in line.T] for at_km in (begin_km, end_km)]
            dashes.append(np.vstack([ends[0], inner, ends[1]]))
    return dashes
