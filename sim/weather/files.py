"""Wind, and whatever else weather files hold, on a regular grid: what the rest of galeway reads of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.errors import PlannerError
from planner.grid import Grid
from planner.windfield import WindField
from sim.errors import WeatherError
from sim.weather.components import Components, WindAxes, on_common_heights, read_components
from sim.weather.curved import Regridding, regridding
from sim.weather.forecast import LevelChoice, WindCubes, open_forecast
from sim.weather.ground import Ground, Window
from sim.weather.large import is_large, large_wind
from sim.weather.levels import Levels
from sim.weather.spacing import evenly_spaced
from sim.weather.spans import Spans
from sim.weather.times import utc

Floats = NDArray[np.float64]
FieldArray = NDArray[np.float32] | NDArray[np.float64]

Bounds = tuple[float, float, float, float]
MEAN: Literal["mean"] = "mean"
_SPARE_CELLS = 2


@dataclass(frozen=True, slots=True)
class Reading:
    """How files are to be read where they leave a choice.

    Attributes:
        variables: names of the eastward and the northward wind, where there are several.
        levels: "height" or "pressure", where there are both.
        wind_axes: "earth" or "grid": what the components on a map's grid lie along, where it does not say.
        area_rad: south, north, west and east bound [rad] of the part to read, east beyond west; it grows to
            whole cells. Without it all is read.
    """

    variables: tuple[str, str] | None = None
    levels: LevelChoice | None = None
    wind_axes: WindAxes | None = None
    area_rad: Bounds | None = None


class MemberWinds(NamedTuple):
    """The wind of an ensemble [m/s, toward]; arrays (M, T, R, C), or (M, T, H, R, C) with heights.

    Attributes:
        grid: the cell centres.
        time_s: rising, shape (T,) [s since 1970-01-01 UTC].
        height_m: rising, above the sea, shape (H,); None for one level.
        numbers: of the members, shape (M,).
        north_mps: toward north.
        east_mps: toward east.
        up_mps: upward, None for none.
    """

    grid: Grid
    time_s: Floats
    height_m: Floats | None
    numbers: tuple[int, ...]
    north_mps: FieldArray
    east_mps: FieldArray
    up_mps: FieldArray | None


class MemberValues(NamedTuple):
    """Any variable of a forecast, such as gust or rain; `values` (M, T, L, R, C) in the unit `unit`.

    `time_s`: as in the files. `spans`: when the values of those hold.
    """

    name: str
    grid: Grid
    time_s: Floats
    spans: Spans
    levels: Levels
    numbers: tuple[int, ...]
    values: FieldArray
    unit: str


def read_wind(
    paths: Path | Sequence[Path],
    *,
    reading: Reading = Reading(),
    member: int | Literal["mean"] = MEAN,
    hold: bool = False,
) -> WindField:
    """Read the wind of one forecast on its own grid, in its own precision.

    Components are found by CF standard name, GRIB short name or usual name, or made of speed and direction;
    upward wind is taken along if it lies on the same axes. Levels become heights above the sea: heights above
    ground are taken for such, which holds over water; pressures by the forecast's geopotential, else by the
    standard atmosphere. Wind at one level holds at every height. Latitudes or longitudes whose steps differ
    by up to a quarter (Mercator, Gaussian grids), and grids of other map projections, are interpolated
    linearly to even ones. What is too large for memory is looked through once and read where it is asked for,
    if it needs no such interpolation.

    Args:
        paths: of the forecast's files.
        reading: what to take where there is a choice.
        member: number of an ensemble's member, or "mean" of all.
        hold: see `WindField`.

    Raises:
        WeatherError: naming file, variable, value and remedy, if anything of that cannot be done, or the part
            that is read has gaps.
    """
    with open_forecast(_listed(paths)) as forecast, _explained():
        wind = forecast.wind(reading.variables, reading.levels)
        numbers = wind.first.members
        if member != MEAN and member not in numbers:
            there = f"{numbers[0]} to {numbers[-1]}" if len(numbers) > 1 else str(numbers[0])
            raise WeatherError(f'it has the members {there}, not {member}; choose one, or "mean"')
        wanted = numbers if member == MEAN else (int(member),)
        window = window_of(wind.first.ground, reading)
        if is_large(wind, window, len(wanted)):
            grid, axes = _grid(window.lat_deg, window.lon_deg), reading.wind_axes
            return large_wind(wind, window, grid, members=wanted, wind_axes=axes, hold=hold)
        found = _members(wind, reading, wanted)
        north_mps, east_mps = _mean(found.north_mps), _mean(found.east_mps)
        down_mps = None if found.up_mps is None else -_mean(found.up_mps)
        return WindField(found.grid, found.time_s, north_mps, east_mps, found.height_m, down_mps, hold)


def read_members(paths: Path | Sequence[Path], *, reading: Reading = Reading()) -> MemberWinds:
    """Read the wind of all members of an ensemble; see `read_wind`.

    Raises:
        WeatherError: as `read_wind` does.
    """
    with open_forecast(_listed(paths)) as forecast, _explained():
        wind = forecast.wind(reading.variables, reading.levels)
        return _members(wind, reading, wind.first.members)


def read_values(
    paths: Path | Sequence[Path],
    name: str,
    *,
    reading: Reading = Reading(),
) -> MemberValues:
    """Read any variable by its name, for all members, in its own unit; NaN stays where files have gaps.

    Raises:
        WeatherError: if there is no such variable, or its axes make no sense.
    """
    with open_forecast(_listed(paths)) as forecast, _explained():
        cube = forecast.cube(name, reading.levels)
        window = window_of(cube.ground, reading)
        values, lat_deg, lon_deg = _laid(cube.ground, window, reading, [cube.read(window)])
        unit = str(cube.first.attrs.get("units", ""))
        grid = _grid(lat_deg, lon_deg)
        return MemberValues(name, grid, cube.time_s, cube.spans, cube.levels, cube.members, values[0], unit)


def _listed(paths: Path | Sequence[Path]) -> tuple[Path, ...]:
    return (paths,) if isinstance(paths, Path) else tuple(paths)


def _mean(members: FieldArray) -> FieldArray:
    """Over the members, without a copy of a single one."""
    mean: FieldArray = members[0] if members.shape[0] == 1 else members.mean(axis=0)
    return mean


@contextmanager
def _explained() -> Iterator[None]:
    """Turns the planner's errors on grids and fields into those of weather files."""
    try:
        yield
    except PlannerError as error:
        raise WeatherError(str(error)) from error


