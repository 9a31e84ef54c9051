"""The weather of a scenario: the forecast on the planner's grid, and the wind as it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from planner.grid import Grid
from planner.windfield import WindField
from sim.clock import make_clock
from sim.errors import WeatherError
from sim.hazards.field import Stages
from sim.hazards.joining import Around, JoinedHazard, join_hazards
from sim.scenario import GridTable, LoadedScenario, Scenario
from sim.weather.at_levels import WeatherLevels, at_levels
from sim.weather.best_track import read_best_track
from sim.weather.field_forecasts import FieldForecasts
from sim.weather.file_wind import forecast_wind, true_wind
from sim.weather.files import Reading
from sim.weather.opening import found_files
from sim.weather.storm_forecasts import StormForecasts
from sim.weather.storms import STORMS

SHEET_INTERVAL_S = 1800.0
"""Between two times of a storm's wind field: a storm moves less than its radius of maximum wind in it."""

MOST_CELLS = 2_000_000
"""Cells of the planner's grid: nine times those of the paper, about 2 GB in a search of 540 steps."""

POLAR_LIMIT_RAD = math.radians(80.0)

LATE_S = 3600.0
"""Wind kept beyond the planner's horizon, for a flight that is late."""


@dataclass(frozen=True, slots=True)
class MissionWeather:
    """What the planner sees and what the aircraft flies through.

    `forecast`: as of departure, without heights, at the mission's altitude, on the planner's grid. `truth`:
    as it is. `issued`: the forecast of the same kind that is issued when a stage begins (1, 2, ...), from
    then on; None where that of departure stands. `members`: the ensemble of the forecast that is issued when
    a stage begins (0, 1, ...), each member like the forecast and as likely to be the truth as any other, made
    when it is asked for; None where there is no ensemble. `also`: what is hazardous besides the mean wind, at
    the mission's altitude. `levels`: where the plan may choose among several.
    """

    forecast: WindField
    truth: WindField
    issued: Callable[[int], WindField] | None = None
    members: Callable[[int], Sequence[WindField]] | None = None
    also: JoinedHazard = JoinedHazard()  # noqa: RUF009 - frozen
    levels: WeatherLevels | None = None


def bring_weather(loaded: LoadedScenario) -> MissionWeather:
    """Make or read the wind that a scenario names, and what it calls hazardous besides.

    Raises:
        WeatherError: if there is no such storm or file, or it does not hold the mission's area and time.
        SimError: if another hazard cannot be read or does not fit.
    """
    weather, hazard = _wind(loaded), loaded.scenario.hazard
    if not hazard.also:
        return weather
    altitude_m = loaded.scenario.mission.altitude_m
    stages = Stages(
        weather.forecast.grid,
        make_clock(loaded.scenario),
        altitude_m,
        hazard.corridor_m,
        bridge_s=3600.0 * loaded.scenario.weather.bridge_gaps_h,
    )
    around, levels = _around(loaded, weather), weather.levels
    if levels is not None:
        heights_m = levels.height_m
        of_heights = [
            replace(stages, altitude_m=height_m, passed_m=passed_m)
            for height_m, passed_m in zip(heights_m, _passed_m(heights_m), strict=True)
        ]
        also = tuple(join_hazards(hazard.also, of_height, around) for of_height in of_heights)
        levels = replace(levels, also=also)
    return replace(weather, also=join_hazards(hazard.also, stages, around), levels=levels)


def _passed_m(heights_m: Sequence[float]) -> list[tuple[float, float]]:
    """What a climb passes on account of each level: halfway to the next ones."""
    middles_m = [(low_m + high_m) / 2.0 for low_m, high_m in pairwise(heights_m)]
    return list(pairwise([heights_m[0], *middles_m, heights_m[-1]]))


def _around(loaded: LoadedScenario, weather: MissionWeather) -> Around:
    table = loaded.scenario.weather
    gridded = table.file is not None and table.storm is None
    return Around(
        folder=loaded.folder,
        files=found_files(table.file or (), loaded.folder) if gridded else (),
        reading=Reading(table.variables, table.levels, table.wind_axes, _bounds_rad(loaded.scenario.grid)),
        threshold_mps=loaded.scenario.hazard.threshold_mps,
        truth_factor=table.truth.speed_factor if table.truth.file is None else None,
        members=weather.members,
    )


def _wind(loaded: LoadedScenario) -> MissionWeather:
    scenario = loaded.scenario
    if scenario.weather.calm:
        calm = _calm(scenario)
        return MissionWeather(calm, calm)
    if scenario.weather.storm is not None:
        return _storm(loaded, scenario.weather.storm)
    if scenario.weather.sounding:
        return _levelled(scenario, _sounding(scenario), _area_grid(scenario.grid), "weather.sounding")
    area_rad, altitude_m = _bounds_rad(scenario.grid), scenario.mission.altitude_m
    error = scenario.weather.error
    wind = forecast_wind(scenario, loaded.folder, area_rad)
    grid = refined_grid(wind.grid, scenario.grid, str(scenario.weather.file))
    factor = scenario.weather.truth.speed_factor
    if error.kind == "none":
        weather = _levelled(scenario, wind, grid, str(scenario.weather.file))
        if scenario.weather.truth.file is None:
            return weather
        true = true_wind(scenario, loaded.folder, weather.forecast, area_rad)
        return replace(weather, truth=_strengthened(true, factor))
    forecasts = FieldForecasts(
        truth=wind.level(altitude_m, wind.grid),
        grid=grid,
        begin_s=scenario.mission.departure_s,
        stage_s=_stage_s(scenario),
        seed=scenario.seed,
        scale=error.scale,
    )
    return _erring(forecasts, _strengthened(wind, factor), error.members)


