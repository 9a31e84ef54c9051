"""The default scenario, flown whole, once: what a newcomer's first command has to end with."""

import json
import shutil
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def ian(galeway, tmp_path_factory):
    """`galeway fly ian`, in a folder of its own: (finished process, runs/ian)."""
    home = tmp_path_factory.mktemp("home")
    return galeway("fly", cwd=home), home / "runs" / "ian"


@pytest.fixture(scope="session")
def report(ian):
    return json.loads((ian[1] / "report.json").read_text())


def test_it_flies_to_miami_and_passes_its_own_limits(ian, report):
    done, folder = ian
    assert done.returncode == 0, done.stdout + done.stderr
    assert (report["scenario"], report["goal"], report["outcome"]) == ("ian", "Miami", "arrived")
    assert report["cross_track_m"]["p95"] <= 2.0
    assert report["altitude_error_m"]["p95"] <= 3.0
    assert report["waypoint_time_error_s"]["p95"] <= 5.0
    assert report["hazard_exposure_s"] == 0.0
    assert report["min_clearance_m"] > 0.0
    assert "FAIL" not in done.stdout
    assert sorted(path.name for path in folder.iterdir()) == [
        "flight.mcap",
        "flight.rrd",
        "plan.json",
        "report.json",
    ]


def test_the_storm_matters(ian):
    plan = json.loads((ian[1] / "plan.json").read_text())
    goals = {goal["name"]: goal for goal in plan["goals"]}
    assert len(goals) == 10
    for name, calm_h in {"Miami": 13.3, "Tallahassee": 6.0}.items():  # four-way distance at 30 m/s
        assert goals[name]["earliest_arrival_s"] > (calm_h + 2.0) * 3600.0
    for name in ("Tampa", "Orlando", "Jacksonville", "Savannah", "Charleston"):
        assert not goals[name]["reachable"]
        assert goals[name]["reason"]
    assert all(goals[name]["reachable"] for name in ("Key West", "Havana", "Atlanta"))


def test_check_agrees_and_finds_a_limit_below_what_was_flown(ian, report, galeway, tmp_path):
    recording = str(ian[1] / "flight.mcap")
    checked = galeway("check", recording, "--json")
    assert checked.returncode == 0
    assert json.loads(checked.stdout) == {k: v for k, v in report.items() if k != "real_time_factor"}
    limits = tmp_path / "limits.toml"
    limits.write_text(f'limits = ["altitude_error_m.p95 <= {report["altitude_error_m"]["p95"] / 2}"]')
    broken = galeway("check", recording, "--limits", str(limits))
    assert broken.returncode == 1
    assert broken.stdout.count("FAIL altitude_error_m.p95") == 1


def test_tampa_opens_six_hours_later(galeway):
    done = galeway("plan", "--goal", "Tampa", "--set", "mission.departure=2022-09-29T06:00:00Z")
    assert done.returncode == 0


def test_the_readmes_commands_and_code_run(ian, galeway, tmp_path):
    """Every `galeway` line of the README, but the one that opens a window, in the folder of the flight."""
    home = ian[1].parents[1]
    text = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
    lines = [line.removeprefix(".venv/bin/") for line in text.splitlines()]
    commands = [line.split()[1:] for line in lines if line.startswith("galeway ") and "plans" not in line]
    assert ["fly", "ian"] in commands
    for arguments in commands:
        if arguments[0] == "replay" or arguments == ["fly", "ian"]:
            continue  # needs a screen; was flown by the fixture
        assert galeway(*arguments, cwd=home).returncode == 0, arguments
    (code,) = [part.split("```")[0] for part in text.split("```python\n")[1:]]
    (tmp_path / "runs").mkdir()
    shutil.copytree(ian[1], tmp_path / "runs" / "ian", copy_function=lambda a, b: Path(b).symlink_to(a))
    printed = []
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        exec(compile(code, "README.md", "exec"), {"print": printed.append})
    assert len(printed) == 2
    assert all(str(verdict).startswith("PASS") for verdict in printed)
