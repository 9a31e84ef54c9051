"""The weather of a scenario: the forecast on the planner's grid, and the wind as it is."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from planner.grid import Grid
from planner.windfield import WindField
from sim.errors import WeatherError
from sim.scenario import GridTable, LoadedScenario, Scenario
from sim.weather.best_track import HURRICANE_IAN, BestTrackFix
from sim.weather.files import read_wind
from sim.weather.vortex import vortex_field

STORMS: dict[str, tuple[BestTrackFix, ...]] = {"AL092022": HURRICANE_IAN}
"""Best tracks that ship with galeway, by HURDAT2 id."""

SHEET_INTERVAL_S = 1800.0
"""Between two times of a storm's wind field: a storm moves less than its radius of maximum wind in it."""

MOST_CELLS = 2_000_000
"""Cells of the planner's grid: nine times those of the paper, about 2 GB in a search of 540 steps."""

POLAR_LIMIT_RAD = math.radians(80.0)

STRONGEST_MPS = 150.0
"""A component of wind beyond any that was measured, tornadoes included."""

LATE_S = 3600.0
"""Wind kept beyond the planner's horizon, for a flight that is late."""


@dataclass(frozen=True, slots=True)
class MissionWeather:
    """What the planner sees and what the aircraft flies through.

    `forecast`: without heights, at the mission's altitude, on the planner's grid. `truth`: as it is.
    """

    forecast: WindField
    truth: WindField


def bring_weather(loaded: LoadedScenario) -> MissionWeather:
    """Make or read the wind that a scenario names.

    Raises:
        WeatherError: if there is no such storm or file, or it does not hold the mission's area and time.
    """
    scenario = loaded.scenario
    if scenario.weather.file is not None:
        truth = read_wind(
            loaded.folder / scenario.weather.file,
            variables=scenario.weather.variables,
            area_rad=_bounds_rad(scenario.grid),
        )
        _check_time(truth, scenario, scenario.weather.file)
        _check_speed(truth, scenario.weather.file)
        grid = refined_grid(truth.grid, scenario.grid, scenario.weather.file)
        forecast = truth.at_altitude(scenario.mission.altitude_m).resampled(grid)
        return MissionWeather(forecast, _strengthened(truth, scenario.weather.truth.speed_factor))
    forecast = _storm(scenario)
    return MissionWeather(forecast, _strengthened(forecast, scenario.weather.truth.speed_factor))


def _strengthened(wind: WindField, factor: float) -> WindField:
    """The same wind, so many times as strong."""
    if factor == 1.0:
        return wind
    down_mps = None if wind.down_mps is None else factor * wind.down_mps
    return replace(
        wind, north_mps=factor * wind.north_mps, east_mps=factor * wind.east_mps, down_mps=down_mps
    )


def _storm(scenario: Scenario) -> WindField:
    storm = scenario.weather.storm or ""
    if storm not in STORMS:
        raise WeatherError(f"no storm {storm!r} ships with galeway; there are {', '.join(sorted(STORMS))}")
    begin_s = scenario.mission.departure_s
    end_s = min(begin_s + _horizon_s(scenario) + LATE_S, STORMS[storm][-1].time_s)
    count = max(math.ceil((end_s - begin_s) / SHEET_INTERVAL_S), 1) + 1
    return vortex_field(STORMS[storm], _area_grid(scenario.grid), np.linspace(begin_s, end_s, count))


def _horizon_s(scenario: Scenario) -> float:
    stages = scenario.stages
    return stages.count * stages.steps * stages.step_s


def _bounds_rad(table: GridTable) -> tuple[float, float, float, float] | None:
    """South, north, west, east (beyond half a turn if across the date line), or None if not given."""
    if table.south_deg is None or table.north_deg is None or table.west_deg is None or table.east_deg is None:
        return None
    turn_deg = 360.0 if table.east_deg <= table.west_deg else 0.0
    return (
        math.radians(table.south_deg),
        math.radians(table.north_deg),
        math.radians(table.west_deg),
        math.radians(table.east_deg + turn_deg),
    )


