"""Hazard that lies in the cells of another grid, brought to the planner's: no source cell is ever lost.

Bilinear or nearest-neighbour resampling can lose a hazardous source cell, or a part of it. Here a cell of the
planner's grid is hazardous if any source cell is that its room touches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.closures import room_cells
from planner.grid import Grid
from planner.hazards import Bools, StageClock
from planner.windfield import Floats
from sim.errors import HazardError
from sim.hazards.field import check_times
from sim.weather.spans import Spans

_ROUNDING_CELLS = 1e-6  # what two cells may overlap by rounding where they only share an edge


@dataclass(frozen=True, slots=True, eq=False)
class SourceCells:
    """Cells of a regular grid at a series of times.

    Attributes:
        name: what they are of, for messages.
        spans: when each holds, shape (T,).
        lat_deg: of the centres, rising, shape (rows,).
        lon_deg: likewise, without a jump, shape (columns,).
        hazard: shape (T, rows, columns).
    """

    name: str
    spans: Spans
    lat_deg: Floats
    lon_deg: Floats
    hazard: Bools

    def on(self, grid: Grid, clock: StageClock, *, corridor_m: float) -> Bools:
        """The planner's cells whose room touches a source cell that is hazardous in a stage.

        In a stage count all moments within it, the last one before and the first one after, since what holds
        in between may be that of either; or all windows that it has a part of.

        Args:
            grid: the planner's.
            clock: the stages.
            corridor_m: half width of the room that the aircraft needs [m]; 0 for the cells alone.

        Returns:
            Shape [stage, north, east].

        Raises:
            HazardError: if the source does not hold the grid's area or the stages' times.
        """
        last = clock.stage_count - 1
        check_times(self.name, self.spans, clock.span_s(0)[0], clock.span_s(last)[1])
        spans = [self.spans.during(*clock.span_s(stage)) for stage in range(clock.stage_count)]
        rectangles = self._rectangles(grid, corridor_m)
        held = [np.asarray(self.hazard[span].any(axis=0)) for span in spans]
        return np.stack([_any_in(hazard, *rectangles) for hazard in held])

    def _rectangles(
        self, grid: Grid, corridor_m: float
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
        """First and past-the-last source row, shape (rows, 1), and column, shape (rows, columns)."""
        north, east = (reach[:, np.newaxis] - _ROUNDING_CELLS for reach in room_cells(grid, corridor_m))
        lat_deg, lon_deg = np.degrees(grid.lat_rad)[:, np.newaxis], np.degrees(grid.lon_rad)
        lat_edges, lon_edges = edges(self.lat_deg), edges(self.lon_deg)
        lon_deg = lon_deg + 360.0 * np.rint((lon_edges.mean() - lon_deg.mean()) / 360.0)
        self._check_area(lat_deg, lon_deg, lat_edges, lon_edges)
        half_lat = north * math.degrees(grid.north_step_rad)
        half_lon = east * math.degrees(grid.east_step_rad)
        return (
            np.maximum(np.searchsorted(lat_edges, lat_deg - half_lat, side="right") - 1, 0),
            np.minimum(np.searchsorted(lat_edges, lat_deg + half_lat, side="left"), self.lat_deg.size),
            np.maximum(np.searchsorted(lon_edges, lon_deg - half_lon, side="right") - 1, 0),
            np.minimum(np.searchsorted(lon_edges, lon_deg + half_lon, side="left"), self.lon_deg.size),
        )

    def _check_area(self, lat_deg: Floats, lon_deg: Floats, lat_edges: Floats, lon_edges: Floats) -> None:
        for what, nodes, own in (("latitude", lat_deg, lat_edges), ("longitude", lon_deg, lon_edges)):
            if nodes.min() < own[0] - 1e-9 or nodes.max() > own[-1] + 1e-9:
                raise HazardError(
                    f"{self.name} reaches from {own[0]:.3f} to {own[-1]:.3f} deg of {what}, but the "
                    f"mission's grid from {nodes.min():.3f} to {nodes.max():.3f}; choose a smaller area in "
                    "[grid], or bring more"
                )


def edges(centres: Floats) -> Floats:
    """The edges of cells: half way between centres, and as far beyond the outermost; shape (n + 1,)."""
    middles = (centres[1:] + centres[:-1]) / 2.0
    first, last = 2.0 * centres[0] - middles[0], 2.0 * centres[-1] - middles[-1]
    return np.concatenate(([first], middles, [last]))


def _any_in(
    hazard: Bools,
    south: NDArray[np.intp],
    north: NDArray[np.intp],
    west: NDArray[np.intp],
    east: NDArray[np.intp],
) -> Bools:
    """Whether any cell of each rectangle of the source is hazardous, by sums over areas."""
    sums = np.zeros((hazard.shape[0] + 1, hazard.shape[1] + 1), dtype=np.int64)
    sums[1:, 1:] = hazard.cumsum(axis=0).cumsum(axis=1)
    counts = sums[north, east] - sums[south, east] - sums[north, west] + sums[south, west]
    return np.asarray(counts > 0)
