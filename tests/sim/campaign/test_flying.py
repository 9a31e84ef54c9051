"""A flight's row is what `galeway fly` reports of it, and its recording has the same bytes."""

import errno
import hashlib
import json
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

from recordings.errors import RecordingError
from sim.campaign import flying
from sim.campaign.executor import Loss, Lost
from sim.campaign.flying import Flying
from sim.campaign.keeping import Keep
from sim.campaign.row import OUTCOMES, RowMaker, flat
from sim.job import Files, run
from sim.scenario import load_scenario

HOP = Path(__file__).parent.parent / "scenarios" / "hop.toml"


@pytest.fixture
def work(tmp_path):
    """Makes the work of a campaign: (keep) -> Flying."""

    def made(keep="all"):
        for name in ("kept", "scratch"):
            (tmp_path / name).mkdir(exist_ok=True)
        return Flying(Keep.parse(keep), tmp_path / "kept", tmp_path / "scratch")

    return made


def ignored(_):
    pass


def test_a_row_is_the_report_of_the_same_flight_alone(hop, work, tmp_path):
    flights = [hop("turbulence.severity=5", seed=seed, run=seed) for seed in (1, 2)]
    fly = pickle.loads(pickle.dumps(work()))
    row = [fly(flight) for flight in pickle.loads(pickle.dumps(flights))][-1]
    loaded, files = load_scenario(str(HOP), ["turbulence.severity=5", "seed=2"]), Files(tmp_path / "alone")
    alone = run(loaded, files, on_plan=ignored, on_time=ignored, tell=pytest.fail)
    kept = tmp_path / "kept" / "run_000002.mcap"
    assert kept.read_bytes() == files.mcap.read_bytes()
    assert row["recording_sha256"] == hashlib.sha256(kept.read_bytes()).hexdigest()
    assert row["recording_bytes"] == kept.stat().st_size
    report = json.loads(files.report.read_bytes())
    del report["real_time_factor"]
    assert {name: row[name] for name in flat(report)} == flat(report)
    assert (row["run"], row["seed"], row["overrides"]) == (2, 2, ["turbulence.severity=5"])
    assert [(limit["limit"], limit["passed"]) for limit in row["limits"]] == [
        (str(verdict.limit), verdict.passed) for verdict in alone.verdicts
    ]
    assert row["passed"] == all(verdict.passed for verdict in alone.verdicts)
    assert row["outcome"] == "arrived"
    assert json.loads(json.dumps(row)) == row
    assert not list((tmp_path / "scratch").iterdir())


def test_nothing_is_left_of_what_is_not_kept(hop, work, tmp_path):
    row = work("none")(hop())
    assert row["passed"]
    assert row["recording_bytes"] > 0
    assert work("failed")(hop())["passed"]
    assert not list((tmp_path / "kept").iterdir())
    failed = work("failed")(hop('limits=["flight_time_s <= 1"]'))
    assert (failed["arrived"], failed["passed"]) == (True, False)
    assert [path.name for path in (tmp_path / "kept").iterdir()] == ["run_000000.mcap"]
    assert not list((tmp_path / "scratch").iterdir())


@pytest.mark.parametrize(
    ("overrides", "outcome", "words"),
    [
        (["hazard.threshold_mps=3.0"], "no_route", "hazard"),
        (
            ["hazard.forecast_error_mps=9.0", "planner.abstain_below=1.0", "hazard.threshold_mps=8.0"],
            "abstained",
            "chance to survive",
        ),
        (["mission.altitude_m=6000.0"], "refused", "above the ceiling"),
        (["planner.objective=fuel"], "refused", "fuel"),
        (['limits=["no limit"]'], "refused", "no limit"),
        (['faults=[{kind="wind_nan", time_s=2}]'], "not_finite", "no longer finite"),
    ],
    ids=lambda value: value if isinstance(value, str) else value[0],
)
def test_every_flight_has_a_row(hop, work, overrides, outcome, words):
    row = work("none")(hop(*overrides))
    assert row["outcome"] == outcome
    assert row["outcome"] in OUTCOMES
    assert words in row["reason"]
    assert not row["passed"]
    assert row["seed"] == 7
    assert row["wall_time_s"] >= 0.0
    assert json.loads(json.dumps(row)) == row


def test_an_error_of_ours_is_the_flights_fault_and_ends_no_other(hop, work, monkeypatch):
    def broken(*_):
        raise KeyError("oops")

    monkeypatch.setattr(flying, "prepare_flight", broken)
    row = work("none")(hop())
    assert row["outcome"] == "fault"
    assert row["reason"].startswith("KeyError at test_flying.py:")


def test_a_full_disk_is_not_the_flights_fault(hop, work, tmp_path, monkeypatch):
    class Full:
        def __init__(self, path):
            path.with_suffix(".partial.mcap").symlink_to("/dev/full")
            self._recorder = flying_recorder(path)

        def __getattr__(self, name):
            return getattr(self._recorder, name)

    flying_recorder = flying.McapRecorder
    monkeypatch.setattr(flying, "McapRecorder", Full)
    with pytest.raises(RecordingError, match="make room") as raised:
        work("none")(hop())
    assert raised.value.__cause__.errno == errno.ENOSPC
    monkeypatch.undo()
    fly = work("all")
    (tmp_path / "scratch").rmdir()
    with pytest.raises(OSError, match="scratch"):
        fly(hop())


def test_the_row_of_a_flight_that_was_lost(hop):
    row = RowMaker(hop("turbulence.severity=3", run=4)).lost(
        Lost(Loss.PROCESS_CRASHED, "its process was killed by SIGABRT", 1.5)
    )
    assert (row["run"], row["outcome"], row["passed"]) == (4, "process_crashed", False)
    assert row["reason"] == "its process was killed by SIGABRT"
    assert row["wall_time_s"] == 1.5
    assert row["outcome"] in OUTCOMES


def test_workers_never_load_rerun():
    code = "import sys, sim.campaign.flying, sim.campaign.pool; sys.exit('rerun' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
