"""Cells, geodetic positions and local metres: the three ways galeway says where something is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pyproj
from numpy.typing import NDArray

from planner.errors import OutsideGridError
from planner.whereabouts import area_text, place_text

Floats = NDArray[np.float64]

_GEOD = pyproj.Geod(ellps="WGS84")
_ECCENTRICITY_SQUARED = float(_GEOD.es)
_ECCENTRICITY = math.sqrt(_ECCENTRICITY_SQUARED)
_SEMI_MAJOR_AXIS_M = float(_GEOD.a)
_TURN_RAD = 2.0 * math.pi
_POLE_RAD = math.pi / 2.0 + 1e-9


class LocalFrame:
    """The plane in which paths are drawn: north and east metres on an ellipsoidal Mercator map.

    Mercator, because north is up everywhere, so that wind, course and heading need no rotation, parallels
    and meridians are straight lines, and angles are true. Its metres are stretched by `scale(lat_rad)`:
    true metres = plane metres / scale. The origin is at (`origin_lat_rad`, `origin_lon_rad`), where the
    scale is one.
    """

    def __init__(self, origin_lat_rad: float, origin_lon_rad: float) -> None:
        if not abs(origin_lat_rad) < math.radians(80.0):
            raise OutsideGridError(
                f"the latitude {math.degrees(origin_lat_rad):.2f} deg is too near a pole for a flight "
                "on a Mercator plane; stay within 80 deg north and south"
            )
        self.origin_lat_rad = origin_lat_rad
        self.origin_lon_rad = origin_lon_rad
        self._origin_parallel = _parallel_radius_ratio(origin_lat_rad)
        self._radius_m = _SEMI_MAJOR_AXIS_M * self._origin_parallel
        self._projection = pyproj.Proj(
            proj="merc",
            lat_ts=math.degrees(origin_lat_rad),
            lon_0=math.degrees(origin_lon_rad),
            ellps="WGS84",
        )
        self._origin_north_m = float(self._projection(origin_lon_rad, origin_lat_rad, radians=True)[1])

    def to_plane(self, lat_rad: Any, lon_rad: Any) -> tuple[Any, Any]:
        """Geodetic position to plane (north_m, east_m); scalars or arrays of one shape."""
        east_m, north_m = self._projection(lon_rad, lat_rad, radians=True)
        return north_m - self._origin_north_m, east_m

    def plane_point(self, lat_rad: float, lon_rad: float) -> tuple[float, float, float]:
        """One position's plane (north_m, east_m) and the scale there, in a fifth of the time of `to_plane`.

        The Mercator projection of the ellipsoid: Snyder, *Map Projections, a Working Manual* (1987),
        equations 7-6 and 7-7, in the form with hyperbolic functions.
        """
        sine, cosine = math.sin(lat_rad), math.cos(lat_rad)
        stretched = math.asinh(sine / cosine) - _ECCENTRICITY * math.atanh(_ECCENTRICITY * sine)
        return (
            self._radius_m * stretched - self._origin_north_m,
            self._radius_m * math.remainder(lon_rad - self.origin_lon_rad, _TURN_RAD),
            self._origin_parallel * math.sqrt(1.0 - _ECCENTRICITY_SQUARED * sine * sine) / cosine,
        )

    def to_geodetic(self, north_m: Any, east_m: Any) -> tuple[Any, Any]:
        """Plane position to geodetic (lat_rad, lon_rad); scalars or arrays of one shape."""
        lon_rad, lat_rad = self._projection(
            east_m, north_m + self._origin_north_m, inverse=True, radians=True
        )
        return lat_rad, lon_rad

    def scale(self, lat_rad: float) -> float:
        """Plane metres per true metre at a latitude."""
        return self._origin_parallel / _parallel_radius_ratio(lat_rad)


def _parallel_radius_ratio(lat_rad: float) -> float:
    """Radius of the parallel at a latitude, over the semi-major axis."""
    sine = math.sin(lat_rad)
    return math.cos(lat_rad) / math.sqrt(1.0 - _ECCENTRICITY_SQUARED * sine * sine)


@dataclass(frozen=True)
class Grid:
    """Cell centres on a regular latitude-longitude grid; row 0 is the southernmost, column 0 the westernmost.

    `west_rad` and the longitudes that follow from it rise without a break, also across the date line.
    """

    south_rad: float
    west_rad: float
    north_step_rad: float
    east_step_rad: float
    rows: int
    columns: int

    def __post_init__(self) -> None:
        if self.rows < 1 or self.columns < 1:
            raise OutsideGridError(f"a grid needs at least one cell, not {self.rows} x {self.columns}")
        for name, step_rad in (("north", self.north_step_rad), ("east", self.east_step_rad)):
            if not 0.0 < step_rad < math.inf:
                raise OutsideGridError(f"the {name} step of a grid must be positive, not {step_rad} rad")
        north_rad = self.south_rad + self.north_step_rad * (self.rows - 1)
        if not (self.south_rad >= -_POLE_RAD and north_rad <= _POLE_RAD and math.isfinite(self.west_rad)):
            raise OutsideGridError(
                f"a grid from {math.degrees(self.south_rad):.2f} to {math.degrees(north_rad):.2f} deg north, "
                f"west edge {math.degrees(self.west_rad):.2f} deg, does not lie on the Earth; give angles in "
                "radians and stay between the poles"
            )

    @classmethod
    def covering(
        cls,
        south_rad: float,
        north_rad: float,
        west_rad: float,
        east_rad: float,
        *,
        rows: int,
        columns: int,
    ) -> Grid:
        """The grid whose outermost cell centres lie on the four bounds [rad].

        `east_rad` is greater than `west_rad`: across the date line write 179 to 181 deg, not 179 to -179.

        Raises:
            OutsideGridError: if the bounds are in the wrong order or there are fewer than 2 x 2 cells.
        """
        if rows < 2 or columns < 2:
            raise OutsideGridError(f"bounds need at least 2 x 2 cells between them, not {rows} x {columns}")
        return cls(
            south_rad,
            west_rad,
            (north_rad - south_rad) / (rows - 1),
            (east_rad - west_rad) / (columns - 1),
            rows,
            columns,
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Rows (northward) and columns (eastward)."""
        return self.rows, self.columns

    @cached_property
    def lat_rad(self) -> Floats:
        """Latitude of each row, shape (rows,) [rad]."""
        return self.south_rad + self.north_step_rad * np.arange(self.rows, dtype=np.float64)

    @cached_property
    def lon_rad(self) -> Floats:
        """Longitude of each column, shape (columns,) [rad]."""
        return self.west_rad + self.east_step_rad * np.arange(self.columns, dtype=np.float64)

    @cached_property
    def frame(self) -> LocalFrame:
        """The local plane whose origin is the middle of the grid."""
        return LocalFrame(
            float(self.lat_rad[0] + self.lat_rad[-1]) / 2.0, float(self.lon_rad[0] + self.lon_rad[-1]) / 2.0
        )

    @cached_property
    def north_cell_m(self) -> Floats:
        """True distance from a row to the next one north, shape (rows,) [m]: meridian radius times step."""
        lat_rad = self.lat_rad + self.north_step_rad / 2.0
        squared = 1.0 - _ECCENTRICITY_SQUARED * np.sin(lat_rad) ** 2
        return _SEMI_MAJOR_AXIS_M * (1.0 - _ECCENTRICITY_SQUARED) / squared**1.5 * self.north_step_rad

    @cached_property
    def east_cell_m(self) -> Floats:
        """True distance from a column to the next one along each row, shape (rows,) [m]."""
        ratio = np.cos(self.lat_rad) / np.sqrt(1.0 - _ECCENTRICITY_SQUARED * np.sin(self.lat_rad) ** 2)
        return _SEMI_MAJOR_AXIS_M * ratio * self.east_step_rad

    def unwrapped(self, lon_rad: Any) -> Any:
        """A longitude, scalar or array, moved by whole turns to where it is nearest the grid's middle."""
        middle_rad = self.west_rad + self.east_step_rad * (self.columns - 1) / 2.0
        return lon_rad + _TURN_RAD * np.rint((middle_rad - lon_rad) / _TURN_RAD)

    def indices(self, lat_rad: Any, lon_rad: Any) -> tuple[Any, Any]:
        """Fractional (row, column) of positions, scalars or arrays; they may lie outside the grid.

        Longitude may be off by turns.
        """
        lon_rad = self.unwrapped(lon_rad)
        return (lat_rad - self.south_rad) / self.north_step_rad, (
            lon_rad - self.west_rad
        ) / self.east_step_rad

    def nearest_cell(self, lat_rad: float, lon_rad: float, what: str = "position") -> tuple[int, int]:
        """The cell whose centre is nearest.

        Raises:
            OutsideGridError: if the position is more than half a cell outside; `what` names it.
        """
        row, column = self.indices(lat_rad, lon_rad)
        if not (-0.5 <= row <= self.rows - 0.5 and -0.5 <= column <= self.columns - 0.5):
            raise OutsideGridError(
                f"the {what} at {place_text(math.degrees(lat_rad), math.degrees(lon_rad), 3)} lies off the "
                f"grid, which covers {self.describe()}; move it inside or widen the weather's area"
            )
        return min(round(row), self.rows - 1), min(round(column), self.columns - 1)

    def describe(self) -> str:
        """The area, for messages."""
        south, north = math.degrees(self.lat_rad[0]), math.degrees(self.lat_rad[-1])
        west, east = math.degrees(self.lon_rad[0]), math.degrees(self.lon_rad[-1])
        return area_text(south, north, west, east)


def geodesic_m(lat_1_rad: Any, lon_1_rad: Any, lat_2_rad: Any, lon_2_rad: Any) -> Any:
    """Length of the WGS84 geodesic between two positions [m]; scalars or arrays of one shape."""
    return _GEOD.inv(lon_1_rad, lat_1_rad, lon_2_rad, lat_2_rad, radians=True)[2]
