"""Wind of files too large for memory: looked through once, sheet by sheet, then read where asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from planner.tiled import Read, TiledArray, Tiles
from planner.windfield import FieldArray, Floats, WindField
from sim.errors import WeatherError

LARGE_BYTES = 512_000_000
"""Of all components as they lie in memory; smaller fields are read at once."""


def lazy_wind(
    read: Read,
    components: int,
    grid: Grid,
    time_s: Floats,
    height_m: Floats | None,
    *,
    refuse: Callable[[int, int, NDArray[Any]], None],
    hold: bool = False,
) -> WindField:
    """A field that is read when it is asked for.

    Args:
        read: (time, heights, rows, columns) -> north, east and, if there is one, down [m/s, toward], float32,
            each of shape [height, north, east], also without heights.
        components: how many it gives.
        grid: of all of it.
        time_s: rising, shape (T,) [s since 1970-01-01 UTC].
        height_m: rising, shape (H,); None for wind that is the same at every height.
        refuse: (component, time, sheet) -> None; raises WeatherError where a sheet cannot be used. Each is
            looked at once, so that nothing bad comes to light in flight.
        hold: see `WindField`.

    Raises:
        WeatherError: from `refuse`.
    """
    heights = 1 if height_m is None else len(height_m)
    for time in range(len(time_s)):
        for height in range(heights):
            one = slice(height, height + 1)
            sheets = read(time, one, slice(0, grid.rows), slice(0, grid.columns))
            for component, sheet in enumerate(sheets):
                refuse(component, time, sheet)
    tiles = Tiles(read, (len(time_s), heights, grid.rows, grid.columns))
    parts = [
        cast(FieldArray, TiledArray(tiles, component, flat=height_m is None))
        for component in range(components)
    ]
    return WindField(grid, time_s, parts[0], parts[1], height_m, parts[2] if components > 2 else None, hold)


def refuse_unusable(name: str, when: str, sheet: NDArray[Any], strongest_mps: float) -> None:
    """Raise a WeatherError if a sheet of wind has gaps, or a wind that blows nowhere."""
    gaps = int(np.count_nonzero(~np.isfinite(sheet)))
    if gaps:
        raise WeatherError(
            f"the wind {name} has {gaps} gaps (NaN or fill values) among {sheet.size} values at {when}; "
            "fill them or choose an area without"
        )
    fastest_mps = float(np.abs(sheet).max())
    if fastest_mps > strongest_mps:
        raise WeatherError(
            f"{name} has a wind of {fastest_mps:.3g} m/s at {when}, which blows nowhere on Earth (limit "
            f"{strongest_mps:.0f} m/s); if it marks missing values, declare it as _FillValue"
        )
