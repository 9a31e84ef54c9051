"""Flights that are watched: whatever becomes of the viewer, the flight and its files are the same."""

import os
import signal
import socket
import subprocess
import sys
import time

import psutil
import pytest
from rerun.experimental import ViewerClient

from recordings.mcap_writer import McapRecorder
from recordings.recorder import Outcome, Recorders
from recordings.rerun_writer import RerunRecorder
from recordings.viewer_program import free_port, viewer
from sim.closed_loop import fly
from sim.watching import Pace, watched

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="live views need a POSIX system"),
    pytest.mark.filterwarnings("ignore:.*is still running:pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore:subprocess .* is still running:ResourceWarning"),
]

PATIENCE_S = 60.0


def headless(port):
    return ("--headless", "--hide-welcome-screen", f"--port={port}", "--window-size=800x450")


@pytest.fixture(scope="module")
def unwatched(tmp_path_factory):
    """The MCAP and the Rerun file of the flight when nobody watches; flown at the first use."""
    folder = tmp_path_factory.mktemp("unwatched")

    def flown(ready):
        if not (folder / "flight.rrd").exists():
            record(ready(), folder, lambda _: None)
        return folder

    return flown


def record(setup, folder, on_time):
    recorders = Recorders([McapRecorder(folder / "flight.mcap"), RerunRecorder(folder / "flight.rrd")])
    end = fly(setup, recorders, on_time)
    assert end.outcome is Outcome.ARRIVED


@pytest.fixture
def watching(ready, tmp_path, unwatched):
    """Flies the short flight watched: (what to do to viewers at a time of flight) -> processes left."""
    before = {process.pid for process in psutil.Process().children()}

    def flown(act=None, at_s=300.0, window=(), pace=None):
        acted, helpers = act is None, []
        with watched(tmp_path / "flight.partial.rrd", live=True, pace=pace, window=window) as watch:

            def on_time(time_s):
                nonlocal acted
                watch(time_s)
                helpers.append(helpers[0] if helpers else helper())
                if not acted and time_s > at_s:
                    acted = True
                    act(helpers[0])

            record(ready(), tmp_path, on_time)
        alone = unwatched(ready)
        assert (tmp_path / "flight.mcap").read_bytes() == (alone / "flight.mcap").read_bytes()
        assert same_content(tmp_path / "flight.rrd", alone / "flight.rrd")
        return helpers[0]

    def helper():
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            for child in psutil.Process().children():
                if child.pid not in before and "recordings.live" in child.cmdline():
                    return child
            time.sleep(0.01)  # it is not yet what it is going to be
        raise AssertionError("nothing shows the flight")

    yield flown
    for child in psutil.Process().children(recursive=True):
        if child.pid not in before:
            child.kill()


def viewer_of(helper):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        for child in helper.children():
            if "--headless" in child.cmdline():
                return child
        time.sleep(0.02)
    raise AssertionError("no viewer was started")


def same_content(one, other):
    done = subprocess.run(
        [viewer(), "rrd", "compare", "--unordered", one, other], check=False, capture_output=True
    )
    return done.returncode == 0


def ends(process):
    try:
        process.wait(PATIENCE_S)
    except psutil.TimeoutExpired:
        return False
    return True


@pytest.mark.usefixtures("vulkan")
def test_a_viewer_sees_the_whole_flight_and_outlives_it(watching):
    port = free_port()
    helper = watching(window=headless(port))
    seen = viewer_of(helper)
    ended_s, deadline = None, time.monotonic() + PATIENCE_S
    while ended_s is None and time.monotonic() < deadline:
        assert seen.is_running()
        try:
            state = ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy").get_state()
        except (RuntimeError, ConnectionError, TimeoutError):
            time.sleep(0.2)
            continue
        ended_s = next(
            (
                line.end / 1e9
                for one in state.recordings
                for line in one.timelines
                if line.name == "flight_time"
            ),
            None,
        )
    assert ended_s == pytest.approx(1080.0, abs=5.0)
    seen.terminate()
    assert ends(helper)


@pytest.mark.usefixtures("vulkan")
def test_a_viewer_that_is_stopped_does_not_hold_the_flight(watching):
    helper = watching(
        lambda helper: viewer_of(helper).send_signal(signal.SIGSTOP), at_s=-10.0, window=headless(free_port())
    )
    seen = viewer_of(helper)
    assert seen.status() == psutil.STATUS_STOPPED
    seen.kill()
    assert ends(helper)


@pytest.mark.usefixtures("vulkan")
def test_a_viewer_that_is_killed_in_mid_flight_is_not_missed(watching, capfd):
    helper = watching(lambda helper: viewer_of(helper).kill(), window=headless(free_port()), pace=1500.0)
    assert ends(helper)
    assert "the viewer has ended with status -9; the flight is recorded without it" in capfd.readouterr().err


@pytest.mark.skipif(sys.platform != "linux", reason="other systems always have a screen")
def test_without_a_screen_the_flight_is_served_to_others(watching, capfd, monkeypatch, tmp_path):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    copy, told = tmp_path / "copy.rrd", []

    def watch_from_elsewhere(_):
        deadline = time.monotonic() + PATIENCE_S
        while "ssh -L" not in "".join(told) and time.monotonic() < deadline:
            time.sleep(0.05)
            told.append(capfd.readouterr().err)
        url = "".join(told).split("live at ")[1].split()[0]
        subprocess.Popen(
            [viewer(), url, "--save", copy, "--port=auto", "--bind=127.0.0.1"], stderr=subprocess.DEVNULL
        )

    assert ends(watching(watch_from_elsewhere, at_s=100.0, pace=400.0))
    assert "there is no screen for a viewer; on a machine with one: `ssh -L " in "".join(told)
    assert copy.stat().st_size > 1_000_000


def test_a_busy_port_is_no_obstacle():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert free_port(port) not in (0, port)


def test_a_pace_makes_a_flight_last_as_long_as_it_says():
    slept = []

    class Clock:
        now_s = 100.0

        def monotonic(self):
            return self.now_s

        def sleep(self, time_s):
            slept.append(time_s)
            self.now_s += time_s

    clock = Clock()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sim.watching.time", clock)
        wait = Pace(60.0)
        for time_s in (-30.0, 0.0, 30.0, 90.0):
            wait(time_s)
        clock.now_s += 10.0  # the flight was slower than the pace
        wait(120.0)
    assert slept == pytest.approx([0.5, 0.5, 1.0])
