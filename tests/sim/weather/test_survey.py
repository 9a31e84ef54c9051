"""What `galeway weather` says of files, against xarray's own answers."""

import json
import math
import sys

import numpy as np
import pytest
import xarray as xr

from sim.cli import main
from sim.weather.files import Reading
from sim.weather.survey import survey
from sim.weather.survey_text import survey_json, survey_text

LAT_DEG, LON_DEG = np.linspace(50.0, 53.0, 7), np.linspace(-2.0, 2.0, 9)
HOURS = np.array([0, 1, 4, 5, 6])
WIND = np.random.default_rng(6).normal(0.0, 11.0, (2, 3, 5, 2, 7, 9)).astype(np.float32)


def ensemble():
    dims = ("number", "time", "height", "latitude", "longitude")
    return xr.Dataset(
        {
            n: (dims, part.copy(), {"units": "m s-1", "long_name": f"wind {n}"})
            for n, part in zip("uv", WIND, strict=True)
        },
        {
            "number": [1, 2, 3],
            "time": np.datetime64("2024-02-28T22:00", "ns") + HOURS * np.timedelta64(1, "h"),
            "height": ("height", [10.0, 100.0], {"units": "m", "positive": "up"}),
            "latitude": ("latitude", LAT_DEG, {"units": "degrees_north"}),
            "longitude": ("longitude", LON_DEG, {"units": "degrees_east"}),
        },
    )


@pytest.fixture
def path(tmp_path):
    data = ensemble()
    data["t2m"] = data.u.isel(height=0, drop=True).assign_attrs(units="K", long_name="temperature")
    data.to_netcdf(tmp_path / "wind.nc")
    return tmp_path / "wind.nc"


def test_what_a_file_holds(path):
    found = survey([path])
    quantity = found.quantity
    assert found.files == ((str(path), "NetCDF-4"),)
    taken = {seen.name: seen.taken_for for seen in found.variables}
    assert taken == {"u": "eastward wind", "v": "northward wind", "t2m": None}
    assert found.flyable
    assert quantity.kind == "wind"
    assert quantity.area_deg == (50.0, 53.0, -2.0, 2.0)
    assert quantity.points == (7, 9)
    assert quantity.spacing_km == pytest.approx((55.6, 34.7), abs=0.2)
    assert quantity.members == (1, 2, 3)
    assert quantity.height_m == (10.0, 100.0)
    assert [(end - begin) / 3600.0 for begin, end in quantity.gaps_s] == [3.0]
    assert quantity.missing == 0


def test_speeds_are_numpys(path):
    speed = np.hypot(*WIND.astype(float))
    for level, said in enumerate(survey([path]).quantity.speeds):
        here = speed[:, :, level]
        assert said.mean_mps == pytest.approx(here.mean())
        assert said.highest_mps == pytest.approx(here.max())
        assert said.p95_mps == pytest.approx(np.percentile(here, 95), abs=0.3)


def test_shares_by_stage_are_those_of_xarrays_interpolation(path):
    """Over the threshold at the ends of a stage or at a time of the file within; not known in gaps."""
    data = ensemble()
    begin = data.time.values[0]
    stages = survey([path], threshold_mps=12.0).quantity.stages
    assert len(stages) == 6
    for number, stage in enumerate(stages):
        ends = [begin + np.timedelta64(60 * minutes, "s") for minutes in (60 * number, 60 * number + 60)]
        at = data.interp(time=np.array(ends))
        over = (np.hypot(at.u, at.v) > 12.0).any("time")
        expected = over.mean(("number", "latitude", "longitude")).values
        if 1 <= number < 4:
            expected = [math.nan] * len(expected)
        np.testing.assert_allclose(stage.over, expected, atol=1e-9)
        assert stage.begin_s == pytest.approx(ends[0].astype("datetime64[s]").astype(int))


def test_a_time_within_a_stage_counts(tmp_path):
    values = np.zeros((3, 2, 2))
    values[1, 0, 0] = 20.0  # half past, calm at both ends of the hour
    data = ensemble().isel(number=0, height=0, latitude=[0, 1], longitude=[0, 1]).isel(time=[0, 1, 2])
    data = data.assign_coords(time=data.time.values[0] + np.array([0, 30, 60]) * np.timedelta64(1, "m"))
    data["u"][:], data["v"][:] = values, 0.0 * values
    data.to_netcdf(tmp_path / "wind.nc")
    (stage,) = survey([tmp_path / "wind.nc"]).quantity.stages
    assert stage.over == (0.25,)