def _calm(scenario: Scenario) -> WindField:
    """No wind over the scenario's area, for its time."""
    grid, begin_s = _area_grid(scenario.grid), scenario.mission.departure_s
    still = np.zeros((2, *grid.shape), dtype=np.float32)
    return WindField(grid, np.array([begin_s, begin_s + _horizon_s(scenario) + LATE_S]), still, still.copy())


def _sounding(scenario: Scenario) -> WindField:
    """The wind of a sounding over the scenario's area, for its time."""
    levels, begin_s = scenario.weather.sounding, scenario.mission.departure_s
    grid = _area_grid(scenario.grid)
    components = np.array([[level.north_mps, level.east_mps] for level in levels], dtype=np.float32).T
    shape = (2, len(levels), *grid.shape)
    north_mps, east_mps = (
        np.broadcast_to(component[:, np.newaxis, np.newaxis], shape).copy() for component in components
    )
    return WindField(
        grid,
        np.array([begin_s, begin_s + _horizon_s(scenario) + LATE_S]),
        north_mps,
        east_mps,
        np.array([level.height_m for level in levels]),
    )


def _levelled(scenario: Scenario, wind: WindField, grid: Grid, source: str) -> MissionWeather:
    """Weather that is forecast right, at the mission's altitude and at its levels."""
    mission = scenario.mission
    levels = at_levels(wind, mission.all_levels_m, grid, source) if mission.levels_m else None
    truth = _strengthened(wind, scenario.weather.truth.speed_factor)
    return MissionWeather(wind.level(mission.altitude_m, grid), truth, levels=levels)


def _strengthened(wind: WindField, factor: float) -> WindField:
    """The same wind, so many times as strong."""
    if factor == 1.0:
        return wind
    down_mps = None if wind.down_mps is None else factor * wind.down_mps
    return replace(
        wind, north_mps=factor * wind.north_mps, east_mps=factor * wind.east_mps, down_mps=down_mps
    )


def _storm(loaded: LoadedScenario, storm: str) -> MissionWeather:
    scenario, error, track = loaded.scenario, loaded.scenario.weather.error, loaded.scenario.weather.file
    if track is not None:
        if not isinstance(track, str):
            raise WeatherError(
                f"the storm {storm} comes from one best track, not from {len(track)} files; name that one"
            )
        begin_s = scenario.mission.departure_s
        fixes = read_best_track(
            loaded.folder / track,
            storm,
            span_s=(begin_s, begin_s + _horizon_s(scenario) + LATE_S),
            estimate_core=scenario.weather.core_radius == "estimated",
        )
    elif storm in STORMS:
        fixes = STORMS[storm]
    else:
        raise WeatherError(
            f"no storm {storm!r} ships with galeway; there are {', '.join(sorted(STORMS))}; for another one "
            "name a best track in HURDAT2's format as weather.file"
        )
    begin_s = scenario.mission.departure_s
    end_s = min(begin_s + _horizon_s(scenario) + LATE_S, fixes[-1].time_s)
    count = max(math.ceil((end_s - begin_s) / SHEET_INTERVAL_S), 1) + 1
    forecasts = StormForecasts(
        fixes=fixes,
        grid=_area_grid(scenario.grid),
        time_s=np.linspace(begin_s, end_s, count),
        stage_s=_stage_s(scenario),
        seed=scenario.seed,
        scale=error.scale,
    )
    right = forecasts.truth()
    truth = _strengthened(right, scenario.weather.truth.speed_factor)
    if error.kind == "none":
        return MissionWeather(right, truth)
    return _erring(forecasts, truth, error.members)


def _erring(forecasts: StormForecasts | FieldForecasts, truth: WindField, members: int) -> MissionWeather:
    """Weather whose forecasts turn out wrong."""
    ensemble = partial(forecasts.members, count=members) if members else None
    return MissionWeather(forecasts.issued(0), truth, forecasts.issued, ensemble)


def _horizon_s(scenario: Scenario) -> float:
    return scenario.stages.count * _stage_s(scenario)


def _stage_s(scenario: Scenario) -> float:
    return scenario.stages.steps * scenario.stages.step_s


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
        whole = f"{source} covers {native.describe()}"
        rows = _nodes_around(low_row, high_row, native.rows, f"{whole} and does not hold all latitudes")
        columns = _nodes_around(
            low_column, high_column, native.columns, f"{whole} and does not hold all longitudes"
        )
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


def _nodes_around(low: float, high: float, count: int, complaint: str) -> range:
    """The file's nodes from the last one below an area to the first one above it."""
    first, last = math.floor(low + 1e-6), math.ceil(high - 1e-6)
    if first < 0 or last > count - 1 or last <= first:
        raise WeatherError(
            f"{complaint} of [grid]; give an area inside the file, or leave it out to use all of it"
        )
    return range(first, last + 1)
