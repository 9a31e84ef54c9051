"""The weather at the levels that a plan may choose among, and at the heights between them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from planner.closures import Closures, closures_at_levels
from planner.grid import Grid
from planner.windfield import Floats, WindField
from sim.errors import WeatherError
from sim.hazards.joining import JoinedHazard

ROOM_M = 20.0
"""Between a level and the lowest and highest wind that is known: aircraft dip and bob."""


@dataclass(frozen=True, slots=True, eq=False)
class WeatherLevels:
    """What the planner sees at its levels.

    `forecast`: on the planner's grid, its heights the levels and the heights of the weather between them.
    `also`: what is hazardous besides the mean wind, at each of these heights.
    """

    forecast: WindField
    also: tuple[JoinedHazard, ...] = ()

    @property
    def height_m(self) -> tuple[float, ...]:
        """Rising."""
        assert self.forecast.height_m is not None
        return tuple(self.forecast.height_m.tolist())

    @property
    def closures(self) -> Closures | None:
        """What is closed at each height, in tall sheets; None if nothing is."""
        closures = [also.planned for also in self.also if also.planned is not None]
        assert len(closures) in (0, len(self.height_m))  # the same tables at every height
        return closures_at_levels(closures) if closures else None


def at_levels(wind: WindField, levels_m: tuple[float, ...], grid: Grid, source: str) -> WeatherLevels:
    """The wind of files at levels, on the planner's grid.

    Args:
        wind: as read, at all of its heights.
        levels_m: rising.
        grid: the planner's.
        source: the files, for messages.

    Raises:
        WeatherError: if there is one height of wind alone, or a level lies outside those or near their ends.
    """
    own_m = wind.height_m
    if own_m is None or own_m.size == 1:
        raise WeatherError(
            f"{source} has wind at one level alone, which is taken to hold at every altitude, so "
            "mission.levels_m leaves nothing to choose; leave it out, or bring wind at several heights"
        )
    low_m, high_m = float(own_m[0]) + ROOM_M, float(own_m[-1]) - ROOM_M
    for level_m in levels_m:
        if not low_m <= level_m <= high_m:
            raise WeatherError(
                f"the level of {level_m:g} m does not lie within the wind of {source}, which is known from "
                f"{own_m[0]:.0f} to {own_m[-1]:.0f} m, {ROOM_M:g} m at either end being left to gusts; "
                f"choose mission.levels_m and mission.altitude_m from {low_m:.0f} to {high_m:.0f}"
            )
    between = own_m[(own_m > levels_m[0]) & (own_m < levels_m[-1])]
    return WeatherLevels(laid_out(wind, np.union1d(levels_m, between), grid))


def laid_out(wind: WindField, height_m: Floats, grid: Grid) -> WindField:
    """A field at other heights and on another grid."""
    sheets = [wind.level(at_m, grid) for at_m in height_m.tolist()]
    parts = [(sheet.north_mps, sheet.east_mps) for sheet in sheets]
    north_mps, east_mps = (np.stack(part, axis=1) for part in zip(*parts, strict=True))
    return replace(wind, grid=grid, height_m=height_m, north_mps=north_mps, east_mps=east_mps, down_mps=None)
