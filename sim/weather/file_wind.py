"""The wind that a mission finds in weather files: read, and held against the mission's time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from planner.errors import PlannerError
from planner.grid import Grid
from planner.tiled import is_tiled
from planner.windfield import WindField
from sim.errors import WeatherError
from sim.scenario import Scenario
from sim.weather.components import STRONGEST_MPS
from sim.weather.files import Bounds, Reading, read_wind
from sim.weather.opening import found_files
from sim.weather.spans import Spans
from sim.weather.times import utc


def forecast_wind(scenario: Scenario, folder: Path, area_rad: Bounds | None) -> WindField:
    """The wind of a scenario's weather files.

    Args:
        scenario: one that names files.
        folder: to which their names are relative.
        area_rad: south, north, west and east bound [rad], None for all that the files hold.

    Raises:
        WeatherError: if they cannot be read, do not hold the mission's time, have gaps in it that the
            scenario does not let be bridged, or a wind that blows nowhere.
    """
    table = scenario.weather
    reading = Reading(table.variables, table.levels, table.wind_axes, area_rad)
    wind = read_wind(found_files(table.file or (), folder), reading=reading, member=table.member)
    _check(wind, scenario, _named(table.file or ()))
    return wind


def true_wind(scenario: Scenario, folder: Path, forecast: WindField, area_rad: Bounds | None) -> WindField:
    """The wind of the files that hold the truth where it differs from the forecast, else the forecast's.

    Args:
        scenario: one that names files.
        folder: to which their names are relative.
        forecast: on the planner's grid, all of which the truth must cover, at the mission's altitude.
        area_rad: see `forecast_wind`.

    Raises:
        WeatherError: as `forecast_wind` does, or if the truth does not cover the planner's grid.
    """
    table, truth = scenario.weather, scenario.weather.truth
    assert truth.file is not None
    source = _named(truth.file)
    reading = Reading(truth.variables, table.levels, table.wind_axes, area_rad)
    wind = read_wind(found_files(truth.file, folder), reading=reading, member=truth.member)
    _check(wind, scenario, source)
    for altitude_m in scenario.mission.all_levels_m:
        try:
            wind.level(altitude_m, _corners(forecast.grid))
        except PlannerError as error:
            raise WeatherError(
                f"the truth in {source} covers {wind.grid.describe()}, the planner's grid "
                f"{forecast.grid.describe()} at {altitude_m:.0f} m: {error}"
            ) from error
    return wind


def _named(files: str | Sequence[str]) -> str:
    return files if isinstance(files, str) else ", ".join(files)


def _corners(grid: Grid) -> Grid:
    ends = (grid.lat_rad[0], grid.lat_rad[-1], grid.lon_rad[0], grid.lon_rad[-1])
    return Grid.covering(*map(float, ends), rows=2, columns=2)


def _check(wind: WindField, scenario: Scenario, source: str) -> None:
    _check_speed(wind, source)
    begin_s = scenario.mission.departure_s
    end_s = begin_s + scenario.stages.count * scenario.stages.steps * scenario.stages.step_s
    if begin_s < wind.time_s[0] or end_s > wind.time_s[-1]:
        raise WeatherError(
            f"{source} holds {utc(wind.time_s[0])} to {utc(wind.time_s[-1])} UTC, but the mission takes "
            f"{utc(begin_s)} to {utc(end_s)}; change mission.departure or stages.count, or bring longer "
            "weather"
        )
    bridge_s = 3600.0 * scenario.weather.bridge_gaps_h
    Spans.at(wind.time_s).refuse_gaps(begin_s, end_s, bridge_s, source, "wind")


def _check_speed(wind: WindField, source: str) -> None:
    if is_tiled(wind.north_mps):
        return  # looked at while it was looked through
    fastest_mps = max(float(np.abs(part).max()) for part in (wind.north_mps, wind.east_mps))
    if fastest_mps > STRONGEST_MPS:
        raise WeatherError(
            f"{source} has a wind of {fastest_mps:.3g} m/s, which blows nowhere on Earth (limit "
            f"{STRONGEST_MPS:.0f} m/s); if it marks missing values, declare it as _FillValue"
        )
