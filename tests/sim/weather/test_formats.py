"""One ensemble forecast, written with the real libraries in every format, must be read alike."""

import math
import shutil

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planner.tiled import is_tiled
from sim.errors import WeatherError
from sim.weather import lazy_wind
from sim.weather.files import Reading, read_members, read_values, read_wind
from sim.weather.opening import found_files

LAT_DEG = np.linspace(60.0, 57.0, 7)
LON_DEG = np.linspace(-4.0, 1.0, 11)
STEP_H = np.array([0, 3, 6])
MEMBERS = np.array([0, 1, 2, 3])
ISSUED = np.datetime64("2024-02-28T21:00", "ns")  # the steps reach into a leap day
TIME_S = 1709154000.0 + 3600.0 * STEP_H
WINDS = np.random.default_rng(8).normal(0.0, 9.0, (2, 4, 3, 7, 11)).astype(np.float32)


def ensemble() -> xr.Dataset:
    """Members x steps x latitudes (from the north) x longitudes, with a reference time and steps."""
    dims = ("number", "step", "latitude", "longitude")
    components = zip(("u10", "v10"), ("eastward_wind", "northward_wind"), WINDS, strict=True)
    return xr.Dataset(
        {name: (dims, wind, {"standard_name": what, "units": "m s-1"}) for name, what, wind in components},
        {
            "number": ("number", MEMBERS, {"standard_name": "realization"}),
            "step": ("step", STEP_H, {"standard_name": "forecast_period", "units": "hours"}),
            "time": ((), ISSUED, {"standard_name": "forecast_reference_time"}),
            "latitude": ("latitude", LAT_DEG, {"units": "degrees_north", "standard_name": "latitude"}),
            "longitude": ("longitude", LON_DEG, {"units": "degrees_east", "standard_name": "longitude"}),
        },
    )


def messages(**more):
    """The same as GRIB messages; the control run and the perturbed members are of different types."""
    for (component, member, step), name in np.ndenumerate(
        np.tile([["10u"], ["10v"]], (1, 12)).reshape(2, 4, 3)
    ):
        yield {
            "shortName": str(name),
            "dataDate": 20240228,
            "dataTime": 2100,
            "stepRange": str(STEP_H[step]),
            "lat_deg": LAT_DEG,
            "lon_deg": LON_DEG % 360.0,
            "values": WINDS[component, member, step],
        } | {key: value(member) if callable(value) else value for key, value in more.items()}


ENSEMBLE_2 = {
    "productDefinitionTemplateNumber": 1,
    "typeOfEnsembleForecast": lambda member: 1 if member == 0 else 3,
    "perturbationNumber": lambda member: int(member),
    "numberOfForecastsInEnsemble": 4,
}


@pytest.fixture
def write(tmp_path, grib):
    """Writes the ensemble: (format) -> the paths of its files."""

    def netcdf(kind):
        path = tmp_path / "ensemble.nc"
        ensemble().to_netcdf(path, engine="netcdf4", format=kind)
        return [path]

    def zarr(version):
        path = tmp_path / "ensemble.zarr"
        ensemble().to_zarr(path, zarr_format=version, consolidated=version == 2)
        return [path]

    def one_file_a_step():
        paths = [tmp_path / f"step_{hours}.nc" for hours in STEP_H]
        for path, hours in zip(paths, STEP_H, strict=True):
            ensemble().sel(step=hours).to_netcdf(path)
        return paths[::-1]

    def one_file_a_variable():
        for name in ("u10", "v10"):
            ensemble()[[name]].to_netcdf(tmp_path / f"{name}.nc")
        return [tmp_path / "u10.nc", tmp_path / "v10.nc"]

    made = {
        "NetCDF-3": lambda: netcdf("NETCDF3_CLASSIC"),
        "NetCDF-3 64 bit": lambda: netcdf("NETCDF3_64BIT"),
        "NetCDF-4": lambda: netcdf("NETCDF4"),
        "Zarr 2": lambda: zarr(2),
        "Zarr 3": lambda: zarr(3),
        "GRIB 2": lambda: [grib("ensemble.grib2", 2, messages(**ENSEMBLE_2))],
        "GRIB 1": lambda: [
            grib(
                "ensemble.grib",
                1,
                messages(localDefinitionNumber=1, type="pf", stream="enfo", number=int, totalNumber=4),
            )
        ],
        "a file a step": one_file_a_step,
        "a file a variable": one_file_a_variable,
    }
    return lambda kind: made[kind]()


