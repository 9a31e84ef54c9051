"""Flights that are stopped: what they leave, and what they say of it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from planner.plans import Plan
from sim.cli import main

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")
FAR = '[{name="There", lat_deg=29.1, lon_deg=-91.4}]'


@pytest.mark.parametrize(("name", "code"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGKILL", -signal.SIGKILL)])
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
    assert process.returncode == code, stderr
    assert "Traceback" not in stderr
    assert (f"galeway: interrupted; recorded so far: {partial}" in stderr) == (code > 0)
    assert not (tmp_path / "flight.mcap").exists()
    checked = galeway("check", str(partial), "--json")
    assert checked.returncode == 1
    assert json.loads(checked.stdout)["samples"] > 100


@pytest.mark.parametrize(
    ("begun", "kept", "told"),
    [(False, 1.0, "before anything"), (True, 0.005, "before anything"), (True, 0.5, "recorded so far: ")],
)
def test_an_interrupted_flight_names_only_what_can_be_read(
    flown, monkeypatch, capsys, tmp_path, begun, kept, told
):
    content = (flown[1] / "flight.mcap").read_bytes()
    partial = tmp_path / "flight.partial.mcap"
    partial.write_bytes(content[: int(len(content) * kept)])
    plan = Plan.from_json((flown[1] / "plan.json").read_bytes())

    def interrupted(_, __, *, on_plan, on_time, tell=None):
        on_plan(plan)
        if begun:
            on_time(0.0)
        raise KeyboardInterrupt

    monkeypatch.setattr("sim.job.run", interrupted)
    monkeypatch.setattr(sys, "argv", ["galeway", "fly", SHORT, "--out", str(tmp_path)])
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 130
    error = capsys.readouterr().err
    assert told in error
    assert (str(partial) in error) == (told == "recorded so far: ")