def test_gaps_are_counted_and_keep_a_flight_out_until_an_area_is_chosen(tmp_path):
    data = ensemble()
    data["u"][1, 2, 0, 6, 8] = np.nan
    data.to_netcdf(tmp_path / "wind.nc")
    found = survey([tmp_path / "wind.nc"])
    assert (found.quantity.missing, found.quantity.values) == (1, WIND[0].size)
    assert not found.flyable
    assert "1 values are missing: choose an area" in found.why_not
    area = tuple(np.radians([50.0, 52.0, -2.0, 1.0]))
    assert survey([tmp_path / "wind.nc"], reading=Reading(area_rad=area)).flyable


def test_a_fill_value_that_is_not_declared_keeps_a_flight_out(tmp_path):
    data = ensemble()
    data["u"][0, 0, 0, 0, 0] = 9999.0
    data.to_netcdf(tmp_path / "wind.nc")
    found = survey([tmp_path / "wind.nc"])
    assert not found.flyable
    assert "a wind of 1e+04 m/s (limit 150 m/s)" in found.why_not


def test_a_gust_alone_says_what_can_and_cannot_be_done(tmp_path):
    gust = np.hypot(ensemble().u, ensemble().v).isel(height=0, drop=True)
    gust.attrs = {"units": "kt", "standard_name": "wind_speed_of_gust"}
    gust.to_dataset(name="g").to_netcdf(tmp_path / "gust.nc")
    found = survey([tmp_path / "gust.nc"])
    assert not found.flyable
    text = survey_text(found)
    assert "flying    no: it has the speed of the wind (g) and not its direction" in text
    assert "hazard    gust speed over a threshold, by 3 members" in text
    assert found.quantity.speeds[0].highest_mps == pytest.approx(float(gust.max()) * 1852.0 / 3600.0)


def test_a_file_without_wind_says_so(tmp_path):
    ensemble()[["u"]].rename(u="t2m").to_netcdf(tmp_path / "warm.nc")
    found = survey([tmp_path / "warm.nc"])
    assert found.quantity is None
    assert "flying    no: it lacks an east and a north wind and has t2m (wind u)" in survey_text(found)
    json.loads(survey_json(found))


def test_the_text_and_the_json_say_the_same(path):
    found = survey([path])
    text, parsed = survey_text(found), json.loads(survey_json(found))
    for line in (
        f"{path} (NetCDF-4)",
        "t2m       nothing (temperature)  K",
        "area      50.00 N to 53.00 N, 2.00 W to 2.00 E; 7 x 9 points, 55.6 x 34.6 km apart",
        "times     2024-02-28T22:00:00 to 2024-02-29T04:00:00 UTC, 5 times, every 1 h but for gaps",
        "gaps      2024-02-28T23:00:00 to 2024-02-29T02:00:00",
        "levels    10, 100 m above ground; taken for heights above the sea",
        "members   3, 1 to 3",
        "flying    yes",
    ):
        assert line in text
    assert parsed["quantity"]["time_s"][-1] == "2024-02-29T04:00:00Z"
    assert parsed["quantity"]["stages"][1]["begin_s"] == "2024-02-28T23:00:00Z"
    assert parsed["flyable"] is True


@pytest.mark.parametrize(
    ("turned_deg", "told"), [(360.0, "2.00 W to 2.00 E"), (179.0, "177.00 E to 179.00 W")]
)
def test_an_area_is_told_east_and_west_of_greenwich(turned_deg, told, tmp_path):
    data = ensemble()
    data["longitude"] = data.longitude + turned_deg
    data.to_netcdf(tmp_path / "wind.nc")
    assert f" 53.00 N, {told};" in survey_text(survey([tmp_path / "wind.nc"]))


def beside(data, tmp_path, **more):
    """What is left out of a file that has more variables, by name."""
    data.assign(more).to_netcdf(tmp_path / "wind.nc")
    found = survey([tmp_path / "wind.nc"])
    left_out = {seen.name: seen.left_out for seen in found.variables if seen.left_out}
    assert all(f"\n{name}: left out; {why}\n" in survey_text(found) for name, why in left_out.items())
    return left_out