FORMATS = pytest.mark.parametrize(
    "kind",
    [
        *("NetCDF-3", "NetCDF-3 64 bit", "NetCDF-4", "Zarr 2", "Zarr 3", "GRIB 2", "GRIB 1"),
        *("a file a step", "a file a variable"),
    ],
)


@FORMATS
def test_every_format_gives_the_same_members(kind, write, tmp_path):
    paths = write(kind)
    winds = read_members(paths)
    assert sorted(tmp_path.iterdir()) == sorted(paths)  # no index is left beside them
    assert winds.numbers == tuple(MEMBERS)
    assert winds.height_m is None
    np.testing.assert_array_equal(winds.time_s, TIME_S)
    np.testing.assert_allclose(np.degrees(winds.grid.lat_rad), LAT_DEG[::-1], atol=1e-6)
    off_deg = np.degrees(winds.grid.lon_rad) - LON_DEG
    np.testing.assert_allclose(off_deg, 360.0 * np.rint(off_deg[0] / 360.0), atol=1e-6)
    np.testing.assert_allclose(winds.east_mps, WINDS[0, :, :, ::-1], atol=1e-4)
    np.testing.assert_allclose(winds.north_mps, WINDS[1, :, :, ::-1], atol=1e-4)


def test_a_member_or_the_mean_of_all_is_flown(write):
    paths = write("NetCDF-4")
    np.testing.assert_allclose(read_wind(paths).east_mps, WINDS[0].mean(axis=0)[:, ::-1], atol=1e-5)
    np.testing.assert_array_equal(read_wind(paths, member=2).north_mps, WINDS[1, 2, :, ::-1])
    with pytest.raises(WeatherError, match='it has the members 0 to 3, not 4; choose one, or "mean"'):
        read_wind(paths, member=4)


@pytest.mark.parametrize("kind", ["NetCDF-3", "Zarr 3", "GRIB 2", "a file a step"])
def test_what_is_too_large_for_memory_is_read_later_from_every_format(kind, write, monkeypatch):
    paths = write(kind)
    there = read_members(paths)
    monkeypatch.setattr(lazy_wind, "LARGE_BYTES", 0)
    mean, one = read_wind(paths), read_wind(paths, member=2)
    assert is_tiled(mean.north_mps)
    np.testing.assert_allclose(mean.east_mps[:], there.east_mps.mean(axis=0), atol=1e-6)
    np.testing.assert_array_equal(one.north_mps[1:, 2:4], there.north_mps[2, 1:, 2:4])


def test_gaps_of_a_grib_file_are_gaps(grib):
    holed = list(messages(**ENSEMBLE_2))
    holed[5]["values"] = holed[5]["values"].copy()
    holed[5]["values"][2, 3] = np.nan
    with pytest.raises(
        WeatherError, match=r"u10 has 1 gaps .* at member 1, time 2024-02-29T03:00:00, lat 59, "
    ):
        read_members(grib("holed.grib2", 2, holed))
    holed = [message for number, message in enumerate(messages(**ENSEMBLE_2)) if number != 5]
    with pytest.raises(WeatherError, match=r"gaps .* at member 1, time 2024-02-29T03:00:00"):
        read_members(grib("missing.grib2", 2, holed))


