"""Forecasts of a gridded wind that turn out wrong: displaced, stronger or weaker, smoothly."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from planner.grid import Grid
from planner.windfield import WindField
from sim.scenario import load_scenario
from sim.weather.best_track import NAUTICAL_MILE_M
from sim.weather.field_forecasts import AREA_LENGTH_M, FieldForecasts
from sim.weather.source import bring_weather

HOUR_S = 3600.0
NATIVE = Grid.covering(*map(math.radians, (28.0, 42.0, -70.0, -54.0)), rows=29, columns=33)
GRID = Grid.covering(*map(math.radians, (31.0, 39.0, -66.0, -58.0)), rows=17, columns=17)
TIME_S = 1.6e9 + HOUR_S * np.arange(0.0, 37.0, 6.0)


@cache
def eddies(seed=0):
    """A wind of many eddies some 400 km across, wave by wave, which drift eastward at 10 m/s."""
    rng = np.random.default_rng(seed)
    north_km = 6371.0 * NATIVE.lat_rad[:, np.newaxis]
    east_km = 6371.0 * math.cos(math.radians(35.0)) * NATIVE.lon_rad
    waves = [(*rng.normal(0.0, 0.008, 2), *rng.uniform(0.0, 2.0 * math.pi, 2)) for _ in range(12)]
    hours = (TIME_S - TIME_S[0])[:, np.newaxis, np.newaxis] / HOUR_S
    north, east = (
        sum(
            4.0 * np.sin(k * north_km + m * (east_km - 36.0 * hours) + phases[part])
            for k, m, *phases in waves
        )
        for part in (0, 1)
    )
    return WindField(NATIVE, TIME_S, np.asarray(north), np.asarray(east))


def forecasts(seed=1, scale=1.0, truth=None, grid=GRID):
    return FieldForecasts(truth or eddies(), grid, TIME_S[0], HOUR_S, seed, scale)


def spot_of(row, column):
    """A grid of one cell."""
    return Grid(GRID.lat_rad[row], GRID.lon_rad[column], GRID.north_step_rad, GRID.east_step_rad, 1, 1)


def misplaced_m(made, stage=0):
    """Displacements of a forecast [m], shape (time, north, east)."""
    error = made.error(stage, made._time_s(stage), 0)
    return np.hypot(error.north_m, error.east_m), error


def test_a_forecast_without_error_is_the_truth():
    right = eddies().resampled(GRID)
    near = forecasts(scale=1e-9).issued(0)
    np.testing.assert_allclose(near.north_mps, right.north_mps, atol=1e-4)
    np.testing.assert_allclose(near.east_mps, right.east_mps, atol=1e-4)


def test_a_forecast_knows_the_weather_up_to_its_issue():
    made = forecasts()
    late, right = made.issued(15), eddies().resampled(GRID)
    assert TIME_S[0] + 15 * HOUR_S in late.time_s
    for hour in (0.0, 7.5, 12.0, 15.0):
        np.testing.assert_allclose(
            late.sheet(TIME_S[0] + hour * HOUR_S), right.sheet(TIME_S[0] + hour * HOUR_S), atol=1e-4
        )
    assert np.abs(np.subtract(late.sheet(TIME_S[-1]), right.sheet(TIME_S[-1]))).max() > 1.0


def test_displacements_are_as_large_as_published_track_errors():
    spot = spot_of(8, 8)
    errors_m = np.array([misplaced_m(forecasts(seed, grid=spot))[0][:, 0, 0] for seed in range(200)])
    for at, miles in ((2, 25.0), (4, 40.0), (6, 55.0)):
        assert errors_m[:, at].mean() / NAUTICAL_MILE_M == pytest.approx(miles, rel=0.12)


def test_errors_are_smooth_in_space_and_never_fold_the_weather():
    for seed in range(10):
        _, error = misplaced_m(forecasts(seed))
        for part, axis, cell_m in (
            (error.north_m, 1, GRID.north_cell_m[0]),
            (error.east_m, 2, GRID.east_cell_m[0]),
        ):
            stretch = np.diff(part, axis=axis) / cell_m
            assert np.abs(stretch).max() < 0.9  # at -1 two places would have the same weather
    ends = Grid(GRID.lat_rad[8], GRID.lon_rad[0], 1.0, 16 * GRID.east_step_rad, 1, 2)
    far = np.array([misplaced_m(forecasts(seed, grid=ends))[1].north_m[4, 0] for seed in range(200)])
    apart_m = 16 * GRID.east_cell_m[8]
    expected = math.exp(-((apart_m / AREA_LENGTH_M) ** 2) / 2.0)
    assert np.corrcoef(far.T)[0, 1] == pytest.approx(expected, abs=0.2)


def test_successive_forecasts_resemble_each_other():
    made = forecasts(3)
    last = [made.issued(stage).sheet(TIME_S[-1])[0] for stage in (0, 1, 12)]
    near, far = (np.abs(last[0] - other).mean() for other in last[1:])
    assert near < 0.3 * far


def test_no_forecast_depends_on_what_was_asked_before():
    one, other = forecasts(), forecasts()
    there = [one.issued(3).east_mps, one.members(2, 3)[2].east_mps]
    back = [other.members(2, 5)[2].east_mps, other.issued(3).east_mps][::-1]
    for mine, its in zip(there, back, strict=True):
        np.testing.assert_array_equal(mine, its)


def test_a_file_of_ones_own_is_forecast_wrongly(tmp_path):
    path = tmp_path / "wind.nc"
    save(eddies(), path)
    text = f"""
name = "own"
[mission]
departure = 2020-09-13T12:26:40Z
goal = "b"
start = {{ name = "a", lat_deg = 32.0, lon_deg = -65.0 }}
goals = [{{ name = "b", lat_deg = 38.0, lon_deg = -59.0 }}]
[weather]
file = "{path.name}"
error = {{ kind = "growing", members = 2 }}
[grid]
cell_m = 20000.0
"""
    (tmp_path / "own.toml").write_text(text)
    weather = bring_weather(load_scenario(str(tmp_path / "own.toml")))
    assert weather.truth.grid != weather.forecast.grid
    right = weather.truth.resampled(weather.forecast.grid)
    np.testing.assert_allclose(weather.forecast.sheet(TIME_S[0]), right.sheet(TIME_S[0]), atol=1e-4)
    assert np.abs(np.subtract(weather.forecast.sheet(TIME_S[4]), right.sheet(TIME_S[4]))).max() > 1.0
    assert len(weather.members(4)) == 2
    assert weather.issued(4).grid == weather.forecast.grid


def save(field, path):
    import xarray as xr

    coordinates = {
        "time": ("time", field.time_s, {"units": "seconds since 1970-01-01", "standard_name": "time"}),
        "lat": (
            "lat",
            np.degrees(field.grid.lat_rad),
            {"units": "degrees_north", "standard_name": "latitude"},
        ),
        "lon": (
            "lon",
            np.degrees(field.grid.lon_rad),
            {"units": "degrees_east", "standard_name": "longitude"},
        ),
    }
    names = {"u": ("eastward_wind", field.east_mps), "v": ("northward_wind", field.north_mps)}
    xr.Dataset(
        {
            name: (("time", "lat", "lon"), values, {"standard_name": long, "units": "m s-1"})
            for name, (long, values) in names.items()
        },
        coordinates,
    ).to_netcdf(path)


def test_a_truth_that_holds_beyond_its_area_is_asked_there():
    whole = replace(forecasts(scale=8.0), grid=NATIVE)
    assert np.isfinite(whole.issued(0).north_mps).all()
