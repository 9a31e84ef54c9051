"""`galeway campaign` as it is used: interrupted, killed, on a full disk, with flights that crash."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from sim.campaign.journal import Journal
from sim.cli import main

HOP = Path(__file__).parent / "scenarios" / "hop.toml"

ABORTS = """
import os, sys
from importlib.abc import MetaPathFinder

class Hook(MetaPathFinder):
    '''Has the flight with one seed end its process in mid-air.'''

    def find_spec(self, name, path, target=None):
        if name == "sim.campaign.flying":
            sys.meta_path.remove(self)
            import sim.closed_loop as loop
            fly = loop.fly

            def deadly(setup, recorder, on_time):
                def until(time_s):
                    if time_s > 5.0 and setup.header.seed == int(os.environ["DEADLY_SEED"]):
                        os.abort()
                return fly(setup, recorder, until)

            loop.fly = deadly
        return None

sys.meta_path.insert(0, Hook())
"""


def begin(command, out, *arguments, before=None):
    """Begin a campaign, in a process group of its own."""
    return subprocess.Popen(
        [*command, "campaign", str(HOP), "--out", str(out), *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=before,
        start_new_session=True,
    )


def recording(out, run):
    return out / "recordings" / f"run_{run:06d}.mcap"


def recorded(out):
    return sorted((out / "recordings").glob("run_??????.mcap"))


def wait_for(condition):
    for _ in range(60_000):
        if condition():
            return
        time.sleep(0.01)
    raise AssertionError("it did not happen within ten minutes")


@pytest.fixture
def called(monkeypatch, capsys):
    """Runs a command in this process: (*arguments) -> exit code, stdout, stderr."""

    def call(*arguments):
        monkeypatch.setattr("sys.argv", ["galeway", *arguments])
        with pytest.raises(SystemExit) as stopped:
            sys.exit(main())
        told = capsys.readouterr()
        return stopped.value.code or 0, told.out, told.err

    return call


def processes_of(session):
    """The processes of a session that are alive."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            after_name = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(after_name[3]) == session and after_name[0] != "Z":
            found.append(int(path.parent.name))
    return found


def test_killed_it_goes_on_and_a_flight_that_crashes_its_process_takes_no_other_with_it(
    command, tmp_path, called, monkeypatch
):
    (tmp_path / "sitecustomize.py").write_text(ABORTS)  # which workers load, as any Python does
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("DEADLY_SEED", "16")
    out, options = tmp_path / "out", ("--runs", "12", "--keep", "all", "--vary", "turbulence.severity=4")
    first = begin(command, out, *options, "--workers", "2")
    wait_for(lambda: len(recorded(out)) >= 3)
    code, _, told = called("campaign", str(HOP), *options, "--out", str(out))
    assert (code, "by another process" in told) == (2, True)
    os.kill(first.pid, signal.SIGKILL)
    first.communicate()
    wait_for(lambda: not processes_of(first.pid))
    with closing(Journal(out / "journal.sqlite")) as journal:
        landed = journal.runs()
    before = {run: recording(out, run).stat().st_mtime_ns for run in landed - {9}}
    code, text, told = called("campaign", str(HOP), *options, "--workers", "1", "--out", str(out))
    assert code == 0, told
    assert f"{len(landed)} of 12 flights have landed before" in told
    assert before
    assert {run: recording(out, run).stat().st_mtime_ns for run in before} == before  # none was flown again
    assert "1  process_crashed: its process was killed by SIGABRT" in text
    rows = pq.read_table(out / "flights.parquet").to_pylist()
    assert [row["run"] for row in rows] == list(range(12))
    outcomes = [row["outcome"] for row in rows]
    assert [run for run, outcome in enumerate(outcomes) if outcome != "arrived"] == [9]
    assert rows[9]["seed"] == 16
    assert [row["recording"] for row in rows] == [
        None if run == 9 else f"recordings/run_{run:06d}.mcap" for run in range(12)
    ]
    check_again(called, out, rows[7], tmp_path)


