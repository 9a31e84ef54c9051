"""Wind that is written: read back as it was, by galeway and by others, and sound under the CF conventions."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.grid import Grid
from planner.windfield import WindField
from sim.errors import WeatherError
from sim.weather.cf_writer import write_wind
from sim.weather.files import read_wind

TITLE = {"title": "Wind for a test", "source": "random numbers"}


def field(seed=3, *, west_deg=-82.0, layers=False, upward=False, dtype=np.float32, times=3):
    grid = Grid.covering(*map(math.radians, (26.0, 28.0, west_deg, west_deg + 3.0)), rows=9, columns=13)
    shape = (times, 4, *grid.shape) if layers else (times, *grid.shape)
    parts = np.random.default_rng(seed).normal(0.0, 15.0, (3, *shape)).astype(dtype)
    return WindField(
        grid,
        1664409600.0 + 1800.0 * np.arange(times),
        parts[0],
        parts[1],
        np.array([10.0, 100.0, 500.0, 1500.0]) if layers else None,
        parts[2] if upward else None,
    )


KINDS = {
    "plain": {},
    "with heights and upward wind": {"layers": True, "upward": True},
    "double precision": {"dtype": np.float64},
    "across the date line": {"west_deg": 178.5},
    "one time": {"times": 1},
}


@pytest.fixture(params=KINDS, scope="module")
def kind(request):
    return field(**KINDS[request.param])


def assert_same(found: WindField, wind: WindField) -> None:
    for name in ("north_mps", "east_mps", "down_mps", "height_m", "time_s"):
        own, its = getattr(wind, name), getattr(found, name)
        if own is None:
            assert its is None
        else:
            assert own.dtype == its.dtype
            np.testing.assert_array_equal(its, own)
    np.testing.assert_allclose(found.grid.lat_rad, wind.grid.lat_rad, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found.grid.lon_rad, wind.grid.lon_rad, rtol=0.0, atol=1e-12)


def test_galeway_reads_back_what_it_wrote(tmp_path, kind):
    path = tmp_path / "wind.nc"
    write_wind(path, kind, **TITLE)
    assert_same(read_wind(path), kind)
    assert [entry.name for entry in tmp_path.iterdir()] == ["wind.nc"]


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-180.0, 179.0))
def test_any_wind_is_read_back(tmp_path_factory, seed, west_deg):
    path = tmp_path_factory.mktemp("wind") / "wind.nc"
    wind = field(seed, west_deg=west_deg)
    write_wind(path, wind, **TITLE)
    found = read_wind(path)
    np.testing.assert_array_equal(found.north_mps, wind.north_mps)
    assert np.allclose(found.grid.lon_rad, wind.grid.lon_rad, atol=1e-12)


def test_the_same_wind_gives_the_same_bytes(tmp_path, kind):
    for name in ("one.nc", "other.nc"):
        write_wind(tmp_path / name, kind, **TITLE)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "other.nc").read_bytes()


def test_others_read_it_with_times_and_names(tmp_path):
    wind = field(layers=True, upward=True)
    write_wind(tmp_path / "wind.nc", wind, **TITLE)
    with xr.open_dataset(tmp_path / "wind.nc") as dataset:
        assert dataset["time"].values[1] == np.datetime64("2022-09-29T00:30:00")
        up = dataset["w"].sel(level=100.0, lat=27.0, method="nearest")
        np.testing.assert_array_equal(up.values, -wind.down_mps[:, 1, 4])
        assert dataset["u"].attrs["standard_name"] == "eastward_wind"


def test_the_compliance_checker_finds_nothing(tmp_path):
    paths = [tmp_path / f"{number}.nc" for number in range(len(KINDS))]
    for path, kind in zip(paths, KINDS.values(), strict=True):
        write_wind(path, field(**kind), **TITLE)
    checked = compliance(*paths)
    assert checked.returncode == 0, checked.stdout
    assert checked.stdout.count("All tests passed!") == len(paths)


def test_the_compliance_checker_looks(tmp_path):
    path = tmp_path / "wind.nc"
    write_wind(path, field(), **TITLE)
    with xr.open_dataset(path, decode_times=False) as dataset:
        broken = dataset.load()
    broken["u"].attrs["units"] = "kg"
    broken.to_netcdf(tmp_path / "broken.nc")
    assert compliance(tmp_path / "broken.nc").returncode != 0


def compliance(*paths):
    checker = Path(sys.executable).parent / "compliance-checker"
    return subprocess.run(
        [checker, "--test", "cf:1.11", "--criteria", "strict", *map(str, paths)],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.mark.parametrize(
    ("name", "message"),
    [("wind.grib", "name it wind.nc, not wind.grib"), ("missing/wind.nc", "there is no folder .*missing")],
)
def test_what_cannot_be_written_is_named(tmp_path, name, message):
    with pytest.raises(WeatherError, match=message):
        write_wind(tmp_path / name, field(), **TITLE)


def test_a_folder_in_the_way_is_named(tmp_path):
    (tmp_path / "wind.nc").mkdir()
    with pytest.raises(WeatherError, match=r"cannot write the weather to .*wind\.nc"):
        write_wind(tmp_path / "wind.nc", field(), **TITLE)
    assert [entry.name for entry in tmp_path.iterdir()] == ["wind.nc"]
