"""`galeway replay` and `galeway picture` as a user meets them: real processes, files and messages."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import parse_qs, urlsplit
from urllib.request import urlopen

import psutil
import pytest
from PIL import Image

from recordings.viewer_program import viewer

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")


@pytest.fixture(scope="module")
def flown(flown):
    """The folder of the short scenario's flight."""
    return flown[1]


@pytest.fixture
def assert_refused(galeway):
    """Runs the command: (arguments, words of its one message)."""

    def refused(arguments, *words):
        done = galeway(*arguments)
        assert done.returncode == 2, done.stderr
        for word in words:
            assert word in done.stderr
        lines = done.stderr.splitlines()
        assert len([line for line in lines if line.startswith(("galeway:", "Error:"))]) == 1

    return refused


def drawn(galeway, *arguments):
    done = galeway("picture", *arguments)
    assert done.returncode == 0, done.stderr
    return done


@pytest.mark.usefixtures("vulkan")
def test_a_picture_of_an_mcap_recording_at_a_time_in_a_size_and_in_few_colours(galeway, flown, tmp_path):
    out, size = tmp_path / "early.png", ("--size", "800x450", "--small")
    done = drawn(galeway, str(flown / "flight.mcap"), "--at", "0:05", *size, "-o", str(out))
    assert done.stdout == done.stderr == ""
    with Image.open(out) as image:
        assert image.size == (800, 450)
        assert 100 < len(image.convert("RGB").getcolors()) <= 256


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--at", "0:05", "--at", "0:10"), ("--at", "given 2 times")),
        (("-o", "out.jpg"), ("out.jpg does not end in .png",)),
        (("--at", "noon"), ("'noon' is not a time of flight", "6:30")),
        (("--at", "0:60"), ("'0:60' is not a time of flight",)),
        (("--at", "5:00"), ("5:00:00 is not in the flight, which lasts from 0:00:00 to 0:18:0",)),
        (("--size", "1600"), ("'1600' is not a size", "1600x900")),
        (("--size", "1600x9"), ("'1600x9' is not a size", "from 200 to 8000")),
    ],
)
def test_options_that_make_no_sense_are_refused(assert_refused, flown, tmp_path, options, words):
    out = tmp_path / "out.png"
    assert_refused(["picture", flown / "flight.rrd", "-o", out, *options], *words)
    assert not out.exists()


def test_files_that_cannot_be_shown_are_refused(assert_refused, flown, tmp_path):
    (tmp_path / "notes.txt").write_text("fair weather")
    recording, out = flown / "flight.mcap", tmp_path / "o.png"
    assert_refused(["replay", tmp_path / "lost.mcap"], "cannot read the recording", "lost.mcap")
    assert_refused(["replay", tmp_path / "notes.txt"], "notes.txt is not")
    assert_refused(["replay"], "Missing argument")
    assert_refused(["picture", recording], "Missing option '-o'")
    assert_refused(["picture", recording, recording, "-o", out], "is given twice")
    assert_refused(["picture", recording, "-o", tmp_path / "no" / "o.png"], "there is no folder")


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_the_web_viewer_is_served_on_this_machine_until_it_is_interrupted(command, flown, tmp_path, name):
    process = subprocess.Popen(
        [*command, "replay", "--web", str(flown / "flight.rrd")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    address = process.stdout.readline().strip()
    server, *_ = psutil.Process(process.pid).children(recursive=True)
    assert urlsplit(address).hostname == "127.0.0.1"
    assert {connection.laddr.ip for connection in server.net_connections()} == {"127.0.0.1"}
    with urlopen(address, timeout=30) as page:
        assert b"<canvas" in page.read()
    if name == "SIGINT":
        assert_served(
            parse_qs(urlsplit(address).query)["url"][0], flown / "flight.rrd", tmp_path / "copy.rrd"
        )
    process.send_signal(getattr(signal, name))
    _, stderr = process.communicate(timeout=60)
    assert (process.returncode, stderr) == (0, "")
    assert not server.is_running()


def assert_served(url, recording, copy):
    """A client of the server gets the recording."""
    client = subprocess.Popen(
        [viewer(), url, "--save", copy, "--port=auto", "--bind=127.0.0.1"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        time.sleep(0.1)
        if copy.exists() and copy.stat().st_size > 0.8 * recording.stat().st_size:
            break
    else:
        raise AssertionError("the recording is not served")
    client.kill()
    client.wait()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems always have a screen")
def test_without_a_screen_replay_says_what_else_there_is(assert_refused, flown, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert_refused(["replay", flown / "flight.rrd"], "there is no screen", "--web", "galeway picture")


def test_a_live_flight_without_a_screen_ends_as_any_other(command, flown, tmp_path):
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [*command, "fly", SHORT, "--out", str(tmp_path), "--live", "--pace", "2000"],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "flight.mcap").read_bytes() == (flown / "flight.mcap").read_bytes()
    first, *others = [line for line in done.stderr.splitlines() if not line.startswith("flown ")]
    assert first.startswith("galeway: live at rerun+http://127.0.0.1:")
    assert all("there is no screen" in line for line in others)


@pytest.mark.parametrize("pace", ["0", "-3", "fast"])
def test_a_pace_that_makes_no_sense_is_refused(assert_refused, pace):
    assert_refused(["fly", SHORT, "--pace", pace], "'--pace'")
