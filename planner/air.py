"""The air over the planner's cells, and the plane in which courses are drawn through it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from planner.hazards import StageClock
from planner.levels import Levels, stacked
from planner.windfield import Floats, WindField

Complex = NDArray[np.complex64]


@dataclass(frozen=True, eq=False)
class Air:
    """Wind on the cells at the times between which it is linear, for the whole horizon.

    `time_s`: since departure, rising, from 0 to the horizon's end, with every stage's two ends and every time
    of the field in between, shape (K,). `wind_mps`: north + i east, toward, shape [time, north, east], the
    sheets of several levels in a tall one (see `planner.levels`).
    """

    time_s: Floats
    wind_mps: Complex

    @classmethod
    def over(cls, wind: WindField, clock: StageClock) -> Air:
        """The air of a field on its own grid, at all of its heights."""
        horizon_s = clock.stage_count * clock.stage_s
        own_s = wind.time_s - clock.departure_s
        time_s = np.union1d(
            np.arange(clock.stage_count + 1) * clock.stage_s, own_s[(own_s > 0.0) & (own_s < horizon_s)]
        )
        levels = () if wind.height_m is None else wind.height_m.shape
        wind_mps = np.empty((time_s.size, *levels, *wind.grid.shape), dtype=np.complex64)
        for place, at_s in enumerate(time_s.tolist()):
            wind_mps[place].real, wind_mps[place].imag = wind.sheet(clock.departure_s + at_s)
        return cls(time_s, stacked(wind_mps, 0.0) if levels else wind_mps)


@dataclass(frozen=True, eq=False)
class Chart:
    """Rows and columns on the grid's Mercator plane, and the levels over it.

    `north_m`: of each row, shape (rows,). `east_m`: of each column, shape (columns,). `scale`: plane metres
    per true metre on each row, shape (rows,). `levels`: which a row of a tall sheet says, too.
    """

    north_m: Floats
    east_m: Floats
    scale: Floats
    levels: Levels

    @classmethod
    def of(cls, grid: Grid, levels: Levels | None = None) -> Chart:
        """The chart of a grid's cells, at one level unless there are more."""
        north_m = grid.frame.to_plane(grid.lat_rad, np.full(grid.rows, grid.lon_rad[0]))[0]
        east_m = grid.frame.to_plane(np.full(grid.columns, grid.lat_rad[0]), grid.lon_rad)[1]
        scale = np.array([grid.frame.scale(float(lat_rad)) for lat_rad in grid.lat_rad])
        return cls(np.asarray(north_m), np.asarray(east_m), scale, levels or Levels.one(0.0, grid.rows))
