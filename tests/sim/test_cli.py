"""The command as a user meets it: real processes, files, messages and exit codes."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from recordings.mcap_reader import read

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")
REPORT_KEYS = [
    "scenario",
    "seed",
    "outcome",
    "arrived",
    "goal",
    "planned_time_s",
    "flight_time_s",
    "planned_length_m",
    "flown_length_m",
    "cross_track_m",
    "altitude_error_m",
    "waypoint_time_error_s",
    "airspeed_mps",
    "wind_mps",
    "hazard_exposure_s",
    "min_clearance_m",
    "samples",
    "waypoints_missed",
    "corner_cut_m",
    "outside_airspeeds_s",
    "position_estimate_error_m",
    "wind_estimate_error_mps",
]


@pytest.fixture(scope="module")
def flown(galeway, tmp_path_factory):
    """The short scenario, flown once: (finished process, folder)."""
    folder = tmp_path_factory.mktemp("short")
    return galeway("fly", SHORT, "--out", str(folder)), folder


def assert_one_message(done, code, *words):
    assert done.returncode == code, done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    assert len(lines) == 1, done.stderr
    for word in words:
        assert word in lines[0]


def test_help_loads_nothing_heavy():
    code = (
        "import sys, sim.cli; from click.testing import CliRunner; "
        "CliRunner().invoke(sim.cli.commands, ['--help']); "
        "heavy = {'numpy', 'rerun', 'xarray', 'jsbsim', 'mcap', 'msgspec', 'pyproj'}; "
        "sys.exit(bool(heavy & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_flight_leaves_its_four_files_and_a_summary(flown):
    done, folder = flown
    assert done.returncode == 0, done.stderr + done.stdout
    names = ["flight.mcap", "flight.rrd", "plan.json", "report.json"]
    assert sorted(path.name for path in folder.iterdir()) == names
    assert done.stderr == ""  # no progress bar where there is no terminal
    for words in (
        "cross-track",
        "altitude",
        "p95",
        "hazardous wind",
        f"galeway replay {folder}",
        "real time",
    ):
        assert words in done.stdout
    assert done.stdout.count("PASS") == 4


def test_the_report_has_its_keys_and_check_gives_the_same(flown, galeway):
    _, folder = flown
    report = json.loads((folder / "report.json").read_text())
    assert [key for key in report if key in REPORT_KEYS] == REPORT_KEYS
    assert report.pop("real_time_factor") > 0
    assert set(report["cross_track_m"]) == {"mean", "p95", "max"}
    assert set(report["airspeed_mps"]) == {"min", "mean", "max"}
    assert (report["outcome"], report["arrived"], report["goal"]) == ("arrived", True, "There")
    checked = galeway("check", str(folder / "flight.mcap"), "--json")
    assert checked.returncode == 0
    assert json.loads(checked.stdout) == report


def test_check_judges_by_the_limits_in_the_recording(flown, galeway):
    checked = galeway("check", str(flown[1] / "flight.mcap"))
    assert checked.returncode == 0
    assert checked.stdout.count("PASS") == 4


def test_check_names_a_broken_limit_its_value_and_its_moment(flown, galeway, tmp_path):
    _, folder = flown
    report = json.loads((folder / "report.json").read_text())
    limits = tmp_path / "limits.toml"
    limits.write_text('limits = ["cross_track_m.max <= 0.001", "arrived == true"]')
    checked = galeway("check", str(folder / "flight.mcap"), "--limits", str(limits))
    assert checked.returncode == 1
    (line,) = [line for line in checked.stdout.splitlines() if line.startswith("FAIL")]
    assert "cross_track_m.max <= 0.001" in line
    assert f"{report['cross_track_m']['max']:.2f}"[:3] in line
    assert "00:" in line  # the moment
    assert " N" in line  # the place


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(flown, galeway, tmp_path):
    again, other = tmp_path / "again", tmp_path / "other"
    assert galeway("fly", SHORT, "--out", str(again)).returncode == 0
    assert galeway("fly", SHORT, "--out", str(other), "--seed", "8").returncode == 0
    assert (again / "flight.mcap").read_bytes() == (flown[1] / "flight.mcap").read_bytes()
    states = [read(folder / "flight.mcap").state["roll_rad"] for folder in (again, other)]
    assert not np.array_equal(*states)


def test_a_flight_in_the_way_of_an_earlier_one_replaces_it(galeway, tmp_path):
    for seed in ("1", "2"):
        assert galeway("fly", SHORT, "--out", str(tmp_path), "--seed", seed).returncode == 0
    assert json.loads((tmp_path / "report.json").read_text())["seed"] == 2
    assert read(tmp_path / "flight.mcap").header.seed == 2


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_a_recording_cut_short_is_reported_as_far_as_it_goes(flown, galeway, tmp_path, share):
    whole = (flown[1] / "flight.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: int(len(whole) * share)])
    done = galeway("check", str(cut), "--json")
    assert "Traceback" not in done.stderr
    assert done.returncode == 1
    report = json.loads(done.stdout)
    assert report["outcome"] == "incomplete"
    assert not report["arrived"]
    assert report["samples"] > 0
    assert "incomplete" in done.stderr


def test_without_limits_a_flight_is_flown_and_reported_but_a_check_is_no_check(galeway, tmp_path):
    done = galeway("fly", SHORT, "--out", str(tmp_path), "--set", "limits=[]")
    assert done.returncode == 0
    assert "cross-track" in done.stdout
    checked = galeway("check", str(tmp_path / "flight.mcap"))
    assert_one_message(checked, 2, "no limit")
    assert "cross-track" in checked.stdout


def test_scenarios_are_listed(galeway):
    done = galeway("scenarios")
    assert done.returncode == 0
    assert "ian" in done.stdout


def test_plan_prints_and_writes(galeway, tmp_path):
    done = galeway("plan", SHORT, "--out", str(tmp_path / "plan.json"), "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout) == json.loads((tmp_path / "plan.json").read_text())
    shown = galeway("plan", SHORT)
    assert "> There" in shown.stdout


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
        (["--set", "limits=['cross_track_m.p96 <= 2']"], ["cross_track_m.p96", "cross_track_m.p95"]),
        (["--goal", "Nowhere"], ["'Nowhere'", "There"]),
        (["--planner", "magic"], ["planner.kind", "magic"]),
    ],
)
def test_bad_input_ends_in_one_message(galeway, tmp_path, arguments, words):
    done = galeway("fly", SHORT, "--out", str(tmp_path / "out"), *arguments)
    assert_one_message(done, 2, *words)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", [["--seed", "x"], ["--nonsense"]])
def test_bad_usage_exits_2(galeway, option):
    done = galeway("fly", *option)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def test_missing_files_are_named(galeway, tmp_path):
    assert_one_message(galeway("fly", "missing.toml"), 2, "missing.toml", "ian")
    missing = str(tmp_path / "missing.mcap")
    assert_one_message(galeway("check", missing), 2, missing)
    assert_one_message(galeway("replay", str(tmp_path / "missing.rrd")), 2, "missing.rrd")
    rubbish = tmp_path / "rubbish.mcap"
    rubbish.write_bytes(b"not a recording" * 100)
    assert_one_message(galeway("check", str(rubbish)), 2, "rubbish.mcap")


def test_a_folder_that_cannot_be_made_is_named(galeway, tmp_path):
    (tmp_path / "file").write_text("")
    assert_one_message(galeway("fly", SHORT, "--out", str(tmp_path / "file" / "out")), 2, "--out")


def test_limits_that_cannot_be_read_are_named(flown, galeway, tmp_path):
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
def test_no_route_is_an_answer_with_a_reason(galeway, tmp_path, arguments, reason):
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
def test_a_broken_wind_file_is_named(galeway, own_weather, tmp_path, changes, words):
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
def test_a_wind_file_that_does_not_hold_the_mission_is_named(galeway, own_weather, tmp_path, override, words):
    done = galeway("fly", own_weather(), "--out", str(tmp_path / "out"), "--set", override)
    assert_one_message(done, 2, *words)


@pytest.mark.parametrize(("name", "code"), [("SIGINT", 130), ("SIGKILL", -signal.SIGKILL)])
def test_a_flight_that_is_stopped_leaves_what_it_recorded(command, galeway, tmp_path, name, code):
    process = subprocess.Popen(
        [
            *command,
            "fly",
            SHORT,
            "--out",
            str(tmp_path),
            "--set",
            "mission.goals=" + FAR,
            "--set",
            "stages.count=9",
        ],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    partial = tmp_path / "flight.partial.mcap"
    deadline = time.monotonic() + 60.0
    while not (partial.exists() and partial.stat().st_size > 300_000):
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    os.kill(process.pid, getattr(signal, name))
    _, stderr = process.communicate(timeout=60)
    assert process.returncode == code
    assert "Traceback" not in stderr
    assert not (tmp_path / "flight.mcap").exists()
    checked = galeway("check", str(partial), "--json")
    assert checked.returncode == 1
    assert json.loads(checked.stdout)["samples"] > 100


FAR = '[{name="There", lat_deg=29.1, lon_deg=-91.4}]'


def test_hurricane_katrina_is_flown_round(galeway, data_folder, tmp_path):
    text = (Path(__file__).parents[2] / "docs" / "scenarios" / "katrina.toml").read_text(encoding="utf-8")
    (tmp_path / "katrina.toml").write_text(text, encoding="utf-8")
    (tmp_path / "katrina_wrf10km_20050828.nc").symlink_to(data_folder / "katrina_wrf10km_20050828.nc")
    done = galeway("fly", str(tmp_path / "katrina.toml"), "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert report["arrived"]
    assert report["hazard_exposure_s"] == 0
    assert report["wind_mps"]["max"] > 15.0
    plan = json.loads((tmp_path / "out" / "plan.json").read_text())
    (eye,) = [goal for goal in plan["goals"] if goal["name"] == "eye"]
    assert not eye["reachable"]
