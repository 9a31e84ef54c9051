"""Levels of weather files: heights, pressures, surfaces of the geopotential, and numbers in names."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from sim.errors import WeatherError
from sim.weather.files import Reading, read_wind
from sim.weather.levels import geometric_m, height_named, standard_height_m

TIMES = np.array(["2024-05-01T00", "2024-05-01T01"], dtype="datetime64[ns]")
LAT_DEG, LON_DEG = np.linspace(50.0, 52.0, 5), np.linspace(4.0, 7.0, 7)
WIND = np.random.default_rng(4).normal(0.0, 9.0, (2, 2, 4, 5, 7)).astype(np.float32)
ANGLES = {
    "latitude": ("latitude", LAT_DEG, {"units": "degrees_north"}),
    "longitude": ("longitude", LON_DEG, {"units": "degrees_east"}),
}


def layered(values, attributes, name="level", wind=WIND):
    """A wind on levels."""
    dims = ("time", name, "latitude", "longitude")
    variables = {n: (dims, part, {"units": "m s-1"}) for n, part in zip("uv", wind, strict=True)}
    return xr.Dataset(variables, {"time": TIMES, name: (name, values, attributes), **ANGLES})


def read(data, tmp_path, **reading):
    data.to_netcdf(tmp_path / "wind.nc")
    return read_wind(tmp_path / "wind.nc", reading=Reading(**reading))


@pytest.mark.parametrize(
    ("pressure_hpa", "height_m"),
    # ICAO Doc 7488/3: geopotential altitude by pressure
    [
        (1013.25, 0.0),
        (898.746, 1000.0),
        (794.952, 2000.0),
        (540.199, 5000.0),
        (264.363, 10000.0),
        (120.446, 15000.0),
    ],
)
def test_the_standard_atmosphere_is_the_published_one(pressure_hpa, height_m):
    assert standard_height_m(100.0 * pressure_hpa) == pytest.approx(geometric_m(height_m), abs=0.5)


@given(st.floats(6000.0, 105000.0), st.floats(0.1, 2000.0))
def test_lower_pressure_is_always_higher(pressure_pa, more_pa):
    assert standard_height_m(pressure_pa) > standard_height_m(pressure_pa + more_pa)


@pytest.mark.parametrize(
    ("values", "attributes", "name"),
    [
        ([1000.0, 925.0, 850.0, 700.0], {"units": "hPa", "standard_name": "air_pressure"}, "plev"),
        ([100000.0, 92500.0, 85000.0, 70000.0], {"units": "Pa", "standard_name": "air_pressure"}, "plev"),
        ([1000, 925, 850, 700], {"units": "millibars", "long_name": "pressure_level"}, "level"),
        ([70.0, 85.0, 92.5, 100.0], {"units": "kPa", "positive": "down"}, "lev"),
    ],
)
def test_pressures_become_heights_of_the_standard_atmosphere(values, attributes, name, tmp_path):
    falling = values[0] > values[-1]
    wind = WIND if falling else WIND[:, :, ::-1]
    field = read(layered(values, attributes, name, wind), tmp_path)
    np.testing.assert_allclose(field.height_m, standard_height_m([1e5, 92500.0, 85000.0, 70000.0]))
    np.testing.assert_array_equal(field.east_mps, WIND[0])


@pytest.mark.parametrize(
    ("attributes", "scale"),
    [
        ({"units": "m", "standard_name": "altitude"}, 1.0),
        ({"units": "km", "standard_name": "height_above_mean_sea_level"}, 1e-3),
        ({"units": "ft", "standard_name": "height"}, 1.0 / 0.3048),
        ({"units": "m", "positive": "up"}, 1.0),
    ],
)
def test_heights_become_metres(attributes, scale, tmp_path):
    field = read(layered(scale * np.array([10.0, 80.0, 500.0, 1500.0]), attributes), tmp_path)
    np.testing.assert_allclose(field.height_m, [10.0, 80.0, 500.0, 1500.0])


@pytest.mark.parametrize(("unit", "scale"), [("m2 s-2", 9.80665), ("gpm", 1.0)])
def test_the_files_own_geopotential_decides_how_high_a_pressure_is(unit, scale, tmp_path):
    """A wind that is a straight line in height stays that, though each column's surfaces lie elsewhere."""
    geopotential_m = np.array([120.0, 760.0, 1450.0, 3000.0])[:, np.newaxis, np.newaxis]
    geopotential_m = geopotential_m + np.linspace(-60.0, 60.0, 35).reshape(5, 7) + np.zeros((2, 4, 5, 7))
    height_m = geometric_m(geopotential_m)
    wind = np.stack([0.01 * height_m - 5.0, 8.0 - 0.002 * height_m])
    data = layered(
        [1000.0, 925.0, 850.0, 700.0], {"units": "hPa", "standard_name": "air_pressure"}, "plev", wind
    )
    dims = ("time", "plev", "latitude", "longitude")
    data["z"] = (dims, scale * geopotential_m, {"units": unit, "standard_name": "geopotential"})
    field = read(data, tmp_path)
    np.testing.assert_allclose(field.height_m, height_m.mean(axis=(0, 2, 3)))
    at = field.height_m[1:3, np.newaxis, np.newaxis]
    np.testing.assert_allclose(
        field.east_mps[:, 1:3], np.broadcast_to(0.01 * at - 5.0, (2, 2, 5, 7)), atol=1e-9
    )
    np.testing.assert_allclose(
        field.north_mps[:, 1:3], np.broadcast_to(8.0 - 0.002 * at, (2, 2, 5, 7)), atol=1e-9
    )
    assert wind[0].min() - 1e-9 <= field.east_mps.min()
    assert field.east_mps.max() <= wind[0].max() + 1e-9


