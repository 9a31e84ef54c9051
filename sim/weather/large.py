"""Wind of weather files that are too large for memory, read where it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from planner.windfield import WindField
from sim.weather import lazy_wind
from sim.weather.components import STRONGEST_MPS, WindAxes, read_components
from sim.weather.forecast import WindCubes
from sim.weather.ground import Window
from sim.weather.spacing import is_even
from sim.weather.times import utc

_FLOAT32_BYTES = 4


def is_large(wind: WindCubes, window: Window, members: int) -> bool:
    """Whether a wind is better not read at once, and lies so that any part of it can be read alone.

    It cannot where it has to be laid on other latitudes, longitudes or heights.
    """
    components = 2 if wind.up is None else 3
    values = components * members * wind.first.time_s.size * wind.first.levels.values.size
    if values * window.rows.size * window.columns.size * _FLOAT32_BYTES <= lazy_wind.LARGE_BYTES:
        return False
    plain = not wind.first.ground.curved and wind.geopotential is None
    return plain and is_even(window.lat_deg) and is_even(window.lon_deg)


def large_wind(
    wind: WindCubes,
    window: Window,
    grid: Grid,
    *,
    members: Sequence[int],
    wind_axes: WindAxes | None,
    hold: bool,
) -> WindField:
    """The mean of the members' wind, unread but for one look at every sheet.

    Args:
        wind: of an open forecast; xarray opens its files anew when they are read later.
        window: of a regular ground.
        grid: the same as a grid.
        members: their numbers.
        wind_axes: see `read_components`.
        hold: see `WindField`.

    Raises:
        WeatherError: if a sheet has gaps, or a wind that blows nowhere.
    """
    cube = wind.first
    height_m = cube.levels.height_m if cube.levels.values.size > 1 else None

    def read(time: int, heights: slice, rows: slice, columns: slice) -> tuple[NDArray[np.float32], ...]:
        part = Window(
            window.rows[rows], window.columns[columns], window.lat_deg[rows], window.lon_deg[columns]
        )
        found = read_components(
            wind,
            part,
            members=members,
            times=slice(time, time + 1),
            levels=heights,
            wind_axes=wind_axes,
        )
        toward = (found.north_mps, found.east_mps, None if found.up_mps is None else -found.up_mps)
        return tuple(one[:, 0].mean(axis=0).astype(np.float32) for one in toward if one is not None)

    names = [wind.second.name, cube.name, "" if wind.up is None else wind.up.name]

    def refuse(component: int, time: int, sheet: NDArray[Any]) -> None:
        lazy_wind.refuse_unusable(names[component], utc(float(cube.time_s[time])), sheet, STRONGEST_MPS)

    count = 2 if wind.up is None else 3
    return lazy_wind.lazy_wind(read, count, grid, cube.time_s, height_m, refuse=refuse, hold=hold)
