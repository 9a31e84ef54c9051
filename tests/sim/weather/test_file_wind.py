"""A mission's wind from weather files: scenarios on written files, and on the real ones."""

import json

import numpy as np
import pytest
import xarray as xr

from sim.errors import ScenarioError, WeatherError
from sim.scenario import load_scenario
from sim.weather.source import bring_weather

SCENARIO = """
name = "mine"

[mission]
departure = 2024-02-29T00:30:00Z
altitude_m = 300.0
goal = "B"
start = { name = "A", lat_deg = 50.3, lon_deg = 4.3 }
goals = [{ name = "B", lat_deg = 50.7, lon_deg = 4.7 }]

[weather]
file = "wind.nc"

[stages]
count = 2
"""
LAT_DEG, LON_DEG = np.linspace(50.0, 51.0, 6), np.linspace(4.0, 5.0, 6)


def wind(hours=(0, 1, 2, 3), speed=5.0):
    """A wind toward the north-east that grows by 1 m/s an hour."""
    hours = np.array(hours, dtype=float)
    values = np.broadcast_to((speed + hours)[:, np.newaxis, np.newaxis], (hours.size, 6, 6)).copy()
    dims = ("time", "latitude", "longitude")
    return xr.Dataset(
        {name: (dims, values.copy(), {"units": "m s-1"}) for name in ("u10", "v10")},
        {
            "time": np.datetime64("2024-02-29T00:00", "ns") + (3600e9 * hours).astype("timedelta64[ns]"),
            "latitude": ("latitude", LAT_DEG, {"units": "degrees_north"}),
            "longitude": ("longitude", LON_DEG, {"units": "degrees_east"}),
        },
    )


@pytest.fixture
def bring(tmp_path):
    """Brings the weather of the scenario: (files by name, overrides) -> MissionWeather."""

    def brought(files, *overrides):
        for name, data in files.items():
            data.to_netcdf(tmp_path / name)
        (tmp_path / "mine.toml").write_text(SCENARIO)
        return bring_weather(load_scenario(str(tmp_path / "mine.toml"), overrides))

    return brought


def test_forecast_and_truth_are_the_files_wind(bring):
    weather = bring({"wind.nc": wind()})
    assert weather.truth.at(
        1709164800.0 + 5400.0, np.radians(50.5), np.radians(4.5)
    ).north_mps == pytest.approx(6.5)
    assert weather.forecast.grid.rows > 6


@pytest.mark.parametrize("files", ["wind_*.nc", ["wind_1.nc", "wind_0.nc"]])
def test_several_files_are_one_forecast(files, bring):
    parts = {f"wind_{number}.nc": wind().isel(time=[2 * number, 2 * number + 1]) for number in (0, 1)}
    weather = bring(parts, f"weather.file={json.dumps(files)}")
    np.testing.assert_array_equal(np.diff(weather.truth.time_s), 3600.0)
    np.testing.assert_array_equal(weather.truth.north_mps, bring({"wind.nc": wind()}).truth.north_mps)


def test_a_time_that_is_missing_is_bridged_only_where_the_scenario_says_so(bring):
    holed = {"wind.nc": wind((0, 1, 4, 5))}
    with pytest.raises(
        WeatherError,
        match=r"wind\.nc has no wind between 2024-02-29T01:00:00 and 2024-02-29T04:00:00 UTC, 3 h apart "
        r"\(limit 1 h\).*weather\.bridge_gaps_h = 3",
    ):
        bring(holed)
    with pytest.raises(WeatherError, match=r"limit 2 h"):
        bring(holed, "weather.bridge_gaps_h=2")
    weather = bring(holed, "weather.bridge_gaps_h=3")
    assert weather.truth.at(
        1709164800.0 + 7200.0, np.radians(50.5), np.radians(4.5)
    ).east_mps == pytest.approx(7.0)
    with pytest.raises(ScenarioError, match=r"bridge_gaps_h"):
        bring(holed, "weather.bridge_gaps_h=0")


@pytest.mark.parametrize(
    "hours", [(0, 3, 6), (0, 6, 12), (-6, 0, 6), (0, 1, 2, 3, 9, 12), (-9, -6, 0, 1, 2, 3)]
)
def test_even_times_up_to_six_hours_apart_and_gaps_outside_the_mission_do_no_harm(hours, bring):
    assert bring({"wind.nc": wind(hours)}).truth.time_s.size == len(hours)


def test_even_times_half_a_day_apart_are_too_far_unless_the_scenario_says_so(bring):
    with pytest.raises(WeatherError, match=r"12 h apart \(limit 6 h\)"):
        bring({"wind.nc": wind((0, 12, 24))})
    assert bring({"wind.nc": wind((0, 12, 24))}, "weather.bridge_gaps_h=12").truth.time_s.size == 3


