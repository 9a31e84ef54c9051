"""Wind files: one wind written in many ways must be read alike, and what cannot be used be refused."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from planner.windfield import WindField
from sim.errors import WeatherError
from sim.weather.files import Reading, read_wind

TIMES = np.array(["2022-09-29T00", "2022-09-29T03", "2022-09-29T09"], dtype="datetime64[ns]")
TIME_S = 1664409600.0 + 3600.0 * np.array([0.0, 3.0, 9.0])
LAT_DEG = np.linspace(20.0, 24.0, 9)
LON_DEG = np.linspace(-90.0, -84.0, 13)
HEIGHT_M = np.array([10.0, 100.0, 1000.0])
AXES = {
    "time": {"standard_name": "time"},
    "height": {"standard_name": "height", "units": "m", "positive": "up"},
    "lat": {"standard_name": "latitude", "units": "degrees_north"},
    "lon": {"standard_name": "longitude", "units": "degrees_east"},
}
HOURS = {"units": "hours since 2022-09-29", "dtype": "int32"}


def winds(*, layers: bool = False, upward: bool = False) -> xr.Dataset:
    """The wind that all files hold."""
    coordinates = {"time": TIMES, "height": HEIGHT_M, "lat": LAT_DEG, "lon": LON_DEG}
    dims = [name for name in coordinates if layers or name != "height"]
    shape = [len(coordinates[name]) for name in dims]
    values = np.random.default_rng(5).normal(0.0, 10.0, (3, *shape)).astype(np.float32)
    names = {"u": "eastward_wind", "v": "northward_wind"} | ({"w": "upward_air_velocity"} if upward else {})
    return xr.Dataset(
        {
            name: (dims, array, {"standard_name": standard_name, "units": "m s-1"})
            for (name, standard_name), array in zip(names.items(), values, strict=False)
        },
        {name: (name, coordinates[name], AXES[name]) for name in dims},
    )


def written(folder: Path, dataset: xr.Dataset, time: dict[str, Any] = HOURS, **encoding: Any) -> Path:
    path = folder / "wind.nc"
    dataset.to_netcdf(path, engine="netcdf4", encoding={"time": time, **encoding})
    return path


def assert_same(field: WindField, dataset: xr.Dataset, atol: float = 1e-5) -> None:
    """The field is the wind of a dataset as `winds` makes it."""
    np.testing.assert_allclose(field.time_s, TIME_S, atol=1e-6)
    np.testing.assert_allclose(np.degrees(field.grid.lat_rad), LAT_DEG, atol=1e-6)
    np.testing.assert_allclose(np.degrees(field.grid.lon_rad), LON_DEG, atol=1e-5)  # -180 to 180, as plans
    np.testing.assert_allclose(field.east_mps, dataset["u"].values, atol=atol)
    np.testing.assert_allclose(field.north_mps, dataset["v"].values, atol=atol)


def in_unit(data: xr.Dataset, unit: str, factor: float) -> xr.Dataset:
    return data.assign(
        {name: (data[name] * factor).assign_attrs(data[name].attrs, units=unit) for name in ("u", "v")}
    )


VARIANTS: dict[str, Callable[[xr.Dataset], xr.Dataset]] = {
    "as it is": lambda data: data,
    "north to south": lambda data: data.isel(lat=slice(None, None, -1)),
    "east to west": lambda data: data.isel(lon=slice(None, None, -1)),
    "0 to 360": lambda data: data.assign_coords(lon=("lon", LON_DEG % 360.0, AXES["lon"])),
    "dimensions in another order": lambda data: data.transpose("lon", "lat", "time"),
    "float32 axes": lambda data: data.assign_coords(
        lat=("lat", LAT_DEG.astype(np.float32), AXES["lat"]),
        lon=("lon", LON_DEG.astype(np.float32), AXES["lon"]),
    ),
    "knots": lambda data: in_unit(data, "kt", 3600.0 / 1852.0),
    "km/h": lambda data: in_unit(data, "km/h", 3.6),
    "a member axis of one": lambda data: data.expand_dims(number=[7]),
    "a height axis of one": lambda data: data.expand_dims(height=[10.0]),
    "names only": lambda data: data.rename(u="u10", v="v10").map(
        lambda values: values.assign_attrs(standard_name="")
    ),
    "x_wind and y_wind": lambda data: data.rename(u="a", v="b").assign(
        a=lambda d: d.a.assign_attrs(standard_name="x_wind"),
        b=lambda d: d.b.assign_attrs(standard_name="y_wind"),
    ),
    "axes known by their units": lambda data: data.rename(lat="y", lon="x").assign_coords(
        y=("y", LAT_DEG, {"units": "degrees_north"}), x=("x", LON_DEG, {"units": "degrees_east"})
    ),
    "axes known by their names": lambda data: data.rename(lat="latitude", lon="longitude").assign_coords(
        latitude=LAT_DEG, longitude=LON_DEG
    ),
    "latitude along another dimension": lambda data: (
        data.rename_dims(lat="y").reset_index("lat").set_coords("lat")
    ),
    "spaces around words": lambda data: in_unit(data, " m s-1 ", 1.0),
    "another time": lambda data: data.assign_coords(
        forecast_reference_time=((), TIMES[0], {"standard_name": "forecast_reference_time"})
    ),
    "pressure velocity beside": lambda data: data.assign(
        w=data.u.assign_attrs(standard_name="lagrangian_tendency_of_air_pressure", units="Pa s-1")
    ),
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_one_wind_written_in_many_ways_is_read_alike(variant: str, tmp_path: Path) -> None:
    field = read_wind(written(tmp_path, VARIANTS[variant](winds())))
    assert_same(field, winds())
    assert field.height_m is None
    assert field.down_mps is None


@pytest.mark.parametrize(
    "time",
    [
        {"units": "hours since 1900-01-01", "dtype": "float64"},
        {"units": "hours since 2022-09-28 12:00", "dtype": "float32"},
        {"units": "days since 2022-09-29", "dtype": "float64"},
        {"units": "days since 2022-09-29", "dtype": "float32"},
        {"units": "minutes since 2022-09-01 00:00:00", "dtype": "int64"},
        {"units": "seconds since 1970-01-01", "dtype": "int64", "calendar": "gregorian"},
    ],
    ids=lambda time: f"{time['units']} as {time['dtype']}",
)
def test_any_time_unit_will_do(time: dict[str, Any], tmp_path: Path) -> None:
    assert_same(read_wind(written(tmp_path, winds(), time)), winds())


def test_packed_values_are_unpacked(tmp_path: Path) -> None:
    packed = {"dtype": "int16", "scale_factor": 0.01, "add_offset": 1.0, "_FillValue": -32768}
    assert_same(read_wind(written(tmp_path, winds(), u=packed, v=packed)), winds(), atol=0.006)


@pytest.mark.parametrize("flip", [False, True])
def test_heights_and_upward_wind_are_taken_along(flip: bool, tmp_path: Path) -> None:
    data = winds(layers=True, upward=True)
    field = read_wind(written(tmp_path, data.isel(height=slice(None, None, -1)) if flip else data), hold=True)
    assert_same(field, data)
    assert field.hold
    assert field.height_m is not None
    np.testing.assert_array_equal(field.height_m, HEIGHT_M)
    assert field.down_mps is not None
    np.testing.assert_allclose(field.down_mps, -data["w"].values)
    assert field.down_mps.dtype == np.float32


def test_heights_in_kilometres_become_metres(tmp_path: Path) -> None:
    attributes = AXES["height"] | {"units": "km"}
    data = winds(layers=True).assign_coords(height=("height", HEIGHT_M / 1000.0, attributes))
    field = read_wind(written(tmp_path, data))
    assert field.height_m is not None
    np.testing.assert_allclose(field.height_m, HEIGHT_M)


def test_a_single_time_without_an_axis_is_a_field_of_one_time(tmp_path: Path) -> None:
    base = xr.Variable((), TIMES[0], {"standard_name": "forecast_reference_time"})
    field = read_wind(written(tmp_path, winds().isel(time=1).assign_coords(base=base, time_of_base=base)))
    np.testing.assert_allclose(field.time_s, TIME_S[1:2])
    np.testing.assert_allclose(field.north_mps, winds()["v"].values[1:2])


def test_the_wanted_pair_is_read_where_there_are_several(tmp_path: Path) -> None:
    data = winds()
    data = data.assign(u100=2.0 * data.u, v100=(2.0 * data.v).assign_attrs(data.v.attrs))
    data["u100"].attrs = data.u.attrs
    path = written(tmp_path, data)
    with pytest.raises(
        WeatherError, match=r"several winds \(u \(eastward_wind\), v \(northward_wind\), u100"
    ):
        read_wind(path)
    field = read_wind(path, reading=Reading(("u100", "v100")))
    np.testing.assert_allclose(field.east_mps, 2.0 * data.u.values)
    with pytest.raises(WeatherError, match="lacks the winds u7 and v7 and has u "):
        read_wind(path, reading=Reading(("u7", "v7")))


def area(south: float, north: float, west: float, east: float) -> tuple[float, float, float, float]:
    return math.radians(south), math.radians(north), math.radians(west), math.radians(east)


@pytest.mark.parametrize("turn_deg", [0.0, 360.0])
def test_an_area_is_cut_out_with_the_cells_around_it(turn_deg: float, tmp_path: Path) -> None:
    field = read_wind(
        written(tmp_path, winds()),
        reading=Reading(area_rad=area(21.2, 22.0, -88.1 + turn_deg, -85.7 + turn_deg)),
    )
    np.testing.assert_allclose(np.degrees(field.grid.lat_rad), [21.0, 21.5, 22.0])
    np.testing.assert_allclose(np.degrees(field.grid.lon_rad) - turn_deg, np.arange(-88.5, -85.4, 0.5))
    np.testing.assert_array_equal(field.north_mps, winds()["v"].values[:, 2:5, 3:10])


@pytest.mark.parametrize("last_deg", [359.0, 360.0])
def test_an_area_across_the_end_of_the_longitudes_is_cut_out_whole(last_deg: float, tmp_path: Path) -> None:
    lon_deg = np.arange(0.0, last_deg + 0.5)
    values = np.broadcast_to(np.sin(np.radians(lon_deg)), (3, 9, lon_deg.size))
    data = xr.Dataset(
        {
            name: (("time", "lat", "lon"), values, winds()[name].attrs | {"units": "m s-1"})
            for name in ("u", "v")
        },
        {"time": ("time", TIMES), "lat": ("lat", LAT_DEG, AXES["lat"]), "lon": ("lon", lon_deg, AXES["lon"])},
    )
    field = read_wind(written(tmp_path, data), reading=Reading(area_rad=area(20.0, 24.0, -5.0, 5.0)))
    np.testing.assert_allclose(np.degrees(field.grid.lon_rad), np.arange(-5.0, 5.5), atol=1e-9)
    np.testing.assert_allclose(field.east_mps[0, 0], np.sin(field.grid.lon_rad), atol=1e-9)


def test_longitudes_that_jump_at_the_date_line_are_joined(tmp_path: Path) -> None:
    lon_deg = np.arange(177.0, 183.5, 0.5)
    data = winds().assign_coords(
        lon=("lon", np.where(lon_deg > 180.0, lon_deg - 360.0, lon_deg), AXES["lon"])
    )
    field = read_wind(written(tmp_path, data))
    np.testing.assert_allclose(np.degrees(field.grid.lon_rad), lon_deg)
    np.testing.assert_array_equal(field.east_mps, winds()["u"].values)


def test_steps_that_differ_a_little_are_made_even(tmp_path: Path) -> None:
    lat_deg = np.linspace(20.0, 24.0, 9) + 0.1 * np.sin(np.linspace(0.0, math.pi, 9))
    slope = np.broadcast_to(3.0 * lat_deg[:, np.newaxis] + LON_DEG, (3, 9, 13))
    data = winds().assign_coords(lat=("lat", lat_deg, AXES["lat"]))
    data["u"][:] = slope
    field = read_wind(written(tmp_path, data))
    expected = 3.0 * np.degrees(field.grid.lat_rad)[:, np.newaxis] + LON_DEG
    np.testing.assert_allclose(
        field.east_mps[0], expected, atol=1e-4
    )  # linear in latitude: interpolation is exact


def gap(data: xr.Dataset) -> xr.Dataset:
    data["v"][1, 2, 3] = data["v"][2, 0, 12] = np.nan
    return data


REFUSED: dict[str, tuple[Callable[[xr.Dataset], xr.Dataset], str]] = {
    "no winds": (lambda d: d.drop_vars("v"), r"lacks an east and a north wind and has u \(eastward_wind\)"),
    "nothing": (lambda d: d.drop_vars(["u", "v"]), "has no variables at all"),
    "unit": (
        lambda d: d.assign(u=d.u.assign_attrs(units="furlong/h")),
        "wind u has the unit 'furlong/h'.*m s-1",
    ),
    "no unit": (
        lambda d: d.assign(v=d.v.drop_attrs()).rename(),
        "wind v has no unit; it must be one of m s-1, kt, km h-1",
    ),
    "upward unit": (
        lambda d: d.assign(w=d.u.assign_attrs(standard_name="upward_air_velocity", units="Pa s-1")),
        "wind w has the unit 'Pa s-1'",
    ),
    "a number for a unit": (
        lambda d: d.assign(u=d.u.assign_attrs(units=np.array([1, 2]))),
        r"wind u has the unit '\[1 2\]'",
    ),
    "gaps": (
        gap,
        "v has 2 gaps .* among 351 values, the first at time 2022-09-29T03:00:00, lat 21, lon -88.5; fill",
    ),
    "uneven": (
        lambda d: d.isel(lon=[0, 1, 2, 3, 4, 6, 8, 10]),
        "its longitude has steps from 0.5 to 1 deg.*regrid it",
    ),
    "one row": (lambda d: d.isel(lat=[4]), "its latitude has one value"),
    "falling time": (lambda d: d.isel(time=[1, 0, 2]), r"times time must rise, but number 1 \(2022-09-29T00"),
    "doubled time": (lambda d: d.isel(time=[0, 1, 1]), "times time must rise, but number 2"),
    "no time": (lambda d: d.isel(time=0, drop=True), "lacks a time axis"),
    "no longitude": (lambda d: d.isel(lon=0, drop=True), "needs one longitude.*has none"),
    "an axis of nothing known": (
        lambda d: xr.concat([d, d], "scenario"),
        "axis 'scenario' of 2 values .no unit.*select one",
    ),
    "depths": (
        lambda d: xr.concat([d, d], xr.Variable("z", [0.0, 5.0], {"units": "m", "standard_name": "depth"})),
        r"axis 'z' of 2 values \(unit 'm'\) that is neither",
    ),
    "different axes": (
        lambda d: d.assign(v=d.v.isel(time=[0, 1]).rename(time="t")),
        "u and v lie on different axes",
    ),
    "beyond the pole": (
        lambda d: d.assign_coords(lat=("lat", LAT_DEG + 70.0, AXES["lat"])),
        "between the poles",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_refused_with_the_reason(name: str, tmp_path: Path) -> None:
    change, message = REFUSED[name]
    data = change(winds())
    path = tmp_path / "wind.nc"
    data.to_netcdf(path, engine="netcdf4", encoding={"time": HOURS} if "time" in data.variables else {})
    with pytest.raises(WeatherError, match=rf"(?s)wind\.nc cannot be used: .*{message}"):
        read_wind(path)


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        (
            {"units": "hours since 2022-09-29", "calendar": "360_day"},
            "calendar '360_day'; it must be one of standard",
        ),
        (
            {"units": "fortnights since 2022-09-29"},
            "unit 'fortnights since 2022-09-29', which makes no sense",
        ),
        ({"units": "hours since yesterday"}, "unit 'hours since yesterday', which makes no sense"),
        ({"units": "h"}, "lacks a time axis"),
    ],
)
def test_times_that_make_no_sense_are_refused(
    attributes: dict[str, str], message: str, tmp_path: Path
) -> None:
    data = winds().assign_coords(time=("time", [0, 3, 9], attributes))
    path = tmp_path / "wind.nc"
    data.to_netcdf(path, engine="netcdf4")
    with pytest.raises(WeatherError, match=message):
        read_wind(path)


def test_gaps_outside_the_area_do_no_harm(tmp_path: Path) -> None:
    path = written(tmp_path, gap(winds()))
    assert read_wind(path, reading=Reading(area_rad=area(22.0, 24.0, -90.0, -85.0))).grid.rows == 5
    with pytest.raises(
        WeatherError, match=r"its latitude runs from 20\.000 to 24\.000.*choose an area inside"
    ):
        read_wind(path, reading=Reading(area_rad=area(30.0, 31.0, -90.0, -85.0)))


def test_missing_files_and_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(WeatherError, match=r"no weather file .*nothing\.nc; check the path"):
        read_wind(tmp_path / "nothing.nc")
    text = tmp_path / "text.nc"
    text.write_text("not a NetCDF file")
    with pytest.raises(
        WeatherError, match=r"text\.nc begins with b.not a Ne., which is neither NetCDF, GRIB nor Zarr"
    ):
        read_wind(text)
