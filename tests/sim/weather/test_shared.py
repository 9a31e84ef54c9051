"""Ensembles beside which lie variables without members: taken for each of them, or refused for a reason."""

import numpy as np
import pytest
import xarray as xr

from sim.errors import WeatherError
from sim.weather.files import read_members, read_wind

TIMES = np.array(["2024-05-01T00", "2024-05-01T01"], dtype="datetime64[ns]")
LAT_DEG, LON_DEG = np.arange(50.0, 52.1, 0.5), np.arange(5.0, 8.1, 0.5)
DIMS = ("number", "time", "level", "latitude", "longitude")
HEIGHTS_M = np.array([100.0, 800.0, 1500.0])  # well off the standard atmosphere's 111, 762 and 1457


def written(folder, *, without=(), members=(0, 1, 2)):
    """An ensemble on pressure levels; some of its variables without members."""
    coords = {
        "number": ("number", list(members), {"standard_name": "realization"}),
        "time": TIMES,
        "level": ("level", [1000.0, 925.0, 850.0], {"units": "hPa", "standard_name": "air_pressure"}),
        "latitude": ("latitude", LAT_DEG, {"units": "degrees_north"}),
        "longitude": ("longitude", LON_DEG, {"units": "degrees_east"}),
    }
    shape = (len(members), 2, 3, LAT_DEG.size, LON_DEG.size)
    u, v, w = np.random.default_rng(1).normal(0.0, 5.0, (3, *shape))
    z = np.broadcast_to(HEIGHTS_M[:, np.newaxis, np.newaxis], shape)
    named = {
        "u": (u, "eastward_wind", "m s-1"),
        "v": (v, "northward_wind", "m s-1"),
        "w": (0.1 * w, "upward_air_velocity", "m s-1"),
        "z": (z, "geopotential_height", "m"),
    }
    data = {}
    for name, (values, standard_name, units) in named.items():
        alone = name in without
        attributes = {"standard_name": standard_name, "units": units}
        data[name] = (DIMS[alone:], values[0] if alone else values, attributes)
    path = folder / "ensemble.nc"
    xr.Dataset(data, coords).to_netcdf(path)
    return path


@pytest.mark.parametrize("without", [("z",), ("w",), ("w", "z")])
def test_what_has_no_members_holds_for_each(tmp_path, without):
    alone = read_members(written(tmp_path, without=without))
    np.testing.assert_allclose(alone.height_m, HEIGHTS_M, rtol=1e-3)
    everywhere = read_members(written(tmp_path))
    assert alone.numbers == everywhere.numbers == (0, 1, 2)
    np.testing.assert_allclose(alone.east_mps, everywhere.east_mps, atol=1e-9)
    for member in range(3):
        of_first = everywhere.up_mps[0 if "w" in without else member]
        np.testing.assert_allclose(alone.up_mps[member], of_first, atol=1e-9)
    one = read_wind(tmp_path / "ensemble.nc", member=1)
    np.testing.assert_allclose(one.east_mps, everywhere.east_mps[1], atol=1e-9)


def test_components_of_other_members_are_refused_with_the_members_of_each(tmp_path):
    message = r"the wind u has 3 members, 0 to 2, and v one member; a component of one member does not go"
    with pytest.raises(WeatherError, match=message):
        read_wind(written(tmp_path, without=("v",)))
