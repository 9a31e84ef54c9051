"""The Rerun viewer without a window, for pictures."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from rerun.experimental import ViewerClient

from recordings.errors import RecordingError
from recordings.viewer_program import LOCAL, free_port, viewer

PATIENCE_S = 120.0
"""What a viewer may take for anything; where it does not answer for so long, something is wrong."""

_LAST_WORDS_S = 2.0

REFUSED = (ConnectionError, TimeoutError, OSError, RuntimeError)
"""What a viewer's client raises, one or the other, when it is not answered."""

_NO_DRIVER = ("No graphics adapter", "Failed to get render context")
_REMEDY = (
    "there is no Vulkan driver; on Debian and Ubuntu `apt-get install mesa-vulkan-drivers libvulkan1` "
    "brings one that needs no graphics card"
)


@contextmanager
def headless(folder: Path, size: tuple[int, int]) -> Iterator[ViewerClient]:
    """A viewer without a window, ended when the block ends, however it ends.

    Args:
        folder: an empty folder for it to write to.
        size: width and height of what it draws, in pixels.

    Raises:
        RecordingError: if it cannot be started, or does not answer.
    """
    port = free_port()
    command = [
        str(viewer()),
        "--headless",
        "--hide-welcome-screen",
        f"--bind={LOCAL}",
        f"--port={port}",
        f"--window-size={size[0]}x{size[1]}",
    ]
    environment = os.environ | {"RUST_LOG": "error"}  # what it logs it also shows in the picture
    with (folder / "viewer.log").open("w+b") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log, cwd=folder, env=environment)
        try:
            yield _connect(process, f"rerun+http://{LOCAL}:{port}/proxy", log)
        except REFUSED as error:
            with suppress(subprocess.TimeoutExpired):  # one that breaks down has not said why before it ends
                process.wait(_LAST_WORDS_S)
            raise RecordingError(f"the Rerun viewer failed: {complaint(log) or error}") from error
        finally:
            process.kill()
            process.wait()


def _connect(process: subprocess.Popen[bytes], url: str, log: IO[bytes]) -> ViewerClient:
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise RecordingError(f"the Rerun viewer does not start: {complaint(log)}")
        try:
            client = ViewerClient.connect(url)
            client.get_state()
        except REFUSED:
            time.sleep(0.1)
        else:
            return client
    raise RecordingError(f"the Rerun viewer does not answer within {PATIENCE_S:.0f} s; try again")


def complaint(log: IO[bytes]) -> str:
    """What the viewer said, and the remedy where it is known."""
    log.seek(0)
    text = log.read().decode(errors="replace")
    if any(words in text for words in _NO_DRIVER):
        return _REMEDY
    lines = [line for line in text.splitlines() if "panicked" in line or "ERROR" in line]
    return lines[0] if lines else ""
