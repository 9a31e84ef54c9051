"""Shows a recording: in the viewer, or as a picture made without a screen."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import IO

from rerun.experimental import ViewerClient

from recordings.errors import BadRecordingError, RecordingError
from recordings.rerun_times import TIMELINE

_MAGIC = b"RRF2"
_PATIENCE_S = 120.0
_SETTLING_S = 1.5
_NO_DRIVER = ("No graphics adapter", "Failed to get render context")
_REMEDY = (
    "there is no Vulkan driver; on Debian and Ubuntu `apt-get install mesa-vulkan-drivers libvulkan1` "
    "brings one that needs no graphics card"
)
_REFUSED = (ConnectionError, TimeoutError, OSError, RuntimeError)


def replay(path: Path) -> None:
    """Open a recording in the Rerun viewer, and return when its window is closed.

    Args:
        path: the Rerun recording, or the MCAP recording that lies beside it.

    Raises:
        RecordingError: if there is no such recording, no screen, or the viewer does not start.
    """
    recording = rerun_file(path)
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise RecordingError(
            f"there is no screen to show {recording} on; copy it to a machine that has one and open it "
            "there with `galeway replay`"
        )
    try:
        status = subprocess.run(
            [_viewer(), "--new", "--bind", "127.0.0.1", recording], check=False
        ).returncode
    except KeyboardInterrupt:
        return
    if status != 0:
        raise RecordingError(f"the Rerun viewer ended with status {status}; its own message stands above")


def picture(path: Path, out: Path, at_s: float | None = None, size: tuple[int, int] = (1600, 900)) -> None:
    """Draw a recording as it opens in the viewer, as a PNG; no screen is needed, but a Vulkan driver is.

    Args:
        path: the Rerun recording, or the MCAP recording that lies beside it.
        out: the PNG to write.
        at_s: moment to show, since departure; the end if None.
        size: width and height in pixels.

    Raises:
        RecordingError: if there is no such recording, no Vulkan driver, or the picture cannot be written.
    """
    recording = rerun_file(path).resolve()
    if not out.resolve().parent.is_dir():
        raise RecordingError(f"cannot write {out}: there is no folder {out.parent}; make it first")
    with tempfile.TemporaryDirectory() as folder, _headless(Path(folder), size) as client:
        drawn = Path(folder) / "picture.png"
        client.open(str(recording))
        _wait_until_loaded(client)
        if at_s is not None:
            client.set_time(TIMELINE, duration=at_s, play_state="paused")
        _draw(client, drawn)
        shutil.copyfile(drawn, out)


def rerun_file(path: Path) -> Path:
    """The Rerun recording of a flight: the path itself, or the file beside an MCAP recording.

    Raises:
        RecordingError: if there is none.
    """
    recording = path.with_suffix(".rrd") if path.suffix == ".mcap" else path
    if not recording.is_file():
        beside = f" beside {path.name}" if recording != path else ""
        raise RecordingError(
            f"there is no Rerun recording {recording}{beside}; `galeway fly` writes one for each flight"
        )
    with recording.open("rb") as stream:
        if stream.read(len(_MAGIC)) != _MAGIC:
            raise BadRecordingError(
                f"{recording} is not a Rerun recording; give a .rrd file, or the .mcap file beside it"
            )
    return recording


def _viewer() -> Path:
    """The viewer itself: the `rerun` command is a wrapper that leaves it running when it is killed."""
    package = find_spec("rerun_cli")
    folder = Path(package.origin).parent if package and package.origin else Path()
    found = shutil.which("rerun", path=folder)
    if found is None:
        raise RecordingError("the Rerun viewer is not installed; `pip install rerun-sdk` brings it")
    return Path(found)


@contextmanager
def _headless(folder: Path, size: tuple[int, int]) -> Iterator[ViewerClient]:
    """A viewer without a window, ended when the block ends, however it ends."""
    port = _free_port()
    command = [
        str(_viewer()),
        "--headless",
        "--hide-welcome-screen",
        "--bind=127.0.0.1",
        f"--port={port}",
        f"--window-size={size[0]}x{size[1]}",
    ]
    environment = os.environ | {"RUST_LOG": "error"}  # what it logs it also shows in the picture
    with (folder / "viewer.log").open("w+b") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log, cwd=folder, env=environment)
        try:
            yield _connect(process, f"rerun+http://127.0.0.1:{port}/proxy", log)
        except _REFUSED as error:
            raise RecordingError(f"the Rerun viewer failed: {_complaint(log) or error}") from error
        finally:
            process.kill()
            process.wait()


def _connect(process: subprocess.Popen[bytes], url: str, log: IO[bytes]) -> ViewerClient:
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise RecordingError(f"the Rerun viewer does not start: {_complaint(log)}")
        try:
            client = ViewerClient.connect(url)
            client.get_state()
        except _REFUSED:
            time.sleep(0.1)
        else:
            return client
    raise RecordingError(f"the Rerun viewer does not answer within {_PATIENCE_S:.0f} s; try again")


def _complaint(log: IO[bytes]) -> str:
    """What the viewer said, and the remedy where it is known."""
    log.seek(0)
    text = log.read().decode(errors="replace")
    if any(words in text for words in _NO_DRIVER):
        return _REMEDY
    lines = [line for line in text.splitlines() if "panicked" in line or "ERROR" in line]
    return lines[0] if lines else ""


def _wait_until_loaded(client: ViewerClient) -> None:
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline:
        state = client.get_state()
        if not state.loading and any(recording.timelines for recording in state.recordings):
            return
        time.sleep(0.2)
    raise TimeoutError(f"nothing to show within {_PATIENCE_S:.0f} s")


def _draw(client: ViewerClient, out: Path) -> None:
    """Draw until two pictures in a row are the same: plots and textures come in over several frames."""
    before = b""
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline:
        time.sleep(_SETTLING_S)
        client.save_screenshot(str(out))
        drawn = out.read_bytes()
        if drawn == before:
            return
        before = drawn
    raise TimeoutError(f"the picture does not settle within {_PATIENCE_S:.0f} s")


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