def window_of(ground: Ground, reading: Reading) -> Window:
    """The part of a ground that is to be read.

    Raises:
        WeatherError: if the area holds less than two rows or columns.
    """
    return ground.window(_degrees(reading.area_rad), _SPARE_CELLS)


def _degrees(area_rad: Bounds | None) -> Bounds | None:
    if area_rad is None:
        return None
    south, north, west, east = (math.degrees(bound) for bound in area_rad)
    return south, north, west, east


def _members(wind: WindCubes, reading: Reading, numbers: Sequence[int]) -> MemberWinds:
    cube = wind.first
    window = window_of(cube.ground, reading)
    components = read_components(wind, window, members=numbers, wind_axes=reading.wind_axes)
    height_m = cube.levels.height_m
    if not cube.ground.curved:
        _refuse_gaps(wind, components, window.lat_deg, window.lon_deg, numbers)
    if components.height_m is not None:
        components, height_m = on_common_heights(components)
    parts = [part for part in components[:3] if part is not None]
    parts, lat_deg, lon_deg = _laid(cube.ground, window, reading, parts)
    components = Components(parts[0], parts[1], parts[2] if len(parts) > 2 else None, None)
    _refuse_gaps(wind, components, lat_deg, lon_deg, numbers)
    if cube.levels.values.size == 1:
        height_m = None
        parts = [part[:, :, 0] for part in parts]
    return MemberWinds(
        _grid(lat_deg, lon_deg),
        cube.time_s,
        height_m,
        tuple(numbers),
        parts[1],
        parts[0],
        parts[2] if len(parts) > 2 else None,
    )


def _laid(
    ground: Ground, window: Window, reading: Reading, parts: list[FieldArray]
) -> tuple[list[FieldArray], Floats, Floats]:
    """Values on evenly spaced latitudes and longitudes, and those [deg]."""
    if ground.curved:
        way: Regridding = regridding(window, _degrees(reading.area_rad))
        return [way.of(part) for part in parts], way.lat_deg, way.lon_deg
    parts, lat_deg = evenly_spaced(parts, window.lat_deg, axis=-2, name="latitude")
    parts, lon_deg = evenly_spaced(parts, window.lon_deg, axis=-1, name="longitude")
    return parts, lat_deg, lon_deg


def _grid(lat_deg: Floats, lon_deg: Floats) -> Grid:
    ends = (math.radians(value) for value in (lat_deg[0], lat_deg[-1], lon_deg[0], lon_deg[-1]))
    return Grid.covering(*ends, rows=lat_deg.size, columns=lon_deg.size)


def _refuse_gaps(
    wind: WindCubes, components: Components, lat_deg: Floats, lon_deg: Floats, numbers: Sequence[int]
) -> None:
    cubes = (wind.first, wind.second, wind.up, wind.geopotential)
    names = ["" if cube is None else cube.name for cube in cubes]
    for name, values in zip(names, components, strict=True):
        gaps = None if values is None else np.isnan(values)
        if gaps is None or not gaps.any():
            continue
        member, time, level, row, column = np.unravel_index(int(np.argmax(gaps)), gaps.shape)
        at = [f"member {numbers[int(member)]}"] if len(numbers) > 1 else []
        at.append(f"time {utc(float(wind.first.time_s[time]))}")
        if wind.first.levels.values.size > 1:
            one = Levels(wind.first.levels.kind, wind.first.levels.values[level : level + 1])
            at.append(f"level {one.describe()}")
        at += [f"lat {lat_deg[row]:.6g}", f"lon {lon_deg[column]:.6g}"]
        raise WeatherError(
            f"the wind {name} has {np.count_nonzero(gaps)} gaps (NaN or fill values) among {gaps.size} "
            "values, the "
            f"first at {', '.join(at)}; fill them, or choose an area without in [grid]"
        )
