"""Real wind files, against xarray's own answers."""

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from sim.weather.files import read_wind


def test_hurricane_katrina_is_read(data_folder: Path) -> None:
    field = read_wind(data_folder / "katrina_wrf10km_20050828.nc")
    assert field.north_mps.shape == (4, 7, 48, 48)
    assert field.down_mps is not None
    np.testing.assert_array_equal(np.diff(field.time_s), 3 * 3600.0)
    surface, aloft = field.at_altitude(10.0), field.at_altitude(500.0)
    assert np.hypot(surface.north_mps, surface.east_mps).max() == pytest.approx(47.0, abs=1.5)
    assert 0.27 < (np.hypot(surface.north_mps, surface.east_mps) > 15.0).mean() < 0.47
    assert 0.50 < (np.hypot(aloft.north_mps, aloft.east_mps) > 15.0).mean() < 0.73
    # The file's rows are a Mercator grid's; between them the even rows must agree with xarray's own answer.
    with xr.open_dataset(data_folder / "katrina_wrf10km_20050828.nc") as data:
        lat_deg, lon_deg = np.random.default_rng(2).uniform((22.0, -91.0), (25.5, -88.0), (300, 2)).T
        point = {"latitude": xr.DataArray(lat_deg, dims="p"), "longitude": xr.DataArray(lon_deg, dims="p")}
        expected = data["v"].isel(time=2, height=3).astype(float).interp(point).values
    north_mps = field.at_many(field.time_s[2], np.radians(lat_deg), np.radians(lon_deg), 500.0)[0]
    assert np.sqrt(np.mean((north_mps - expected) ** 2)) < 0.3
    assert abs(np.mean(north_mps - expected)) < 0.05


def test_the_gfs_wind_over_the_north_atlantic_is_read_as_it_is(data_folder: Path) -> None:
    field = read_wind(data_folder / "gfs10m_natlantic_201611.nc")
    assert field.height_m is None
    assert field.grid.shape == (42, 76)
    with xr.open_dataset(data_folder / "gfs10m_natlantic_201611.nc") as data:
        np.testing.assert_array_equal(field.east_mps, data["u10"].values)
        at_noon = data["v10"].sel(time="2016-11-20T12:00", latitude=50.0, longitude=-10.0).item()
    noon_s = np.datetime64("2016-11-20T12:00", "s").astype(int)
    wind = field.at(float(noon_s), math.radians(50.0), math.radians(-10.0))
    assert wind.north_mps == pytest.approx(at_noon, abs=1e-6)
