"""A part of one variable of weather files: what lies around the mission's area, time and altitude."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planner.closures import room_cells
from planner.grid import Grid
from planner.hazards import StageClock
from planner.windfield import Floats
from sim.errors import HazardError
from sim.weather.cube import Cube
from sim.weather.curved import Regridding, regridding
from sim.weather.files import Reading, window_of
from sim.weather.forecast import Forecast, open_forecast
from sim.weather.spans import Spans
from sim.weather.times import utc
from sim.weather.variables import Role

FieldArray = NDArray[np.float32] | NDArray[np.float64]

_ROUNDING_S = 1e-3


@dataclass(frozen=True, slots=True)
class Stages:
    """Where and when hazard is wanted.

    `corridor_m`: half width of the room that the aircraft needs. `passed_m`: the lowest and the highest that
    are flown at beside `altitude_m`, where levels are changed. `bridge_s`: how long a gap in the times of a
    file is bridged.
    """

    grid: Grid
    clock: StageClock
    altitude_m: float
    corridor_m: float
    passed_m: tuple[float, float] | None = None
    bridge_s: float = 3600.0

    @property
    def shape(self) -> tuple[int, int, int]:
        """Stages, rows and columns."""
        return self.clock.stage_count, *self.grid.shape

    @property
    def span_s(self) -> tuple[float, float]:
        """From departure to the end of the last stage [s since 1970-01-01 UTC]."""
        return self.clock.span_s(0)[0], self.clock.span_s(self.clock.stage_count - 1)[1]


@dataclass(frozen=True, eq=False)
class Field:
    """Values around a mission.

    Attributes:
        name: the variable and its file, for messages.
        unit: of the values.
        spans: when values hold, from the last before departure to the first after the end, shape (T,).
        values: shape (M, T, L, rows, columns), the one or two levels around the altitude; NaN in gaps.
        lat_deg: of the rows, rising; of a map projection's grid those of the way that leads off it.
        lon_deg: of the columns, likewise.
        way: from a map projection's grid to those latitudes and longitudes; None for a regular grid.
    """

    name: str
    unit: str
    spans: Spans
    values: FieldArray
    lat_deg: Floats
    lon_deg: Floats
    way: Regridding | None


def check_times(name: str, spans: Spans, begin_s: float, end_s: float) -> None:
    """Refuse what does not hold the whole mission.

    Raises:
        HazardError: naming both spans.
    """
    if spans.begin_s[0] > begin_s + _ROUNDING_S or spans.end_s[-1] < end_s - _ROUNDING_S:
        held = f"{utc(spans.begin_s[0])} to {utc(spans.end_s[-1])}"
        raise HazardError(
            f"{name} holds {held} UTC, but the mission takes {utc(begin_s)} "
            f"to {utc(end_s)}; change mission.departure or stages.count, or bring more"
        )


def read_field(paths: Sequence[Path], variable: str | None, stages: Stages) -> Field:
    """Read a variable around a mission.

    Args:
        paths: of the files of one forecast.
        variable: its name; None for the gust speed, of which there must be one.
        stages: the mission.

    Raises:
        WeatherError: if a file cannot be read or has no such variable.
            Or if it has gaps in the mission's time that are not to be bridged.
        HazardError: if it does not hold the mission's time or altitude.
    """
    with open_forecast(paths) as forecast:
        files = ", ".join(path.name for path in paths[:3])
        chosen = _gust(forecast, files) if variable is None else variable
        cube = forecast.cube(chosen)
        name = f"{chosen} of {files}"
        check_times(name, cube.spans, *stages.span_s)
        cube.spans.refuse_gaps(*stages.span_s, stages.bridge_s, name, "values")
        reading = Reading(area_rad=_area_rad(stages))
        window, times = window_of(cube.ground, reading), cube.spans.during(*stages.span_s)
        values = cube.read(window, times=times)[:, :, _levels(cube, stages.altitude_m, name)]
        way = regridding(window, _degrees(reading)) if cube.ground.curved else None
        return Field(
            name,
            str(cube.first.attrs.get("units", "")),
            cube.spans.part(times),
            values,
            window.lat_deg if way is None else way.lat_deg,
            window.lon_deg if way is None else way.lon_deg,
            way,
        )


def _gust(forecast: Forecast, files: str) -> str:
    gusts = [name for name, role in forecast.roles.items() if role is Role.GUST]
    if len(gusts) != 1:
        found = f"several ({', '.join(gusts)})" if gusts else f"none, but {forecast.seen}"
        raise HazardError(
            f"a gust speed is looked for in {files}, and there is {found}; name one with variable"
        )
    return gusts[0]


def _levels(cube: Cube, altitude_m: float, name: str) -> slice:
    """The level at the altitude, or those around it; one level alone holds at every altitude."""
    heights_m = cube.levels.height_m
    if cube.levels.values.size == 1:
        return slice(0, 1)
    if heights_m is None or not heights_m[0] <= altitude_m <= heights_m[-1]:
        raise HazardError(
            f"{name} is given at {cube.levels.describe()}, and the mission is flown at {altitude_m:.0f} m; "
            "change mission.altitude_m or levels_m, or bring a file with levels around it"
        )
    first = int(np.searchsorted(heights_m, altitude_m, side="right")) - 1
    return slice(first, int(np.searchsorted(heights_m, altitude_m, side="left")) + 1)


def _area_rad(stages: Stages) -> tuple[float, float, float, float]:
    """The planner's grid with the rooms of its outermost cells."""
    grid = stages.grid
    north, east = (float(reach.max()) for reach in room_cells(grid, stages.corridor_m))
    return (
        float(grid.lat_rad[0]) - north * grid.north_step_rad,
        float(grid.lat_rad[-1]) + north * grid.north_step_rad,
        float(grid.lon_rad[0]) - east * grid.east_step_rad,
        float(grid.lon_rad[-1]) + east * grid.east_step_rad,
    )


def _degrees(reading: Reading) -> tuple[float, float, float, float] | None:
    if reading.area_rad is None:
        return None
    south, north, west, east = (math.degrees(bound) for bound in reading.area_rad)
    return south, north, west, east