def single(names, wind=WIND[:, :, 0], height_m=None):
    dims = ("time", "latitude", "longitude")
    data = xr.Dataset(
        {n: (dims, part, {"units": "m s-1"}) for n, part in zip(names, wind, strict=True)},
        {"time": TIMES, **ANGLES},
    )
    return data if height_m is None else data.assign_coords(height=((), height_m, {"units": "m"}))


def test_winds_at_several_heights_are_one(tmp_path):
    data = xr.merge([single(("u10", "v10")), single(("u100", "v100"), WIND[:, :, 1])])
    field = read(data, tmp_path)
    np.testing.assert_array_equal(field.height_m, [10.0, 100.0])
    np.testing.assert_array_equal(field.north_mps, np.stack([WIND[1, :, 0], WIND[1, :, 1]], axis=1))
    assert read(data, tmp_path, variables=("u100", "v100")).height_m is None


def test_files_of_one_level_each_are_one_wind(tmp_path):
    for level, height_m in enumerate((1000.0, 500.0)):
        single("uv", WIND[:, :, level], height_m).to_netcdf(tmp_path / f"{level}.nc")
    field = read_wind([tmp_path / "0.nc", tmp_path / "1.nc"])
    np.testing.assert_array_equal(field.height_m, [500.0, 1000.0])
    np.testing.assert_array_equal(field.east_mps[:, 0], WIND[0, :, 1])


def test_heights_and_pressures_together_ask_which(tmp_path):
    pressures = layered(
        [1000.0, 925.0, 850.0, 700.0], {"units": "hPa", "standard_name": "air_pressure"}, "plev"
    )
    data = xr.merge([pressures, single(("u10", "v10"))])
    with pytest.raises(
        WeatherError, match=r'several winds .* or choose weather\.levels = "height" or "pressure"'
    ):
        read(data, tmp_path)
    assert read(data, tmp_path, levels="height").height_m is None
    assert read(data, tmp_path, levels="pressure").height_m.size == 4
    with pytest.raises(WeatherError, match="u has 1000, 925, 850, 700 hPa, not height levels"):
        read(pressures, tmp_path, levels="height")


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        (
            {"standard_name": "atmosphere_hybrid_sigma_pressure_coordinate", "positive": "down"},
            "neither heights nor",
        ),
        ({"units": "m", "standard_name": "depth", "positive": "down"}, "neither heights nor"),
        (
            {},
            r"axis 'level' of 4 values \(no unit\) that is neither time, member, height nor pressure",
        ),
    ],
)
def test_levels_of_no_known_height_are_refused(attributes, message, tmp_path):
    with pytest.raises(WeatherError, match=message):
        read(layered([1.0, 2.0, 3.0, 4.0], attributes), tmp_path)


def test_numbers_in_names_are_heights_only_where_they_can_be(tmp_path):
    for name, height_m in (("u10", 10.0), ("100v", 100.0), ("UGRD_80maboveground", 80.0), ("u", None)):
        assert height_named(xr.DataArray(0.0, name=name)) == height_m
        assert height_named(xr.DataArray(0.0, name="x", attrs={"GRIB_shortName": name})) == height_m
    told = "Maximum 10 metre wind gust in the last 3 hours"
    assert height_named(xr.DataArray(0.0, name="fg10_3", attrs={"long_name": told})) == 10.0
    data = xr.merge([single(("u850", "v850")), single(("u500", "v500"), WIND[:, :, 1])])
    with pytest.raises(WeatherError, match="several winds"):  # hectopascals, not metres
        read(data, tmp_path)


def test_pressure_levels_and_10_m_of_a_grib_file(grib, tmp_path):
    def messages():
        for name, level in (("u", 1000), ("v", 1000), ("u", 850), ("v", 850), ("10u", 10), ("10v", 10)):
            kind = {"typeOfLevel": "isobaricInhPa", "level": level} if level > 10 else {}
            yield {
                "shortName": name,
                "dataDate": 20240501,
                "dataTime": 0,
                "stepRange": "1",
                "lat_deg": LAT_DEG,
                "lon_deg": LON_DEG,
                "values": WIND[int("v" in name), 0, {1000: 0, 850: 1, 10: 2}[level]],
            } | kind

    path = grib("levels.grib2", 2, messages())
    aloft = read_wind(path, reading=Reading(levels="pressure"))
    np.testing.assert_allclose(aloft.height_m, standard_height_m([1e5, 85000.0]))
    np.testing.assert_allclose(aloft.north_mps[0], WIND[1, 0, :2], atol=1e-4)
    assert aloft.time_s[0] == 1714521600.0 + 3600.0


def test_winds_that_cannot_be_used_do_not_stand_in_the_way_of_those_that_can(tmp_path):
    sigma = layered(
        [1.0, 0.9, 0.8, 0.7], {"standard_name": "atmosphere_sigma_coordinate", "positive": "down"}
    )
    staggered = sigma.rename(u="U", v="V", longitude="stag").drop_vars("stag")
    field = read(xr.merge([staggered, single(("u10", "v10"))]), tmp_path)
    np.testing.assert_array_equal(field.east_mps, WIND[0, :, 0])
    with pytest.raises(WeatherError, match="U needs one longitude"):
        read(staggered, tmp_path)
