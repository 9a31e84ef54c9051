"""Wind on the grids of map projections, held against PROJ and against xarray's interpolation."""

import math

import numpy as np
import pyproj
import pytest
import xarray as xr
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.cli_weather import weather
from sim.errors import WeatherError
from sim.weather.files import Reading, read_wind

LAMBERT = "+proj=lcc +lat_1=38.5 +lat_2=38.5 +lat_0=38.5 +lon_0=-97.5 +R=6371229"
STEREO = "+proj=stere +lat_0=90 +lat_ts=60 +lon_0=-30 +R=6371229"
ROTATED = "+proj=ob_tran +o_proj=longlat +o_lon_p=0 +o_lat_p=39.25 +lon_0=18 +R=6371229"
DATE_LINE = "+proj=lcc +lat_1=50 +lat_2=50 +lat_0=50 +lon_0=178 +R=6371229"
MAPS = {
    "Lambert": (LAMBERT, np.arange(-2.0e5, 2.01e5, 2.0e4) + 4e5, np.arange(-2.0e5, 2.01e5, 2.0e4)),
    "polar stereographic": (STEREO, np.arange(3.0e5, 8.01e5, 2.5e4), np.arange(-3.6e6, -3.09e6, 2.5e4)),
    "rotated globe": (ROTATED, np.radians(np.arange(-6.0, 6.1, 0.4)), np.radians(np.arange(-3.0, 3.1, 0.4))),
    "across the date line": (DATE_LINE, np.arange(-3.0e5, 4.01e5, 2.5e4), np.arange(-2.0e5, 2.01e5, 2.5e4)),
}


def places(name):
    """Latitudes and longitudes [deg] of a map's points, and the turn of its x axis from the east."""
    crs, x, y = MAPS[name]
    radians = "ob_tran" in crs
    to_map = pyproj.Transformer.from_crs("+proj=longlat +R=6371229", crs, always_xy=True)
    scale = np.degrees(1.0) if radians else 1.0
    lon, lat = to_map.transform(*np.meshgrid(scale * x, scale * y), direction="INVERSE")
    x_ahead, y_ahead = (part * scale for part in np.meshgrid(x + 1e-4 * (x[1] - x[0]), y))
    lon_ahead, lat_ahead = to_map.transform(x_ahead, y_ahead, direction="INVERSE")
    turn = np.arctan2(lat_ahead - lat, (lon_ahead - lon) * np.cos(np.radians(lat)))
    return lat, (lon + 180.0) % 360.0 - 180.0, turn


def dataset(name, *, along_grid, **attributes):
    """A wind that is a plane in latitude and longitude: u = 3 lat - 100, v = 20 - 2 lon."""
    lat, lon, turn = places(name)
    past = np.where(lon < 0.0, lon + 360.0, lon) if name == "across the date line" else lon
    east, north = 3.0 * lat - 100.0, 20.0 - 2.0 * (past - past.mean())
    if along_grid:
        east, north = (
            east * np.cos(turn) + north * np.sin(turn),
            north * np.cos(turn) - east * np.sin(turn),
        )
    names = ("x_wind", "y_wind") if along_grid else ("eastward_wind", "northward_wind")
    units = {"units": "m s-1"}
    both = [{"standard_name": one} | units if not attributes else units | attributes for one in names]
    return xr.Dataset(
        {
            "u": (("time", "y", "x"), np.stack([east, east + 6.0]), both[0]),
            "v": (("time", "y", "x"), np.stack([north, north]), both[1]),
        },
        {
            "time": ("time", np.array(["2024-05-01T00", "2024-05-01T01"], dtype="datetime64[ns]")),
            "latitude": (("y", "x"), lat, {"units": "degrees_north"}),
            "longitude": (("y", "x"), lon, {"units": "degrees_east"}),
        },
    ), past.mean()


def assert_plane(field, middle):
    lat, lon = np.degrees(field.grid.lat_rad)[:, np.newaxis], np.degrees(field.grid.lon_rad)
    lon = lon + 360.0 * np.rint((middle - lon.mean()) / 360.0)
    np.testing.assert_allclose(
        field.east_mps[0], np.broadcast_to(3.0 * lat - 100.0, field.grid.shape), atol=0.05
    )
    expected = np.broadcast_to(20.0 - 2.0 * (lon - middle), field.grid.shape)
    np.testing.assert_allclose(field.north_mps[0], expected, atol=0.05)
    np.testing.assert_allclose(field.east_mps[1] - field.east_mps[0], 6.0, atol=0.3)


@pytest.mark.parametrize("name", MAPS)
def test_wind_to_east_and_north_on_a_map_is_laid_on_latitudes_and_longitudes(name, tmp_path):
    data, middle = dataset(name, along_grid=False)
    data.to_netcdf(tmp_path / "map.nc")
    field = read_wind(tmp_path / "map.nc")
    assert_plane(field, middle)
    assert min(field.grid.shape) >= 5
    native_m = 6371229.0 * math.radians(
        float(np.hypot(*(np.diff(data[n].values, axis=0)[0, 0] for n in ("latitude", "longitude"))))
    )
    assert field.grid.north_cell_m[0] == pytest.approx(native_m, rel=0.5)