def _area_grid(table: GridTable) -> Grid:
    """The grid over the scenario's own area, its cells as near to `cell_m` as whole numbers allow."""
    bounds_rad = _bounds_rad(table)
    assert bounds_rad is not None  # the scenario has checked that a storm comes with an area
    coarse = Grid.covering(*bounds_rad, rows=3, columns=3)
    rows = round(2 * float(coarse.north_cell_m[1]) / table.cell_m) + 1
    columns = round(2 * float(coarse.east_cell_m[1]) / table.cell_m) + 1
    _check_cells(rows, columns)
    return Grid.covering(*bounds_rad, rows=max(rows, 2), columns=max(columns, 2))


def refined_grid(native: Grid, table: GridTable, source: str | Path) -> Grid:
    """The planner's grid inside a file's: its cells split so that every node of the file stays a node.

    Wind is bilinear between the file's nodes; keeping them keeps the promise of the hazard matrices, that no
    wind over the threshold hides between two safe cells.

    Args:
        native: the file's grid.
        table: the cell size wanted and, if given, the area.
        source: the file, for messages.

    Raises:
        WeatherError: if the area reaches outside the file, too near a pole, or has too many cells.
    """
    rows, columns = range(native.rows), range(native.columns)
    if bounds_rad := _bounds_rad(table):
        south_rad, north_rad, west_rad, east_rad = bounds_rad
        low_row, low_column = native.indices(south_rad, west_rad)
        high_row, high_column = native.indices(north_rad, east_rad)
        rows = _nodes_around(low_row, high_row, native.rows, "latitudes", source)
        columns = _nodes_around(low_column, high_column, native.columns, "longitudes", source)
    polar_rad = max(abs(float(native.lat_rad[rows[0]])), abs(float(native.lat_rad[rows[-1]])))
    if polar_rad > POLAR_LIMIT_RAD:
        raise WeatherError(
            f"{source} reaches {math.degrees(polar_rad):.1f} deg of latitude, the planner works up to "
            f"{math.degrees(POLAR_LIMIT_RAD):.0f}; give the mission's area in [grid]"
        )
    middle = rows[len(rows) // 2]
    north_splits = max(round(float(native.north_cell_m[middle]) / table.cell_m), 1)
    east_splits = max(round(float(native.east_cell_m[middle]) / table.cell_m), 1)
    _check_cells((len(rows) - 1) * north_splits + 1, (len(columns) - 1) * east_splits + 1)
    return Grid(
        float(native.lat_rad[rows[0]]),
        float(native.lon_rad[columns[0]]),
        native.north_step_rad / north_splits,
        native.east_step_rad / east_splits,
        (len(rows) - 1) * north_splits + 1,
        (len(columns) - 1) * east_splits + 1,
    )


def _check_cells(rows: int, columns: int) -> None:
    if rows * columns > MOST_CELLS:
        raise WeatherError(
            f"the planner's grid would have {rows} x {columns} cells, the limit is {MOST_CELLS}; "
            "raise grid.cell_m, or give a smaller area in [grid]"
        )


def _nodes_around(low: float, high: float, count: int, what: str, source: str | Path) -> range:
    """The file's nodes from the last one below an area to the first one above it."""
    first, last = math.floor(low + 1e-6), math.ceil(high - 1e-6)
    if first < 0 or last > count - 1 or last <= first:
        raise WeatherError(
            f"{source} does not hold all {what} of [grid]; "
            "give an area inside the file, or leave it out to use all of it"
        )
    return range(first, last + 1)


def _check_speed(wind: WindField, source: str) -> None:
    fastest_mps = max(float(np.abs(part).max()) for part in (wind.north_mps, wind.east_mps))
    if fastest_mps > STRONGEST_MPS:
        raise WeatherError(
            f"{source} has a wind of {fastest_mps:.3g} m/s, which blows nowhere on Earth (limit "
            f"{STRONGEST_MPS:.0f} m/s); if it marks missing values, declare it as _FillValue"
        )


def _check_time(wind: WindField, scenario: Scenario, source: str) -> None:
    begin_s = scenario.mission.departure_s
    end_s = begin_s + _horizon_s(scenario)
    if begin_s < wind.time_s[0] or end_s > wind.time_s[-1]:
        have, want = (
            " to ".join(str(np.datetime64(int(end), "s")) for end in ends)
            for ends in ((wind.time_s[0], wind.time_s[-1]), (begin_s, end_s))
        )
        raise WeatherError(
            f"{source} holds {have} UTC, but the mission takes {want}; "
            "change mission.departure or stages.count, or bring longer weather"
        )