def test_any_variable_can_be_read_by_name(write):
    values = read_values(
        write("NetCDF-4"), "v10", reading=Reading(area_rad=tuple(map(math.radians, (58, 59, -2, 0))))
    )
    assert values.unit == "m s-1"
    assert values.levels.describe() == "10 m above ground"
    np.testing.assert_allclose(values.values[:, :, 0], WINDS[1, :, :, 4:1:-1, 4:9], atol=1e-4)
    with pytest.raises(WeatherError, match="it lacks rain and has u10"):
        read_values(write("NetCDF-4"), "rain")


def test_patterns_and_lists_of_names(write, tmp_path):
    paths = write("a file a step")
    assert found_files("step_*.nc", tmp_path) == tuple(sorted(paths))
    assert found_files(["step_6.nc", "step_*.nc"], tmp_path) == (tmp_path / "step_6.nc", *sorted(paths)[:2])
    with pytest.raises(WeatherError, match=r"no weather files match .*gfs_\*\.nc; check the path"):
        found_files("gfs_*.nc", tmp_path)
    with pytest.raises(WeatherError, match=r"there is no weather file .*gfs\.nc; check the path"):
        found_files(["gfs.nc"], tmp_path)


def test_files_that_do_not_belong_together_are_refused(tmp_path):
    data, path, other = ensemble(), tmp_path / "a.nc", tmp_path / "b.nc"
    data.to_netcdf(path)

    def refused(change: xr.Dataset, message: str) -> None:
        change.to_netcdf(other)
        with pytest.raises(WeatherError, match=rf"(?s)a\.nc, .*b\.nc cannot be used: .*{message}"):
            read_members([path, other])

    refused(data.isel(step=[1]), r"found twice, as u10 in a\.nc and as u10 in b\.nc, at 2024-02-29T00:00:00")
    later = data.assign_coords(time=data.time + np.timedelta64(6, "h"))
    later.time.attrs["standard_name"] = "forecast_reference_time"
    refused(later, r"a\.nc is of the forecast of 2024-02-28T21:00:00, b\.nc of that of 2024-02-29T03:00:00")
    knots = data.isel(step=[1]).assign_coords(step=("step", [9], data.step.attrs))
    knots["u10"].attrs["units"] = "kt"
    refused(knots, r"u10 has the unit 'm s-1' in a\.nc, but the unit 'kt' in b\.nc; convert one")
    finer = data.isel(latitude=slice(0, 5))
    refused(finer, r"lies on 7 x 11 points .* in a\.nc, but on 5 x 11 points")
    longer = data.isel(number=[0]).assign_coords(step=("step", STEP_H + 9, data.step.attrs))
    refused(
        longer,
        r"has nothing for 9 of 24 combinations .* the first at member 1, 2024-02-29T06:00:00, 10 m above",
    )


