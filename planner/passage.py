"""Straight passages between any two places on the grid, cell centres or not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner.air import Chart
from planner.grid import Grid
from planner.legs import Legs
from planner.windfield import Floats

Spot = tuple[float, float]
"""Row and column, whole at the centre of a cell."""

_ROUNDING = 1e-5  # of a cell: nearer to a line through the centres it is on it


def spot_at(chart: Chart, grid: Grid, lat_deg: float, lon_deg: float) -> Spot:
    """Where a position lies."""
    north_m, east_m = grid.frame.to_plane(np.radians(lat_deg), np.radians(lon_deg))
    row, column = _rows(chart, np.array([north_m])), _columns(chart, np.array([east_m]))
    return float(row[0]), float(column[0])


def lay_passage(chart: Chart, first: Spot, last: Spot, also: Sequence[float] = ()) -> Legs:
    """One straight leg between two places that are not the same, cut like those between cell centres.

    `also`: at these shares of its length, too.
    """
    (north_m, beyond_m), (east_m, right_m) = (
        np.interp(ends, np.arange(line_m.size), line_m).tolist()
        for ends, line_m in zip(zip(first, last, strict=True), (chart.north_m, chart.east_m), strict=True)
    )
    vector = complex(beyond_m - north_m, right_m - east_m)
    shares = [np.array([0.0, 1.0, *also])]
    for line_m, begin, end in zip(
        (chart.north_m, chart.east_m), (north_m, east_m), (beyond_m, right_m), strict=True
    ):
        crossed = line_m[(line_m > min(begin, end)) & (line_m < max(begin, end))]
        shares.append((crossed - begin) / (end - begin))
    ends = np.unique(np.concatenate(shares))
    share = np.empty(2 * ends.size - 1)
    share[::2], share[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    row = _rows(chart, north_m + share * vector.real)
    scale = np.interp(row, np.arange(chart.scale.size), chart.scale)
    return Legs(
        share[np.newaxis],
        row[np.newaxis],
        _columns(chart, east_m + share * vector.imag)[np.newaxis],
        (abs(vector) / scale)[np.newaxis],
        np.array([vector / abs(vector)]),
    )


def around(spot: Spot) -> list[tuple[int, int]]:
    """The cells whose wind is blended at a place: four, two on a line between centres, one at a centre."""
    rows, columns = ({int(np.floor(index)), int(np.ceil(index))} for index in spot)
    return [(row, column) for row in sorted(rows) for column in sorted(columns)]


def _rows(chart: Chart, north_m: Floats) -> Floats:
    return _on_lines(np.interp(north_m, chart.north_m, np.arange(chart.north_m.size)))


def _columns(chart: Chart, east_m: Floats) -> Floats:
    return _on_lines(np.interp(east_m, chart.east_m, np.arange(chart.east_m.size)))


def _on_lines(index: Floats) -> Floats:
    whole = np.rint(index)
    return np.where(np.abs(index - whole) < _ROUNDING, whole, index)
