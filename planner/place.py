"""A named position."""

from __future__ import annotations

import math
from dataclasses import dataclass

from planner.grid import Grid
from planner.ground import Cell


@dataclass(frozen=True, slots=True)
class Place:
    """A named position, geodetic WGS84 [deg]."""

    name: str
    lat_deg: float
    lon_deg: float

    def cell(self, grid: Grid, what: str) -> Cell:
        """The grid cell it lies in; raises OutsideGridError off the grid."""
        lat_rad, lon_rad = math.radians(self.lat_deg), math.radians(self.lon_deg)
        return grid.nearest_cell(lat_rad, lon_rad, f"{what} {self.name}")
