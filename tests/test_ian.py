"""The default scenario, flown whole, once: what a newcomer's first command has to end with."""

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def ian(galeway_process, tmp_path_factory):
    """`galeway fly ian`, in a folder of its own: (finished process, runs/ian)."""
    home = tmp_path_factory.mktemp("home")
    return galeway_process("fly", cwd=home), home / "runs" / "ian"


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
    told = json.loads(checked.stdout)
    assert {key: told.get(key) for key in report} == report | {"real_time_factor": None}
    limits = tmp_path / "limits.toml"
    limits.write_text(f'limits = ["altitude_error_m.p95 <= {report["altitude_error_m"]["p95"] / 2}"]')
    broken = galeway("check", recording, "--limits", str(limits))
    assert broken.returncode == 1
    assert broken.stdout.count("FAIL altitude_error_m.p95") == 1


def test_tampa_opens_six_hours_later(galeway):
    done = galeway("plan", "--goal", "Tampa", "--set", "mission.departure=2022-09-29T06:00:00Z")
    assert done.returncode == 0


COARSE = ["grid.cell_m=10800", "stages.step_s=360", "stages.steps=10"]
"""The scenario on a ninth of the cells."""


def readme():
    return (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def readme_commands():
    """Every `galeway` line of the README, but those that open a window and that of the fixture."""
    lines = [line.removeprefix(".venv/bin/") for line in readme().splitlines()]
    commands = [shlex.split(line)[1:] for line in lines if re.match(r"galeway (?!plans )", line)]
    assert ["fly", "ian"] in commands
    return [words for words in commands if words[0] != "replay" and words != ["fly", "ian"]]


def commands_of_many():
    """Those that fly for hours, and on other machines."""
    return [words for words in readme_commands() if words[0] in ("campaign", "reproduce")]


def test_the_readmes_commands_run(ian, galeway, without_vulkan):
    """In the folder of the flight; what is planned is on a coarse grid, what else is flown only planned."""
    for arguments in readme_commands():
        command, options = arguments[0], arguments[1:]
        if arguments in commands_of_many() or (command == "picture" and without_vulkan):
            continue
        if command == "fly":
            command, options = "plan", options[: options.index("--out")]
        if command == "plan" and not any(option.startswith("grid.cell_m=") for option in options):
            options += [word for value in COARSE for word in ("--set", value)]
        assert galeway(command, *options, cwd=ian[1].parents[1]).returncode == 0, arguments


def test_the_readmes_campaign_runs(galeway, tmp_path):
    """Flights of a minute in place of its own, and few of them; clusters have tests of their own."""
    (tmp_path / "ian").write_bytes((Path(__file__).parent / "sim" / "scenarios" / "hop.toml").read_bytes())
    few = {"ian": "./ian", "20": "1", "17": "3"}
    commands = [
        words for words in commands_of_many() if words[0] == "campaign" and "--scheduler" not in words
    ]
    assert len(commands) == 3
    for arguments in commands:
        done = galeway(*(few.get(word, word) for word in arguments), cwd=tmp_path)
        assert done.returncode == 0, arguments
    assert done.stdout.endswith("the recording has the same bytes as in the campaign\n")


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments", [words for words in readme_commands() if words[0] in ("plan", "fly") or "--quick" in words]
)
def test_the_readmes_commands_run_as_they_stand(galeway, tmp_path, arguments):
    assert galeway(*arguments, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("page", "begins", "count"), [("README.md", "# limits.toml\n", 5), ("docs/limits.md", "limits = [\n", 18)]
)
def test_the_limits_that_pages_show_hold(ian, galeway, tmp_path, page, begins, count):
    text = (Path(__file__).parents[1] / page).read_text(encoding="utf-8")
    limits, *_ = [begins + part.split("```")[0] for part in text.split(f"```toml\n{begins}")[1:]]
    (tmp_path / "limits.toml").write_text(limits)
    done = galeway("check", str(ian[1] / "flight.mcap"), "--limits", str(tmp_path / "limits.toml"))
    assert done.returncode == 0, done.stdout
    assert done.stdout.count("PASS") == count


def test_the_readmes_code_runs(ian, tmp_path):
    (code,) = [part.split("```")[0] for part in readme().split("```python\n")[1:]]
    (tmp_path / "runs").mkdir()
    shutil.copytree(ian[1], tmp_path / "runs" / "ian", copy_function=lambda a, b: Path(b).symlink_to(a))
    printed = []
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        exec(compile(code, "README.md", "exec"), {"print": printed.append})
    assert len(printed) == 2
    assert all(str(verdict).startswith("PASS") for verdict in printed)
