"""Bad input ends in one message that names it, and nothing is left behind."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "turbulence.severty=4"], ["turbulence.severty", "did you mean 'severity'"]),
        (["--set", "aircraft.model=spitfire"], ["spitfire", "aerosonde"]),
        (["--set", "mission.altitude_m=5000"], ["5000", "ceiling", "2000"]),
        (["--set", "mission.start.lat_deg=45"], ["start Here", "45.000", "off the grid"]),
        (
            ["--set", 'mission.goals=[{name="There", lat_deg=10.0, lon_deg=-60.0}]'],
            ["goal There", "off the grid"],
        ),
        (["--set", "weather.storm=AL012022"], ["AL012022", "AL092022"]),
        (["--set", "grid.cell_m=100"], ["cells", "grid.cell_m"]),
        (["--set", "grid.cell_m=30000"], ["m/s over ground", "22 to 39"]),
        (["--set", "name=.."], ["name"]),
        (
            ["--set", 'mission.goals=[{name="There", lat_deg=29.601, lon_deg=-90.601}]'],
            ["one cell of 3600 m"],
        ),
        (["--set", "mission.departure=2023-01-01T00:00:00Z"], ["2023-01-01", "fixes"]),
        (["--set", "limits=['cros_track_m.p96 <= 2']"], ["cros_track_m.p96", "cross_track_m.p96"]),
        (["--goal", "Nowhere"], ["'Nowhere'", "There"]),
        (["--planner", "magic"], ["planner.kind", "magic"]),
    ],
)
def test_bad_input_ends_in_one_message(assert_one_message, galeway, tmp_path, arguments, words):
    done = galeway("fly", SHORT, "--out", str(tmp_path / "out"), *arguments)
    assert_one_message(done, 2, *words)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", [["--seed", "x"], ["--nonsense"]])
def test_bad_usage_exits_2(galeway_process, option):
    done = galeway_process("fly", *option)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def test_missing_files_are_named(assert_one_message, galeway, galeway_process, tmp_path):
    assert_one_message(galeway_process("fly", "missing.toml"), 2, "missing.toml", "ian")
    missing = str(tmp_path / "missing.mcap")
    assert_one_message(galeway("check", missing), 2, missing)
    assert_one_message(galeway("replay", str(tmp_path / "missing.rrd")), 2, "missing.rrd")
    rubbish = tmp_path / "rubbish.mcap"
    rubbish.write_bytes(b"not a recording" * 100)
    assert_one_message(galeway("check", str(rubbish)), 2, "rubbish.mcap")


def test_a_folder_that_cannot_be_made_is_named(assert_one_message, galeway, tmp_path):
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file" / "out", tmp_path / "file", Path("/proc/foo")):
        done = galeway("fly", SHORT, "--out", str(folder))
        assert_one_message(done, 2, str(folder), "--out")
        assert done.stdout == ""  # before anything is planned


def test_limits_that_cannot_be_read_are_named(assert_one_message, flown, galeway, tmp_path):
    recording = str(flown[1] / "flight.mcap")
    limits = tmp_path / "limits.toml"
    assert_one_message(galeway("check", recording, "--limits", str(limits)), 2, "limits.toml")
    limits.write_text("limits = ['cross_track_m.p95 =< 2']")
    assert_one_message(galeway("check", recording, "--limits", str(limits)), 2, "=<")
    limits.write_text("limits = []")
    assert galeway("check", recording, "--limits", str(limits)).returncode == 2


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--set", "hazard.threshold_mps=0.1"], "the start is in hazard at departure"),
        (["--set", "stages.steps=3"], "no safe way leads there within the horizon"),
    ],
)
def test_no_route_is_an_answer_with_a_reason(assert_one_message, galeway, tmp_path, arguments, reason):
    done = galeway("fly", SHORT, "--out", str(tmp_path), *arguments)
    assert_one_message(done, 1, reason)
    plan = json.loads((tmp_path / "plan.json").read_text())
    assert plan["goals"][0]["reason"] == reason
    assert not (tmp_path / "flight.mcap").exists()


def wind_file(path, **changes):
    """A calm NetCDF of the short mission's area, with changes to its eastward wind."""
    time = xr.date_range("2022-09-29T00:00", periods=3, freq="1h", use_cftime=False)
    lat, lon = np.linspace(29.0, 30.5, 16), np.linspace(-91.5, -89.5, 21)
    coords = {"time": time, "lat": lat, "lon": lon}
    shape = (len(time), len(lat), len(lon))
    east = np.full(shape, 3.0)
    for place, value in changes.get("values", {}).items():
        east[place] = value
    attrs = {"units": changes.get("units", "m s-1")}
    data = {
        changes.get("name", "u"): xr.DataArray(
            east, coords, attrs=attrs | {"standard_name": changes.get("standard_name", "eastward_wind")}
        ),
        "v": xr.DataArray(np.ones(shape), coords, attrs=attrs | {"standard_name": "northward_wind"}),
    }
    dataset = xr.Dataset(data)
    dataset["lat"].attrs["units"], dataset["lon"].attrs["units"] = "degrees_north", "degrees_east"
    dataset.to_netcdf(path)
    return path


@pytest.fixture
def own_weather(tmp_path):
    """Writes a scenario with a weather file of its own: (**changes) -> path of the scenario."""

    def written(**changes):
        wind_file(tmp_path / "wind.nc", **changes)
        text = Path(SHORT).read_text(encoding="utf-8").replace('storm = "AL092022"', 'file = "wind.nc"')
        scenario = tmp_path / "mine.toml"
        scenario.write_text(text, encoding="utf-8")
        return str(scenario)

    return written


def test_a_wind_file_of_ones_own_is_flown_in(galeway, own_weather, tmp_path):
    done = galeway("fly", own_weather(), "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["wind_mps"]["mean"] == pytest.approx(np.hypot(3.0, 1.0), abs=1e-3)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"values": {(1, 7, 8): np.nan}}, ["wind.nc", "2022-09-29T01:00:00, lat 29.7"]),
        ({"units": "furlong"}, ["wind.nc", "furlong"]),
        ({"values": {(1, 7, 8): 9.9e36}}, ["wind.nc", "9.9e+36", "_FillValue"]),
        ({"name": "x", "standard_name": "sea_surface_height"}, ["wind.nc", "wind"]),
    ],
)
def test_a_broken_wind_file_is_named(assert_one_message, galeway, own_weather, tmp_path, changes, words):
    assert_one_message(galeway("fly", own_weather(**changes), "--out", str(tmp_path / "out")), 2, *words)


def test_gaps_outside_the_area_of_the_mission_do_no_harm(galeway, own_weather):
    scenario = own_weather(values={(1, 15, 20): np.nan})
    assert galeway("plan", scenario).returncode == 2
    assert galeway("plan", scenario, "--set", "grid.north_deg=30.2").returncode == 0


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("mission.departure=2022-09-29T02:00:00Z", ["wind.nc", "2022-09-29T02:00:00"]),
        ("grid.north_deg=35", ["wind.nc", "latitudes"]),
        ("weather.file='other.nc'", ["other.nc"]),
    ],
)
def test_a_wind_file_that_does_not_hold_the_mission_is_named(
    assert_one_message, galeway, own_weather, tmp_path, override, words
):
    done = galeway("fly", own_weather(), "--out", str(tmp_path / "out"), "--set", override)
    assert_one_message(done, 2, *words)
