"""The wind of a forecast as components toward east, north and up [m/s], whatever its files hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.errors import WeatherError
from sim.weather.cube import Cube
from sim.weather.curved import east_and_north
from sim.weather.forecast import WindCubes
from sim.weather.ground import Window
from sim.weather.levels import geometric_m
from sim.weather.units import GEOPOTENTIAL_METRES, METRES_PER_SECOND, RADIANS, factor
from sim.weather.variables import Role

FieldArray = NDArray[np.float32] | NDArray[np.float64]
Floats = NDArray[np.float64]
WindAxes = Literal["earth", "grid"]

STRONGEST_MPS = 150.0
"""A component of wind beyond any that was measured, tornadoes included."""

_DIRECTIONS = (Role.FROM, Role.TOWARD)


class Components(NamedTuple):
    """Wind toward east, north and up, and the height of its levels; each (M, T, L, rows, columns) or None."""

    east_mps: FieldArray
    north_mps: FieldArray
    up_mps: FieldArray | None
    height_m: FieldArray | None


def read_components(
    wind: WindCubes,
    window: Window,
    *,
    members: Sequence[int] | None = None,
    times: slice = slice(None),
    levels: slice = slice(None),
    wind_axes: WindAxes | None = None,
) -> Components:
    """Read a part of a wind; NaN where its files have gaps.

    Args:
        wind: of a forecast.
        window: rows and columns.
        members: numbers of the ensemble's members; all by default.
        times: which of the times; all by default.
        levels: which of the levels, from the lowest up; all by default.
        wind_axes: along which axes the components lie, where a file on a map's grid does not say.

    Raises:
        WeatherError: if a unit is unknown, a file breaks off, or nobody knows along which axes the
            components of a map's grid lie.
    """

    def read(cube: Cube, scale: float) -> FieldArray:
        values = cube.read(window, members=members, times=times, levels=levels)
        return values if scale == 1.0 else np.asarray(values * values.dtype.type(scale))

    first = read(wind.first, factor(wind.first.first, METRES_PER_SECOND, "wind"))
    if wind.roles[1] in _DIRECTIONS:
        angle_rad = read(wind.second, factor(wind.second.first, RADIANS, "wind direction"))
        backward = -1.0 if wind.roles[1] is Role.FROM else 1.0
        east, north = backward * first * np.sin(angle_rad), backward * first * np.cos(angle_rad)
    else:
        second = read(wind.second, factor(wind.second.first, METRES_PER_SECOND, "wind"))
        east, north = first, second
        if wind.first.ground.curved and _along_grid(wind, wind_axes):
            east, north = east_and_north(first, second, window, x_rises=wind.first.ground.x_rises)
    up = None
    if wind.up is not None:
        up = read(wind.up, factor(wind.up.first, METRES_PER_SECOND, "wind"))
    height_m = None
    if wind.geopotential is not None:
        height_m = read(
            wind.geopotential, factor(wind.geopotential.first, GEOPOTENTIAL_METRES, "geopotential")
        )
        height_m = np.asarray(geometric_m(height_m))
    return Components(east, north, up, height_m)


def _along_grid(wind: WindCubes, wind_axes: WindAxes | None) -> bool:
    """Whether the components of a wind on a map's grid lie along that grid."""
    if wind_axes is not None:
        return wind_axes == "grid"
    if wind.roles == (Role.GRID_X, Role.GRID_Y):
        return True
    said = wind.first.first.attrs
    if said.get("standard_name") == "eastward_wind" or "GRIB_uvRelativeToGrid" in said:
        return False
    raise WeatherError(
        f"the winds {wind.first.name} and {wind.second.name} lie on a map's grid, and do not say whether "
        'they are components along its axes or to east and north; say weather.wind_axes = "grid" or "earth" '
        "(--wind-axes of `galeway weather`), or give them standard names (x_wind and y_wind, or "
        "eastward_wind and northward_wind)"
    )


def on_common_heights(components: Components) -> tuple[Components, Floats]:
    """A wind on surfaces of equal pressure, whose height differs from place to place, on level heights.

    The heights are the surfaces' means over members, times and places. In each column the wind is linear in
    height; above and below its outermost surfaces the outermost value holds.

    Args:
        components: with heights, (M, T, L, rows, columns), rising along L.

    Returns:
        The wind on the heights, and those, rising, shape (L,) [m].
    """
    assert components.height_m is not None
    surfaces = np.asarray(components.height_m, dtype=np.float64)
    common_m = surfaces.mean(axis=(0, 1, 3, 4))
    levels = common_m.size
    if levels == 1:
        return components, common_m
    parts = [part for part in components[:3] if part is not None]
    moved = [np.empty_like(part) for part in parts]
    for level, height_m in enumerate(common_m):
        below = np.clip((surfaces <= height_m).sum(axis=2, keepdims=True) - 1, 0, levels - 2)
        low, high = (np.take_along_axis(surfaces, below + step, axis=2)[:, :, 0] for step in (0, 1))
        weight = np.clip((height_m - low) / (high - low), 0.0, 1.0)
        for part, result in zip(parts, moved, strict=True):
            under, over = (np.take_along_axis(part, below + step, axis=2)[:, :, 0] for step in (0, 1))
            result[:, :, level] = (1.0 - weight) * under + weight * over
    up = moved[2] if components.up_mps is not None else None
    return Components(moved[0], moved[1], up, None), common_m
