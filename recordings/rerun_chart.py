"""The chart under the flight: its area on the plane and on the screen, graticule and scale bar.

Chart coordinates are kilometres in the plane of `planner.grid.LocalFrame`: east, and north. What draws them
in a plane whose second axis points down turns north over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid

Floats = NDArray[np.float64]
Bytes = NDArray[np.uint8]

_GRATICULE_STEPS_DEG = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0)
_NAME_PX = 62.0  # from one meridian to the next: the width of a name, and a gap
_BAR_LENGTHS_KM = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)

_VIEW_PX = (830.0, 612.0)
"""Room for the chart when the recording opens at 1600 x 900: to the right, and down."""

_MARGINS_PX = {"west": 236.0, "south": 33.0, "east": 26.0, "north": 38.0}
"""Of that, beside the picture: the legend and degrees, degrees, nothing, and the stage's name."""


class Extent(NamedTuple):
    """Edges in chart kilometres."""

    west: float
    south: float
    east: float
    north: float


class Parallel(NamedTuple):
    """A line of the graticule, from its west or south end to its east or north end, and its name."""

    name: str
    east_km: tuple[float, float]
    north_km: tuple[float, float]


@dataclass(frozen=True)
class Chart:
    """A flight's area in the plane of its grid's frame."""

    grid: Grid

    @cached_property
    def cell_km(self) -> float:
        """Side of the picture's square pixels: a grid cell from west to east."""
        return (self._edges.east - self._edges.west) / self.grid.columns

    @cached_property
    def extent(self) -> Extent:
        """Edges of the picture; it has whole pixels, so that it ends less than one south of the grid."""
        edges = self._edges
        return edges._replace(south=edges.north - self.cell_km * len(self._rows))

    @cached_property
    def shape(self) -> tuple[int, int]:
        """Pixels of the picture (down, east)."""
        return len(self._rows), self.grid.columns

    @cached_property
    def px_km(self) -> float:
        """Kilometres to a point on the screen, when the recording opens at 1600 x 900."""
        extent, (across_px, down_px) = self.extent, _VIEW_PX
        return max(
            (extent.east - extent.west) / (across_px - _MARGINS_PX["west"] - _MARGINS_PX["east"]),
            (extent.north - extent.south) / (down_px - _MARGINS_PX["south"] - _MARGINS_PX["north"]),
        )

    @cached_property
    def view(self) -> Extent:
        """Edges of what the view shows: the picture and its margins."""
        extent, px_km = self.extent, self.px_km
        return Extent(
            extent.west - _MARGINS_PX["west"] * px_km,
            extent.south - _MARGINS_PX["south"] * px_km,
            extent.east + _MARGINS_PX["east"] * px_km,
            extent.north + _MARGINS_PX["north"] * px_km,
        )

    def upright(self, cells: Bytes) -> Bytes:
        """What lies on the grid, [north, east, ...], as rows of square pixels, the northernmost first."""
        return np.ascontiguousarray(cells[self._rows])

    @cached_property
    def cells_km(self) -> tuple[Floats, Floats]:
        """Positions of the grid's columns, east, and of its rows, north."""
        grid = self.grid
        north_m, _ = grid.frame.to_plane(grid.lat_rad, np.full(grid.rows, grid.frame.origin_lon_rad))
        _, east_m = grid.frame.to_plane(np.full(grid.columns, grid.frame.origin_lat_rad), grid.lon_rad)
        return east_m / 1000.0, north_m / 1000.0

    def graticule(self) -> list[Parallel]:
        """Meridians and parallels at round degrees, as close as their names allow."""
        grid, frame, extent = self.grid, self.grid.frame, self.extent
        across_px = (extent.east - extent.west) / self.px_km
        px_deg = across_px / math.degrees(grid.east_step_rad * grid.columns)
        step_deg = _first_not_below(_GRATICULE_STEPS_DEG, _NAME_PX / px_deg)
        lines = []
        for lat_deg in _multiples(step_deg, grid.lat_rad):
            north_km = float(frame.to_plane(math.radians(lat_deg), frame.origin_lon_rad)[0]) / 1000.0
            name = f"{abs(lat_deg):g}°{'N' if lat_deg >= 0.0 else 'S'}"
            lines.append(Parallel(name, (extent.west, extent.east), (north_km, north_km)))
        for lon_deg in _multiples(step_deg, grid.lon_rad):
            east_km = float(frame.to_plane(frame.origin_lat_rad, math.radians(lon_deg))[1]) / 1000.0
            wrapped_deg = (lon_deg + 180.0) % 360.0 - 180.0
            name = f"{abs(wrapped_deg):g}°{'E' if wrapped_deg >= 0.0 else 'W'}"
            lines.append(Parallel(name, (east_km, east_km), (extent.south, extent.north)))
        return lines

    def scale_bar_km(self) -> float:
        """A round length of at most a seventh of the width; true at the chart's middle latitude."""
        return _last_not_above(_BAR_LENGTHS_KM, (self.extent.east - self.extent.west) / 7.0)

    def km(self, lat_deg: float, lon_deg: float) -> tuple[float, float]:
        """A geodetic position as (east_km, north_km)."""
        north_m, east_m = self.grid.frame.to_plane(math.radians(lat_deg), math.radians(lon_deg))
        return float(east_m) / 1000.0, float(north_m) / 1000.0

    @cached_property
    def _edges(self) -> Extent:
        grid, frame = self.grid, self.grid.frame
        half_north_rad, half_east_rad = grid.north_step_rad / 2.0, grid.east_step_rad / 2.0
        south_m, west_m = frame.to_plane(grid.lat_rad[0] - half_north_rad, grid.lon_rad[0] - half_east_rad)
        north_m, east_m = frame.to_plane(grid.lat_rad[-1] + half_north_rad, grid.lon_rad[-1] + half_east_rad)
        return Extent(*(float(edge_m) / 1000.0 for edge_m in (west_m, south_m, east_m, north_m)))

    @cached_property
    def _rows(self) -> NDArray[np.int64]:
        """For each row of pixels, from the north, the nearest row of the grid."""
        edges, frame = self._edges, self.grid.frame
        count = math.ceil((edges.north - edges.south) / self.cell_km - 1e-9)
        north_m = 1000.0 * (edges.north - self.cell_km * (np.arange(count) + 0.5))
        lat_rad, _ = frame.to_geodetic(north_m, np.zeros(count))
        rows = np.rint((lat_rad - self.grid.south_rad) / self.grid.north_step_rad)
        nearest: NDArray[np.int64] = np.clip(rows, 0, self.grid.rows - 1).astype(np.int64)
        return nearest


def _multiples(step_deg: float, angles_rad: Floats) -> list[float]:
    """The multiples of a step between the ends of an axis."""
    low, high = (math.degrees(float(angles_rad[i])) / step_deg for i in (0, -1))
    return [round(step_deg * i, 6) for i in range(math.ceil(low - 1e-9), math.floor(high + 1e-9) + 1)]


def _first_not_below(steps: tuple[float, ...], value: float) -> float:
    return next((step for step in steps if step >= value), steps[-1])


def _last_not_above(steps: tuple[float, ...], value: float) -> float:
    return next((step for step in reversed(steps) if step <= value), steps[0])
