"""The command as a user meets it: real processes, files, messages and exit codes."""

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

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
    told = done.stderr.splitlines()  # no progress bar where there is no terminal; lines if it takes long
    assert [line for line in told if not line.startswith("flown ")] == []
    for words in (
        "cross-track",
        "altitude",
        "p95",
        "in hazard ",
        f"galeway replay {folder}",
        "real time",
    ):
        assert words in done.stdout
    assert done.stdout.count("PASS") == 4


def test_the_recording_for_the_eyes_shows_outcome_and_verdicts(flown):
    from rerun.chunk import RrdReader

    _, folder = flown
    texts = {}
    for chunk in RrdReader(folder / "flight.rrd").stream():
        if chunk.entity_path in ("/card", "/verdicts"):
            (text,) = chunk.to_record_batch().column("TextDocument:text").to_pylist()[-1]
            texts[chunk.entity_path] = text
    assert texts["/card"].startswith("**arrived**: passed There")
    assert "4 of 4 limits hold" in texts["/verdicts"]
    assert texts["/verdicts"].count("| PASS |") == 4


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
    told = json.loads(checked.stdout)
    assert {key: told[key] for key in report} == report


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
    first = galeway("fly", SHORT, "--out", str(tmp_path), "--seed", "1")
    assert first.returncode == 0
    assert "replaced" not in first.stderr
    again = galeway("fly", SHORT, "--out", str(tmp_path), "--seed", "2")
    assert again.returncode == 0
    (line,) = [line for line in again.stderr.splitlines() if "replaced" in line]
    for word in (str(tmp_path), "plan.json", "report.json", "flight.mcap", "flight.rrd"):
        assert word in line
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


def test_without_limits_a_flight_is_flown_and_reported_but_a_check_is_no_check(
    assert_one_message, galeway, tmp_path
):
    done = galeway("fly", SHORT, "--out", str(tmp_path), "--set", "limits=[]")
    assert done.returncode == 0
    assert "cross-track" in done.stdout
    checked = galeway("check", str(tmp_path / "flight.mcap"))
    assert_one_message(checked, 2, "no limit")
    assert "cross-track" in checked.stdout


def test_scenarios_are_listed(galeway_process):
    done = galeway_process("scenarios")
    assert done.returncode == 0
    assert "ian" in done.stdout


def test_plan_prints_and_writes(galeway, tmp_path):
    done = galeway("plan", SHORT, "--out", str(tmp_path / "plan.json"), "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout) == json.loads((tmp_path / "plan.json").read_text())
    shown = galeway("plan", SHORT)
    assert "> There" in shown.stdout


def test_a_fault_that_did_not_strike_is_told(galeway, tmp_path):
    faults = 'faults=[{kind="state_nan", time_s=5}, {kind="wind_step", time_s=900}]'
    done = galeway("fly", SHORT, "--out", str(tmp_path / "out"), "--set", faults)
    assert done.returncode == 1
    assert "wind_step of 900 s did not strike" in done.stderr


def test_without_a_terminal_a_line_at_times_says_how_far_it_is(monkeypatch, capsys):
    from sim import cli_fly

    now_s = iter([0.0, 0.0, 9.9, 10.0, 10.0, 15.0, 20.0, 20.0, 30.0, 30.0])
    plan = SimpleNamespace(waypoints=(1,), duration_s=61200.0)
    monkeypatch.setattr(cli_fly, "print_plan", lambda *_: None)
    monkeypatch.setattr(cli_fly.time, "monotonic", lambda: next(now_s))
    with cli_fly._progress(0.0) as (on_plan, on_time):
        on_plan(plan)
        for time_s in (-30.0, 5400.0, 7200.0, 10800.0, 61500.0):
            on_time(time_s)
    assert capsys.readouterr().err.splitlines() == [
        "flown 1:30 of 17:00 h",
        "flown 3:00 of 17:00 h",
        "flown 17:05 h, 17:00 h were planned at departure",
    ]


@pytest.mark.slow
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