def check_again(called, out, row, folder):
    """A run alone is the same, made again by its campaign or flown with its row's values."""
    kept = (out / row["recording"]).read_bytes()
    code, told, _ = called("campaign", "replay", str(out), "7", "-o", str(folder / "again"))
    assert (code, "the recording has the same bytes as in the campaign" in told) == (0, True)
    assert (folder / "again" / "flight.mcap").read_bytes() == kept
    settings = [word for text in (*row["overrides"], f"seed={row['seed']}") for word in ("--set", text)]
    assert called("fly", str(HOP), *settings, "--out", str(folder / "alone"))[0] == 0
    assert (folder / "alone" / "flight.mcap").read_bytes() == kept
    code, _, told = called("campaign", "replay", str(out), "9", "-o", str(folder / "crashed"))
    assert (code, "no recording of run 9 to compare with: process_crashed" in told) == (
        0,
        True,
    )  # here it arrives
    code, _, told = called("campaign", "replay", str(out), "12")
    assert (code, "is not among the 12 flights" in told) == (2, True)
    (out / "scenario.toml").write_text(HOP.read_text() + "# changed\n")
    code, _, told = called("campaign", "replay", str(out), "7")
    assert (code, "is not the scenario that run 7 was flown with" in told) == (2, True)


@pytest.mark.parametrize(("sent", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupted_it_tells_how_to_go_on_and_a_report_can_be_read(command, called, tmp_path, sent, code):
    out = tmp_path / "out"
    campaign = begin(command, out, "--runs", "200", "--keep", "all", "--workers", "1")
    wait_for(lambda: len(recorded(out)) >= 3)
    for one in set(processes_of(campaign.pid)) - {
        campaign.pid
    }:  # which may hear of it before their parent does
        os.kill(one, sent)
    landed = len(recorded(out))
    wait_for(lambda: len(recorded(out)) >= landed + 2)
    os.killpg(campaign.pid, sent)
    _, told = campaign.communicate()
    assert campaign.returncode == code
    assert "Traceback" not in told
    assert " of 200 flights are in " in told
    assert "the same command goes on" in told
    wait_for(lambda: not processes_of(campaign.pid))  # multiprocessing's own tracker ends just after it
    summary = json.loads(called("campaign", "report", str(out), "--json")[1])
    assert summary["planned"] == 200
    assert 0 < summary["all"]["flights"] < 200
    assert set(summary["outcomes"]) == {
        "arrived"
    }  # none is taken for crashed whose worker was told to end, too
    assert f"{summary['all']['flights']} of 200 flights" in called("campaign", "report", str(out))[1]
    assert json.loads((out / "summary.json").read_bytes()) == summary
    assert not (out / "scratch").exists()


def test_a_full_disk_stops_it_and_with_room_it_goes_on(command, called, tmp_path):
    def full():
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

    out, options = tmp_path / "out", ("--runs", "3", "--workers", "1", "--keep", "none")
    stopped = begin(command, out, *options, before=full)
    _, told = stopped.communicate()
    assert stopped.returncode == 2
    assert "Traceback" not in told
    assert "the campaign cannot go on" in told
    assert "make room" in told
    assert not (out / "scratch").exists()
    code, text, told = called("campaign", str(HOP), *options, "--out", str(out))
    assert code == 0, told
    assert "3 flights, 3 (100.0 %) passed" in text


def test_settings_are_those_of_all_flights_and_a_replay_has_the_same_bytes(called, tmp_path):
    out, far = tmp_path / "out", 'limits=["cross_track_m.p95 <= 0.000001"]'
    options = ("--runs", "1", "--workers", "1", "--set", far, "--seed", "20", "--out", str(out))
    code, text, told = called("campaign", str(HOP), *options)
    assert code == 0, told
    assert "1 flight, 0 (0.0 %) passed" in text
    assert called("campaign", str(HOP), *options, "--fail-on", "failed")[0] == 1
    code, _, told = called("campaign", str(HOP), *options, "--planner", "windaware")
    assert (code, "not limits=" in told) == (2, True)
    code, text, _ = called("campaign", "replay", str(out), "0")
    assert (code, "same bytes as in the campaign" in text) == (
        1,
        True,
    )  # as `galeway fly`: it broke its limit
    assert recording(out, 0).read_bytes() == (out / "replay_000000" / "flight.mcap").read_bytes()
    assert b'limits=["cross_track_m.p95 <= 0.000001"]' in recording(out, 0).read_bytes()


def test_a_scenario_that_lacks_what_is_set_is_flown_reported_and_flown_again(called, tmp_path):
    path, out = tmp_path / "template.toml", str(tmp_path / "out")
    path.write_text(HOP.read_text().replace('goal = "There"', 'goal = "to be named"'))
    options = ("--runs", "1", "--workers", "1", "--keep", "all", "--out", out)
    code, _, told = called("campaign", str(path), *options)
    assert (code, "'to be named' is not among the goals There" in told) == (2, True)
    assert not Path(out).exists()
    code, text, told = called("campaign", str(path), *options, "--goal", "There")
    assert (code, "1 flight, 1 (100.0 %) passed" in text) == (0, True), told
    code, text, _ = called("campaign", "replay", out, "0")
    assert (code, "same bytes as in the campaign" in text) == (0, True)


def test_a_folder_of_another_version_that_cannot_be_gone_on_with_is_told(called, tmp_path):
    (tmp_path / "campaign.json").write_text('{"scenario": "hop", "runs": 1}')
    for arguments in (
        (str(HOP), "--runs", "1", "--out", str(tmp_path)),
        ("report", str(tmp_path)),
        ("replay", str(tmp_path), "0"),
    ):
        code, _, told = called("campaign", *arguments)
        assert code == 2
        assert len(told.splitlines()) == 1
        assert "missing required field" in told
        assert "another version wrote it" in told
        assert "name another folder" in told


def test_a_replay_with_other_bytes_fails_and_says_which_source_made_the_first(called, tmp_path):
    out = tmp_path / "out"
    options = ("--runs", "1", "--workers", "1", "--fail-on", "failed", "--out", str(out))
    assert called("campaign", str(HOP), *options)[0] == 0  # all passed
    rows = pq.read_table(out / "flights.parquet")
    for name in ("recording_sha256", "source_sha256"):
        rows = rows.set_column(rows.column_names.index(name), name, [["0123"]])
    pq.write_table(rows, out / "flights.parquet")
    code, _, told = called("campaign", "replay", str(out), "0")
    assert (code, "not the same as in the campaign; it was made with source_sha256 0123, now" in told) == (
        1,
        True,
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([str(HOP), "--runs", "0"], "0 is not in the range"),
        ([str(HOP), "--runs", "two"], "not a valid integer"),
        ([str(HOP)], "--runs"),
        ([str(HOP), "--runs", "1", "--workers", "0"], "--workers"),
        ([str(HOP), "--runs", "1", "--keep", "best"], "none of all, failed, none and worst:N"),
        ([str(HOP), "--runs", "1", "--flight-timeout", "0"], "--flight-timeout"),
        ([str(HOP), "--runs", "1", "--vary", "turbulence.severty=1"], "did you mean 'severity'?"),
        ([str(HOP), "--runs", "1", "--set", "turbulence.severty=1"], "did you mean 'severity'?"),
        ([str(HOP), "--runs", "1", "--fail-on", "crash"], "--fail-on"),
        (["hopp", "--runs", "1"], "no scenario 'hopp'"),
        (["report"], "there is no campaign in"),
        (["replay", "1"], "there is no campaign in"),
    ],
)
def test_bad_input_ends_in_a_message(arguments, words, tmp_path, called):
    where = [str(tmp_path)] if arguments[0] in ("report", "replay") else ["--out", str(tmp_path / "out")]
    code, _, told = called("campaign", arguments[0], *where, *arguments[1:])
    assert code == 2
    assert words in told
    assert "Traceback" not in told
    assert not (tmp_path / "out").exists()