def test_a_mission_beyond_the_files_time_or_area_is_refused(bring):
    with pytest.raises(
        WeatherError,
        match=r"wind\.nc holds 2024-02-29T00:00:00 to 2024-02-29T02:00:00 UTC, but the mission takes "
        r"2024-02-29T00:30:00 to 2024-02-29T02:30:00; change mission\.departure",
    ):
        bring({"wind.nc": wind((0, 1, 2))})
    box = ("grid.south_deg=50.1", "grid.north_deg=51.3", "grid.west_deg=4.1", "grid.east_deg=4.9")
    with pytest.raises(
        WeatherError, match=r"wind\.nc covers 50\.\d\d N to 51\.00 N, .* and does not hold all lat"
    ):
        bring({"wind.nc": wind()}, *box)


def test_a_gap_in_the_missions_area_is_refused_and_one_outside_is_not(bring):
    holed = wind()
    holed["v10"][2, 5, 5] = np.nan
    with pytest.raises(
        WeatherError, match=r"wind\.nc cannot be used: the wind v10 has 1 gaps .* 2024-02-29T02:00:00, lat 51"
    ):
        bring({"wind.nc": holed})
    box = ("grid.south_deg=50.1", "grid.north_deg=50.8", "grid.west_deg=4.1", "grid.east_deg=4.8")
    assert bring({"wind.nc": holed}, *box).forecast.grid.rows > 2


def test_a_truth_of_its_own_is_flown_through_and_not_planned_with(bring):
    files = {"wind.nc": wind(), "later.nc": wind(speed=9.0)}
    weather = bring(files, "weather.truth.file=later.nc", "weather.truth.speed_factor=2.0")
    at = (1709164800.0 + 3600.0, np.radians(50.5), np.radians(4.5))
    assert weather.forecast.at(*at).north_mps == pytest.approx(6.0)
    assert weather.truth.at(*at).north_mps == pytest.approx(20.0)
    small = wind().isel(latitude=slice(0, 4))
    with pytest.raises(
        WeatherError, match=r"the truth in small\.nc covers 50\.00 N to 50\.60 N, .* planner's grid"
    ):
        bring(files | {"small.nc": small}, "weather.truth.file=small.nc")
    with pytest.raises(WeatherError, match=r"short\.nc holds .* but the mission takes"):
        bring(files | {"short.nc": wind((0, 1))}, "weather.truth.file=short.nc")


def test_a_truth_from_files_needs_a_forecast_from_files(bring):
    with pytest.raises(ScenarioError, match=r"weather\.truth\.file needs a forecast from weather\.file, too"):
        load_scenario("ian", ["weather.truth.file=later.nc"])


def test_the_mean_of_an_ensemble_is_flown_unless_a_member_is_named(bring):
    both = xr.concat([wind(), wind(speed=9.0)], xr.Variable("number", [3, 8]))
    at = (1709164800.0 + 3600.0, np.radians(50.5), np.radians(4.5))
    assert bring({"wind.nc": both}).truth.at(*at).north_mps == pytest.approx(8.0)
    assert bring({"wind.nc": both}, "weather.member=8").truth.at(*at).north_mps == pytest.approx(10.0)
    with pytest.raises(ScenarioError, match=r"weather\.member"):
        bring({"wind.nc": both}, "weather.member=median")


GFS = """
name = "channel"
limits = ["arrived == true", "cross_track_m.p95 <= 3"]

[mission]
departure = 2016-11-20T04:00:00Z
altitude_m = 300.0
goal = "B"
start = { name = "A", lat_deg = 48.30, lon_deg = -7.70 }
goals = [{ name = "B", lat_deg = 48.42, lon_deg = -7.52 }]

[weather]
file = "gfs10m_natlantic_201611.nc"

[grid]
south_deg = 48.0
north_deg = 49.0
west_deg = -8.0
east_deg = -7.0

[stages]
count = 3

[hazard]
threshold_mps = 25.0

[planner]
objective = "earliest"
"""


def test_the_gfs_wind_is_planned_and_flown_in(data_folder, galeway, tmp_path):
    (tmp_path / "channel.toml").write_text(GFS)
    (tmp_path / "gfs10m_natlantic_201611.nc").symlink_to(data_folder / "gfs10m_natlantic_201611.nc")
    done = galeway("fly", str(tmp_path / "channel.toml"), "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "arrived" in done.stdout


def test_the_st_jude_gusts_cannot_be_flown_in_and_the_reason_is_said(data_folder, tmp_path):
    text = GFS.replace("2016-11-20T04", "2013-10-28T01").replace("gfs10m_natlantic_201611.nc", "gust.grib")
    (tmp_path / "gust.toml").write_text(text)
    (tmp_path / "gust.grib").symlink_to(data_folder / "ens_stjude_gust_20131025.grib")
    with pytest.raises(
        WeatherError,
        match=r"gust\.grib cannot be used: it has the speed of the wind \(fg10_3\) and not its direction",
    ):
        bring_weather(load_scenario(str(tmp_path / "gust.toml")))