def test_a_second_variable_of_a_role_is_told_as_left_out(tmp_path):
    data = ensemble()
    other = data.u.isel(latitude=[0, 2, 4], longitude=[1, 3, 5]).rename(latitude="lat2", longitude="lon2")
    eastward = {"units": "m s-1", "standard_name": "eastward_wind"}
    assert beside(data, tmp_path, other=other.assign_attrs(eastward)) == {"other": "the wind is u with v"}


def test_upward_winds_that_are_not_taken_are_told(tmp_path):
    data, upward = ensemble(), {"units": "m s-1", "standard_name": "upward_air_velocity"}
    rising = data.u.assign_attrs(upward)
    assert beside(data, tmp_path, w=rising) == {}
    assert beside(data, tmp_path, w=rising.isel(height=0, drop=True)) == {
        "w": "it does not lie on the axes of u"
    }
    left_out = beside(data, tmp_path, w=rising, rising=rising)
    assert left_out["w"] == "rising would do as well, and no upward wind is taken of several"
    assert set(left_out) == {"w", "rising"}
    named = survey([tmp_path / "wind.nc"], reading=Reading(("u", "v")))
    assert {seen.name: seen.left_out for seen in named.variables}["w"] == "u and v alone are asked for"


def test_one_of_two_gusts_is_shown(tmp_path):
    gust = ensemble().u.assign_attrs(standard_name="wind_speed_of_gust")
    left_out = beside(gust.to_dataset(name="fg"), tmp_path, gust=gust)
    assert left_out == {"gust": "the speed shown is that of fg"}
    assert beside(ensemble(), tmp_path, gust=gust) == {}  # a hazard may be made of it


def test_the_95th_percentile_is_never_above_the_highest(tmp_path):
    data = ensemble()
    for name in ("u", "v"):
        data[name][:] = 3.0
    data.to_netcdf(tmp_path / "wind.nc")
    for speed in survey([tmp_path / "wind.nc"]).quantity.speeds:
        assert speed.p95_mps == speed.highest_mps == pytest.approx(math.hypot(3.0, 3.0))


@pytest.mark.parametrize(
    ("name", "flyable", "lines"),
    [
        (
            "katrina_wrf10km_20050828.nc",
            True,
            ["48 x 48 points", "every 3 h", "10, 100, 250, 500, 1000, 1500, 2000 m"],
        ),
        (
            "gfs10m_natlantic_201611.nc",
            True,
            ["42 x 76 points", "every 6 h", "10 m above ground, taken to hold at every altitude"],
        ),
    ],
)
def test_the_real_files(name, flyable, lines, data_folder):
    found = survey([data_folder / name])
    text = survey_text(found)
    assert found.flyable is flyable
    assert [line for line in lines if line not in text] == []


def test_the_command_prints_it_and_refuses_what_it_cannot_read(path, tmp_path, monkeypatch, capsys):
    def said(*arguments):
        """The exit code, and what was said on each stream."""
        monkeypatch.setattr(sys, "argv", ["galeway", "weather", *arguments])
        code = 0
        try:
            main()
        except SystemExit as stop:
            code = stop.code
        return code, *capsys.readouterr()

    monkeypatch.chdir(tmp_path)
    code, text, _ = said(str(path), "--threshold", "20")
    assert code == 0
    assert "over 20 m/s" in text
    code, text, _ = said("--json", "--variables", "u, v", "*.nc")
    assert json.loads(text)["quantity"]["name"] == "u, v"
    (tmp_path / "text.txt").write_text("no weather")
    (tmp_path / "folder").mkdir()
    for arguments, message in (
        (["text.txt"], "text.txt begins with b'no weath', which is neither NetCDF, GRIB nor Zarr"),
        (["folder"], "the folder folder is no Zarr store"),
        (["folder"], "name the files in it, such as folder/*.nc"),
        (["none.nc"], "there is no weather file none.nc"),
        (["wind.nc", "--threshold", "0"], "a threshold is above 0 m/s"),
        (["wind.nc", "--variables", "u"], "two names are needed"),
    ):
        code, _, complaint = said(*arguments)
        assert code == 2
        assert message in complaint