@pytest.mark.parametrize("name", MAPS)
def test_wind_along_a_maps_axes_is_turned_as_proj_turns_it(name, tmp_path):
    data, middle = dataset(name, along_grid=True)
    data.to_netcdf(tmp_path / "map.nc")
    field = read_wind(tmp_path / "map.nc")
    lat, lon = np.degrees(field.grid.lat_rad)[:, np.newaxis], np.degrees(field.grid.lon_rad)
    lon = lon + 360.0 * np.rint((middle - lon.mean()) / 360.0)
    np.testing.assert_allclose(
        field.east_mps[0], np.broadcast_to(3.0 * lat - 100.0, field.grid.shape), atol=0.3
    )
    np.testing.assert_allclose(
        field.north_mps[0], np.broadcast_to(20.0 - 2.0 * (lon - middle), field.grid.shape), atol=0.3
    )


@pytest.mark.parametrize("flip", ["x", "y"])
def test_a_map_that_is_stored_the_other_way_round_is_the_same(flip, tmp_path):
    data, _ = dataset("Lambert", along_grid=True)
    _, x, y = MAPS["Lambert"]
    data = data.assign_coords(x=("x", x), y=("y", y))
    data.to_netcdf(tmp_path / "map.nc")
    data.isel({flip: slice(None, None, -1)}).to_netcdf(tmp_path / "flipped.nc")
    straight, flipped = (read_wind(tmp_path / name) for name in ("map.nc", "flipped.nc"))
    np.testing.assert_allclose(straight.grid.lat_rad, flipped.grid.lat_rad)
    np.testing.assert_allclose(straight.east_mps, flipped.east_mps, atol=1e-6)
    np.testing.assert_allclose(straight.north_mps, flipped.north_mps, atol=1e-6)


def test_components_of_which_nobody_knows_the_axes_are_refused_until_it_is_said(tmp_path):
    data, middle = dataset("Lambert", along_grid=False, long_name="wind")
    data.to_netcdf(tmp_path / "map.nc")
    with pytest.raises(
        WeatherError, match=r'u and v lie on a map.s grid.*say weather\.wind_axes = "grid" or "earth"'
    ):
        read_wind(tmp_path / "map.nc")
    assert_plane(read_wind(tmp_path / "map.nc", reading=Reading(wind_axes="earth")), middle)
    turned = read_wind(tmp_path / "map.nc", reading=Reading(wind_axes="grid"))
    assert (
        np.abs(
            turned.east_mps - read_wind(tmp_path / "map.nc", reading=Reading(wind_axes="earth")).east_mps
        ).max()
        > 1.0
    )


def test_the_command_is_told_the_axes_as_a_scenario_is(tmp_path):
    data, _ = dataset("Lambert", along_grid=False, long_name="wind")
    data.to_netcdf(tmp_path / "map.nc")
    asked = [str(tmp_path / "map.nc"), "--save", str(tmp_path / "out.nc")]
    with pytest.raises(WeatherError, match="--wind-axes of `galeway weather`"):
        CliRunner().invoke(weather, asked, catch_exceptions=False)
    for axes in ("earth", "grid"):
        done = CliRunner().invoke(weather, [*asked, "--wind-axes", axes], catch_exceptions=False)
        assert done.exit_code == 0, done.output
        saved, read = (
            read_wind(tmp_path / "out.nc"),
            read_wind(tmp_path / "map.nc", reading=Reading(wind_axes=axes)),
        )
        np.testing.assert_allclose(saved.east_mps, read.east_mps, atol=1e-4)
    done = CliRunner().invoke(weather, ["ian", "--wind-axes", "grid"])
    assert done.exit_code == 2
    assert "--wind-axes belongs to files" in done.output


@given(south=st.floats(37.6, 38.4), west=st.floats(-94.5, -92.9), seed=st.integers(0, 9))
@settings(max_examples=15, deadline=None)
def test_an_area_of_a_map_agrees_with_xarrays_interpolation(south, west, seed, tmp_path_factory):
    path = tmp_path_factory.mktemp("map") / "map.nc"
    data, _ = dataset("Lambert", along_grid=False)
    data["u"][:] = np.random.default_rng(seed).normal(0.0, 10.0, data.u.shape)
    data.to_netcdf(path)
    bounds = [math.radians(value) for value in (south, south + 0.7, west, west + 0.9)]
    field = read_wind(path, reading=Reading(area_rad=tuple(bounds)))
    lat, lon = np.degrees(field.grid.lat_rad), np.degrees(field.grid.lon_rad)
    assert lat[0] == pytest.approx(south)
    assert lat[-1] == pytest.approx(south + 0.7)
    crs, x, y = MAPS["Lambert"]
    to_map = pyproj.Transformer.from_crs("+proj=longlat +R=6371229", crs, always_xy=True)
    x_m, y_m = to_map.transform(*np.meshgrid(lon, lat))
    at = {"x": xr.DataArray(x_m, dims=("r", "c")), "y": xr.DataArray(y_m, dims=("r", "c"))}
    expected = data.u.isel(time=0).assign_coords(x=x, y=y).interp(at)
    # Bilinear in rows and columns both; positions between rows differ by the map's curvature within a cell.
    np.testing.assert_allclose(field.east_mps[0], expected, atol=0.05)