@pytest.mark.parametrize(
    ("kind", "rounds"),
    [
        *(("NetCDF-3", 24), ("NetCDF-4", 24), ("Zarr 3", 24), ("GRIB 2", 2)),
        pytest.param("GRIB 2", 100, marks=pytest.mark.slow),
        pytest.param("GRIB 1", 100, marks=pytest.mark.slow),
        pytest.param("NetCDF-4", 500, marks=pytest.mark.slow),
    ],
)
def test_broken_files_end_in_one_message(kind, rounds, write, tmp_path):
    (path,) = write(kind)
    whole = tmp_path / "whole"
    (shutil.copytree if path.is_dir() else shutil.copy)(path, whole)
    victims = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    generator = np.random.default_rng(3)
    refused = []
    for round_number in range(rounds):
        victim = victims[round_number % len(victims)]
        source = whole / victim.relative_to(path) if path.is_dir() else whole
        content = bytearray(source.read_bytes())
        if round_number % 2:
            content = content[: int(generator.integers(0, len(content)))]
        else:
            for place in generator.integers(0, len(content), 1 + len(content) // 400):
                content[place] ^= int(generator.integers(1, 256))
        victim.write_bytes(bytes(content))
        try:
            read_members(path)
        except WeatherError as error:
            refused.append(str(error))
        victim.write_bytes(source.read_bytes())
    assert len(refused) >= max(rounds // 3, 1)
    assert all(path.name in message and "\n" not in message for message in refused)


@pytest.mark.parametrize(
    ("kind", "module", "extra"), [("GRIB 2", "cfgrib", "grib"), ("Zarr 3", "zarr", "zarr")]
)
def test_a_missing_extra_is_one_message_with_the_command(kind, module, extra, write, monkeypatch):
    paths = write(kind)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == module else name)
    with pytest.raises(WeatherError, match=rf"needs {module} to be read; pip install 'galeway\[{extra}\]'"):
        read_members(paths)


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    order=st.permutations(["number", "step", "latitude", "longitude"]),
    flips=st.tuples(st.booleans(), st.booleans()),
    turn=st.sampled_from([-180.0, 0.0, 90.0, 180.0, 360.0]),
    unit=st.sampled_from([("m s-1", 1.0), ("kt", 3600.0 / 1852.0), ("km/h", 3.6)]),
    packed=st.booleans(),
)
def test_however_it_is_laid_out_the_wind_is_the_same(order, flips, turn, unit, packed, tmp_path):
    """xarray's own answer for a point is the oracle; turned longitudes reach across the date line."""
    data = ensemble()
    for name in ("u10", "v10"):
        data[name] = (data[name] * unit[1]).assign_attrs(data[name].attrs, units=unit[0])
    lon_deg = (LON_DEG + turn + 180.0) % 360.0 - 180.0
    laid = data.assign_coords(longitude=("longitude", lon_deg, data.longitude.attrs)).transpose(*order)
    laid = laid.isel(
        {
            name: slice(None, None, -1)
            for name, flip in zip(("latitude", "longitude"), flips, strict=True)
            if flip
        }
    )
    encoding = {"dtype": "int32", "scale_factor": 1e-4, "_FillValue": -(2**31)} if packed else {}
    path = tmp_path / "laid.nc"
    laid.to_netcdf(path, encoding={"u10": encoding, "v10": encoding})
    field = read_wind(path, member=3)
    point = {"latitude": 58.3, "longitude": -1.7}
    expected = ensemble().sel(number=3).assign_coords(step=STEP_H).interp(step=4.0, **point)
    wind = field.at(TIME_S[0] + 4 * 3600.0, math.radians(58.3), math.radians(-1.7 + turn))
    assert wind.east_mps == pytest.approx(float(expected.u10), abs=2e-3)
    assert wind.north_mps == pytest.approx(float(expected.v10), abs=2e-3)


@settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    cuts=st.tuples(st.sets(st.integers(1, 3)), st.sets(st.integers(1, 2))),
    by_variable=st.booleans(),
    shuffled=st.randoms(use_true_random=False),
)
def test_however_a_forecast_is_cut_into_files_it_is_the_same(cuts, by_variable, shuffled, tmp_path):
    paths = []
    for members in np.split(np.arange(4), sorted(cuts[0])):
        for steps in np.split(np.arange(3), sorted(cuts[1])):
            for names in [["u10"], ["v10"]] if by_variable else [["u10", "v10"]]:
                paths.append(tmp_path / f"part_{len(paths)}.nc")
                ensemble()[names].isel(number=members, step=steps).to_netcdf(paths[-1])
    shuffled.shuffle(paths)
    winds = read_members(paths)
    assert winds.numbers == tuple(MEMBERS)
    np.testing.assert_array_equal(winds.time_s, TIME_S)
    np.testing.assert_array_equal(winds.east_mps, WINDS[0, :, :, ::-1])
    np.testing.assert_array_equal(winds.north_mps, WINDS[1, :, :, ::-1])
