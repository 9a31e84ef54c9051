"""Shows a Rerun file: in the viewer, in a browser, or as a picture made without a screen."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from PIL import Image  # comes with rerun-sdk
from rerun.experimental import ViewerClient

from recordings.errors import RecordingError
from recordings.rerun_shown import last_time_s
from recordings.rerun_times import TIMELINE
from recordings.rerun_viewer import PATIENCE_S, headless
from recordings.viewer_program import LOCAL, has_screen, viewer

SIZE_PX = (1600, 900)
"""Of a picture; what the arrangement of a recording is made for."""

_SETTLING_S = 1.5


def replay(path: Path) -> None:
    """Open a Rerun file in the viewer, and return when its window is closed.

    Raises:
        RecordingError: if there is no screen, or the viewer does not start.
    """
    if not has_screen():
        raise RecordingError(
            "there is no screen to show it on; `galeway replay --web` serves it to a browser, and "
            "`galeway picture` draws it to a file"
        )
    try:
        status = subprocess.run([viewer(), "--new", f"--bind={LOCAL}", path], check=False).returncode
    except KeyboardInterrupt:
        return
    if status != 0:
        raise RecordingError(f"the Rerun viewer ended with status {status}; its own message stands above")


def picture(
    path: Path,
    out: Path,
    at_s: float | None = None,
    size_px: tuple[int, int] = SIZE_PX,
    *,
    small: bool = False,
) -> None:
    """Draw a Rerun file as it opens in the viewer, as a PNG; no screen is needed, but a Vulkan driver is.

    Args:
        path: the Rerun file of a flight.
        out: the PNG to write.
        at_s: moment to show, since departure; the end of the flight if None.
        size_px: width and height.
        small: reduce it to 256 colours, which takes a third of the bytes.

    Raises:
        RecordingError: if the moment is not in the flight, there is no Vulkan driver, or the picture is
            not to be a PNG or cannot be written.
    """
    _check_writable(out)
    end_s = last_time_s(path)
    at_s = end_s if at_s is None else at_s
    _check_within(at_s, end_s)
    with tempfile.TemporaryDirectory(prefix="galeway-") as folder, headless(Path(folder), size_px) as client:
        drawn = Path(folder) / "picture.png"
        client.open(str(path.resolve()))
        _wait_until_loaded(client)
        client.set_time(TIMELINE, duration=at_s, play_state="paused")
        _draw(client, drawn)
        if small:
            colours = Image.open(drawn).convert("RGB").quantize(256, kmeans=2, dither=Image.Dither.NONE)
            colours.save(drawn, optimize=True)
        try:
            shutil.copyfile(drawn, out)
        except OSError as error:
            raise RecordingError(f"cannot write {out}: {error.strerror}; name another file") from error


def _check_writable(out: Path) -> None:
    """Before the ten seconds that a picture takes."""
    if out.suffix.lower() != ".png":
        raise RecordingError(f"{out} does not end in .png; name a PNG for the picture")
    folder = out.resolve().parent
    if not folder.is_dir():
        raise RecordingError(f"cannot write {out}: there is no folder {out.parent}; make it first")
    if out.is_dir() or not os.access(out if out.exists() else folder, os.W_OK):
        raise RecordingError(f"cannot write {out}: it is a folder or not permitted; name another file")


def _check_within(at_s: float, end_s: float) -> None:
    if not 0.0 <= at_s <= end_s:
        raise RecordingError(
            f"{_clock(at_s)} is not in the flight, which lasts from 0:00:00 to {_clock(end_s)}; choose a "
            "time between them"
        )


def _clock(time_s: float) -> str:
    minutes, seconds = divmod(int(abs(time_s)), 60)
    return f"{'-' if time_s < 0.0 else ''}{minutes // 60}:{minutes % 60:02d}:{seconds:02d}"


def _wait_until_loaded(client: ViewerClient) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        state = client.get_state()
        if not state.loading and any(recording.timelines for recording in state.recordings):
            return
        time.sleep(0.2)
    raise TimeoutError(f"nothing to show within {PATIENCE_S:.0f} s")


def _draw(client: ViewerClient, out: Path) -> None:
    """Draw until two pictures in a row are the same: plots and textures come in over several frames."""
    before = b""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        time.sleep(_SETTLING_S)
        client.save_screenshot(str(out))
        drawn = out.read_bytes()
        if drawn == before:
            return
        before = drawn
    raise TimeoutError(f"the picture does not settle within {PATIENCE_S:.0f} s")