def test_an_area_that_a_map_does_not_reach_is_refused(tmp_path):
    dataset("Lambert", along_grid=False)[0].to_netcdf(tmp_path / "map.nc")

    def asked(*bounds_deg):
        return Reading(area_rad=tuple(map(math.radians, bounds_deg)))

    with pytest.raises(WeatherError, match=r"does not reach \d+\.\d{3} N .* [EW]; choose an area inside"):
        read_wind(tmp_path / "map.nc", reading=asked(38.0, 41.0, -94.0, -93.0))
    with pytest.raises(WeatherError, match=r"and nothing in 50\.00 N to 51\.00 N"):
        read_wind(tmp_path / "map.nc", reading=asked(50.0, 51.0, -94.0, -93.0))


def test_a_map_on_its_edge_asks_for_an_area(tmp_path):
    turned = np.radians(45.0)
    y, x = np.mgrid[-10:11, -10:11] / 10.0
    data, _ = dataset("Lambert", along_grid=False)
    lat, lon = (
        40.0 + x * np.sin(turned) + y * np.cos(turned),
        5.0 + (x * np.cos(turned) - y * np.sin(turned)) / math.cos(0.7),
    )
    data = data.assign_coords(
        latitude=(("y", "x"), lat, {"units": "degrees_north"}),
        longitude=(("y", "x"), lon, {"units": "degrees_east"}),
    )
    data.to_netcdf(tmp_path / "map.nc")
    with pytest.raises(
        WeatherError, match=r"no rectangle .* fits between its edges; give the mission's area"
    ):
        read_wind(tmp_path / "map.nc")
    area = tuple(map(math.radians, (39.6, 40.4, 4.6, 5.4)))
    assert read_wind(tmp_path / "map.nc", reading=Reading(area_rad=area)).grid.rows > 5


def test_gaps_of_a_map_count_only_inside_the_area(tmp_path):
    data, _ = dataset("Lambert", along_grid=False)
    data["v"][1, 0, 0] = np.nan
    data.to_netcdf(tmp_path / "map.nc")
    inside = tuple(map(math.radians, (38.0, 39.0, -94.0, -92.0)))
    assert np.isfinite(read_wind(tmp_path / "map.nc", reading=Reading(area_rad=inside)).north_mps).all()
    data["v"][1, 10, 10] = np.nan
    data.to_netcdf(tmp_path / "holed.nc")
    with pytest.raises(WeatherError, match=r"the wind v has 4 gaps .* time 2024-05-01T01:00:00, lat 38"):
        read_wind(tmp_path / "holed.nc", reading=Reading(area_rad=inside))


def test_a_grib_file_along_a_lambert_grid_is_turned_as_proj_turns_it(grib):
    """As HRRR's files are: a wind of 10 m/s along the grid's x axis everywhere."""
    lambert = {
        "gridType": "lambert",
        "Nx": 20,
        "Ny": 15,
        "DxInMetres": 30000,
        "DyInMetres": 30000,
        "latitudeOfFirstGridPointInDegrees": 36.0,
        "longitudeOfFirstGridPointInDegrees": 250.0,
        "LaDInDegrees": 38.5,
        "LoVInDegrees": 262.5,
        "Latin1InDegrees": 38.5,
        "Latin2InDegrees": 38.5,
        "shapeOfTheEarth": 6,
        "jScansPositively": 1,
        "uvRelativeToGrid": 1,
        "dataDate": 20240501,
        "dataTime": 0,
        "stepRange": "1",
    }
    winds = (("10u", 10.0), ("10v", 0.0))
    messages = [lambert | {"shortName": name, "values": np.full((15, 20), value)} for name, value in winds]
    field = read_wind(grib("lambert.grib2", 2, messages))
    np.testing.assert_allclose(np.hypot(field.east_mps, field.north_mps), 10.0, rtol=1e-3)
    lon, lat = np.meshgrid(np.degrees(field.grid.lon_rad), np.degrees(field.grid.lat_rad))
    convergence = pyproj.Proj(LAMBERT).get_factors(lon, lat).meridian_convergence
    turn = np.degrees(np.arctan2(field.north_mps[0], field.east_mps[0]))
    np.testing.assert_allclose(turn, -convergence, atol=0.05)
