"""The Rerun viewer as a program: where it is, whether it can open a window, and a port for it."""

from __future__ import annotations

import os
import shutil
import socket
import sys
from importlib.util import find_spec
from pathlib import Path

from recordings.errors import RecordingError

LOCAL = "127.0.0.1"


def viewer() -> Path:
    """The viewer itself: the `rerun` command is a wrapper that leaves it running when it is killed.

    Raises:
        RecordingError: if it is not installed.
    """
    package = find_spec("rerun_cli")
    folder = Path(package.origin).parent if package and package.origin else Path()
    found = shutil.which("rerun", path=folder)
    if found is None:
        raise RecordingError(
            "the Rerun viewer is not installed; `pip install --force-reinstall rerun-sdk` brings it"
        )
    return Path(found)


def has_screen() -> bool:
    """Whether a window can be opened, as far as can be told beforehand."""
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def free_port(wanted: int = 0) -> int:
    """The port that is wanted if nobody has it, else one that is free."""
    for port in (wanted, 0):
        with socket.socket() as probe:
            try:
                probe.bind((LOCAL, port))
            except OSError:
                continue
            return int(probe.getsockname()[1])
    raise RecordingError(f"no port of {LOCAL} is free; close other servers")
