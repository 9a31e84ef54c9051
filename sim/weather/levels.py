"""At which height values hold: levels above ground or sea, and surfaces of equal pressure."""

from __future__ import annotations

import re
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.weather.units import METRES, PASCALS

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

Floats = NDArray[np.float64]

_EARTH_RADIUS_M = 6356766.0  # of the standard atmosphere
_ABOVE_SEA = (
    "altitude",
    "height_above_mean_sea_level",
    "height_above_reference_ellipsoid",
    "height_above_geopotential_datum",
    "geopotential_height",
)
_PRESSURE_NAMES = ("isobaricInhPa", "isobaricInPa", "plev", "pressure", "pressure_level", "air_pressure")
_HEIGHT_NAMES = (
    "height",
    "heightAboveGround",
    "height_above_ground",
    "heightAboveSea",
    "altitude",
    "alt",
    "z",
)
_TALLEST_IN_A_NAME_M = 120.0  # u100 is 100 m above ground, u850 the surface of 850 hPa
_PLAIN_IN_GRIB = ("surface", "meanSea", "heightAboveGround", "heightAboveSea", "unknown", "undef")


class LevelKind(StrEnum):
    """What the levels of a variable count."""

    ABOVE_GROUND = "m above ground"
    ABOVE_SEA = "m above the sea"
    PRESSURE = "hPa"
    NONE = "one level of unknown height"
    OTHER = "levels that are neither heights nor pressures"


class Levels(NamedTuple):
    """The levels of a variable, as in its file: heights [m] or pressures [Pa], shape (L,)."""

    kind: LevelKind
    values: Floats

    @property
    def height_m(self) -> Floats | None:
        """Heights above the sea [m], falling pressure as the standard atmosphere has it; None if unknown."""
        if self.kind is LevelKind.PRESSURE:
            return standard_height_m(self.values)
        return self.values if self.kind in (LevelKind.ABOVE_GROUND, LevelKind.ABOVE_SEA) else None

    def describe(self) -> str:
        """The levels for people, such as "10, 100 m above ground"."""
        if self.kind in (LevelKind.NONE, LevelKind.OTHER):
            return str(self.kind)
        scale = 0.01 if self.kind is LevelKind.PRESSURE else 1.0
        return f"{', '.join(f'{scale * value:.6g}' for value in self.values)} {self.kind}"


def standard_height_m(pressure_pa: ArrayLike) -> Floats:
    """Geometric height of a pressure in the ICAO standard atmosphere (ISO 2533), to 20 km [m]."""
    ratio = np.asarray(pressure_pa, dtype=np.float64) / 101325.0
    tropopause = 0.223361
    low = 288.15 / 0.0065 * (1.0 - ratio**0.190263)
    high = 11000.0 + 6341.62 * np.log(tropopause / ratio)
    return geometric_m(np.where(ratio >= tropopause, low, high))


def geometric_m(geopotential_m: ArrayLike) -> Floats:
    """Height above the sea of a geopotential height, both [m]."""
    height = np.asarray(geopotential_m, dtype=np.float64)
    return _EARTH_RADIUS_M * height / (_EARTH_RADIUS_M - height)


def levels_of(axis: xr.DataArray | None, variable: xr.DataArray, name_m: float | None) -> Levels:
    """The levels of a variable from its vertical coordinate, else from its name ("u10": 10 m).

    Args:
        axis: the vertical coordinate, scalar or a row; None if there is none.
        variable: whose levels are wanted.
        name_m: the height [m] in the variable's name, if there is one.
    """
    if axis is not None:
        kind, unit = _kind(axis)
        values = (
            np.atleast_1d(np.asarray(axis.values, dtype=np.float64)) if kind is not LevelKind.OTHER else None
        )
        if values is not None and not (values.size == 1 and values[0] == 0.0):
            return Levels(kind, values * unit)
        if kind is LevelKind.OTHER and axis.ndim and axis.size > 1:
            return Levels(kind, np.arange(axis.size, dtype=np.float64))
    of_level = str(variable.attrs.get("GRIB_typeOfLevel", "unknown"))
    if of_level not in _PLAIN_IN_GRIB:
        return Levels(LevelKind.OTHER, np.zeros(1))
    if name_m is not None and name_m <= _TALLEST_IN_A_NAME_M:
        return Levels(LevelKind.ABOVE_GROUND, np.array([name_m]))
    return Levels(LevelKind.NONE, np.zeros(1))


def is_vertical(axis: xr.DataArray) -> bool:
    """Whether a coordinate is a height, a pressure or another vertical axis."""
    return _kind(axis)[0] is not LevelKind.OTHER or axis.attrs.get("axis") == "Z" or "positive" in axis.attrs


def _kind(axis: xr.DataArray) -> tuple[LevelKind, float]:
    """What a coordinate counts, and what turns it into metres or pascals."""
    standard_name, unit, name = axis.attrs.get("standard_name"), axis.attrs.get("units"), str(axis.name)
    pressure = standard_name == "air_pressure" or (standard_name is None and unit in PASCALS)
    if unit in PASCALS and (pressure or name in _PRESSURE_NAMES):
        return LevelKind.PRESSURE, PASCALS[unit]
    if name == "isobaricInhPa" and unit is None:
        return LevelKind.PRESSURE, 100.0
    if unit in METRES and standard_name in _ABOVE_SEA:
        return LevelKind.ABOVE_SEA, METRES[unit]
    named = standard_name is None and (name in _HEIGHT_NAMES or axis.attrs.get("positive") == "up")
    if unit in METRES and (standard_name == "height" or named):
        above_sea = name in ("heightAboveSea", "altitude", "alt")
        return LevelKind.ABOVE_SEA if above_sea else LevelKind.ABOVE_GROUND, METRES[unit]
    return LevelKind.OTHER, 1.0


def height_named(variable: xr.DataArray) -> float | None:
    """The metres in a name such as u10 or ugrd_80m, or in "10 metre wind gust"; None if there are none."""
    names = (str(variable.attrs.get("GRIB_shortName", "")), str(variable.name))
    found = [match for name in names if (match := re.fullmatch(r"[^\d]*?(\d+)[^\d]*", name))]
    said = re.search(r"\b(\d+)[ -]?met(?:re|er)s?\b", str(variable.attrs.get("long_name", "")))
    number = found[0] if found else said
    return float(number[1]) if number else None
