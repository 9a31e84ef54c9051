"""The chart under the flight: weather as a picture on equal Mercator spacing, graticule and scale bar.

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
Bools = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

_CALM_BANDS_MPS = (5.0, 10.0, 15.0, 20.0, 25.0)
_CALM_COLOURS = ((15, 21, 33), (18, 27, 43), (22, 33, 53), (26, 40, 64), (30, 47, 75), (34, 54, 86))
_HAZARD_BANDS_MPS = (17.5, 25.0, 33.0, 43.0)
_HAZARD_COLOURS = ((104, 28, 33), (136, 36, 33), (168, 46, 32), (200, 62, 32), (232, 88, 38))
_FORECAST_EDGE_COLOUR = (244, 132, 95)
_GRATICULE_STEPS_DEG = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0)
_BAR_LENGTHS_KM = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)


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

    def picture(self, hazard: Bools, forecast_hazard: Bools, speed_mps: NDArray[np.float32]) -> Bytes:
        """Colours of the weather: hazard in reds, other wind in blues, the edge of the forecast's hazard.

        Args:
            hazard: the true hazard, [north, east] on the grid.
            forecast_hazard: what the planner saw, of the same shape.
            speed_mps: true wind speed, of the same shape.

        Returns:
            Red, green and blue, shape (down, east, 3), the northernmost row first.
        """
        calm = np.array(_CALM_COLOURS, np.uint8)[np.digitize(speed_mps, _CALM_BANDS_MPS)]
        bad = np.array(_HAZARD_COLOURS, np.uint8)[np.digitize(speed_mps, _HAZARD_BANDS_MPS)]
        colours = np.where(hazard[..., None], bad, calm)
        colours[_edge(forecast_hazard)] = _FORECAST_EDGE_COLOUR
        return np.ascontiguousarray(colours[self._rows])

    def graticule(self) -> list[Parallel]:
        """Meridians and parallels at round degrees, four or more of each."""
        grid, frame, extent = self.grid, self.grid.frame, self.extent
        height_deg = math.degrees(grid.north_step_rad * grid.rows)
        width_deg = math.degrees(grid.east_step_rad * grid.columns)
        step_deg = _last_not_above(_GRATICULE_STEPS_DEG, min(height_deg, width_deg) / 4.0)
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


def _edge(inside: Bools) -> Bools:
    """The cells inside that touch one outside."""
    kept = np.pad(inside, 1, mode="edge")
    core = kept[:-2, 1:-1] & kept[2:, 1:-1] & kept[1:-1, :-2] & kept[1:-1, 2:]
    return inside & ~core


def _multiples(step_deg: float, angles_rad: Floats) -> list[float]:
    """The multiples of a step between the ends of an axis."""
    low, high = (math.degrees(float(angles_rad[i])) / step_deg for i in (0, -1))
    return [round(step_deg * i, 6) for i in range(math.ceil(low - 1e-9), math.floor(high + 1e-9) + 1)]


def _last_not_above(steps: tuple[float, ...], value: float) -> float:
    return next((step for step in reversed(steps) if step <= value), steps[0])
