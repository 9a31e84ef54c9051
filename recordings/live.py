"""Shows a flight while it is recorded, from a process of its own: `python -m recordings.live FILE`.

Nothing of it stands between a flight and its files. The recorder writes its Rerun file as ever; this process
reads what has been written, hands it to a server at the pace at which that takes it, and opens a viewer on
the server. It knows that the flight is over, however it ended, by the end of its own standard input, and ends
when the viewer's window is closed then. (Rerun's server inside the recording process would be less: where it
fails, so does the recorder's last write, and what a slow viewer has not taken at the end is lost to it.)
"""

from __future__ import annotations

import os
import select
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from recordings.errors import RecordingError
from recordings.viewer_program import LOCAL, free_port, has_screen, viewer

_PORT = 9876  # where Rerun's viewers look for a server if they are not told
_MEMORY = "1GiB"  # what the server keeps for viewers that come late; beyond it drops the oldest
_BLOCK_BYTES = 1 << 20
_PAUSE_S = 0.1
_PATIENCE_S = 10.0
_UNSEEN = "the flight cannot be watched, and goes on"
_SILENT: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
_GRACE_S = 2.0  # for viewers elsewhere to take the last of a flight


def check_system() -> None:
    """Refuse what cannot work before the flight begins.

    Raises:
        RecordingError: on a system where a file that is read cannot be renamed.
    """
    if os.name == "nt":
        raise RecordingError("--live needs a system on which an open file can be renamed; fly without it")


def show(recording: Path, window: Sequence[str] = ()) -> subprocess.Popen[bytes] | None:
    """Start to show a recording that is being written; the flight is over when the process's input is closed.

    Args:
        recording: the Rerun file, under its unfinished name.
        window: options of the viewer; if none, one with a window is opened where there is a screen.

    Returns:
        The process; None if it cannot be started, which is said on the standard error.
    """
    try:
        return subprocess.Popen(
            [sys.executable, "-P", "-m", "recordings.live", recording, *window],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            start_new_session=True,  # Ctrl-C ends the flight, and leaves what was flown on the screen
        )
    except OSError as error:
        _say(f"{_UNSEEN}: {error}")
        return None


def main(recording: Path, window: Sequence[str]) -> None:
    """Serve a growing file and open a viewer on it, until the flight is over and the viewer closed."""
    with recording.open("rb", buffering=0) as file:
        program = viewer()
        server, port = _served(program, file)
        try:
            _say(f"live at {_url(port)}")
            opened = _opened(program, port, window)
            try:
                _feed(file, server, opened)
            except BrokenPipeError:
                _say("the server of the live view has ended; the flight is recorded without it")
            _fall_silent()
            if opened:
                opened.wait()
            else:
                time.sleep(_GRACE_S)
        finally:
            server.kill()
            server.wait()


def _served(program: Path, file: IO[bytes]) -> tuple[subprocess.Popen[bytes], int]:
    """A server that has the beginning of the file, and its port; another if the first was taken meanwhile."""
    while not (head := file.read(_BLOCK_BYTES)):
        if _is_over(_PAUSE_S):
            raise RecordingError("nothing of it was recorded")
    for wanted in (_PORT, 0, 0):
        port = free_port(wanted)
        serving = ("--serve-grpc", f"--bind={LOCAL}", f"--port={port}", f"--server-memory-limit={_MEMORY}")
        server = subprocess.Popen([program, *serving, "-"], stdin=subprocess.PIPE, bufsize=0, **_SILENT)
        with suppress(BrokenPipeError):
            _write(server, head)  # it listens only when it has something to serve
            if _listens(server, port):
                return server, port
    raise RecordingError("the server of the live view does not start; fly without --live")


def _listens(server: subprocess.Popen[bytes], port: int) -> bool:
    """Whether it is still there when its port takes connections, which may be another's who was quicker."""
    deadline_s = time.monotonic() + _PATIENCE_S
    while server.poll() is None and time.monotonic() < deadline_s:
        with suppress(OSError), socket.create_connection((LOCAL, port), timeout=_PATIENCE_S):
            break
        time.sleep(_PAUSE_S)
    time.sleep(_PAUSE_S)
    return server.poll() is None


def _url(port: int) -> str:
    return f"rerun+http://{LOCAL}:{port}/proxy"


def _opened(program: Path, port: int, window: Sequence[str]) -> subprocess.Popen[bytes] | None:
    """A viewer connected to the server, if there is a screen or it needs none."""
    if not window and not has_screen():
        _say(
            f"there is no screen for a viewer; on a machine with one: `ssh -L {port}:{LOCAL}:{port} "
            f"{socket.gethostname()}`, and there `rerun --connect {_url(port)}`"
        )
        return None
    return subprocess.Popen([program, "--connect", _url(port), f"--bind={LOCAL}", *window], **_SILENT)


def _feed(file: IO[bytes], server: subprocess.Popen[bytes], opened: subprocess.Popen[bytes] | None) -> None:
    """Copy the file as it grows, until the flight is over; say so if the viewer fails."""
    over = False
    while not over:
        over = _is_over(_PAUSE_S)  # asked before reading: what is written later is read later
        while block := file.read(_BLOCK_BYTES):
            _write(server, block)
        if opened and opened.poll():  # a window that was closed gives 0, and needs no word
            _say(f"the viewer has ended with status {opened.returncode}; the flight is recorded without it")
            opened = None


def _write(server: subprocess.Popen[bytes], block: bytes) -> None:
    """All of it, when the server takes it."""
    assert server.stdin is not None
    rest = memoryview(block)
    while rest:
        rest = rest[server.stdin.write(rest) :]


def _is_over(patience_s: float) -> bool:
    """Whether the process that flies has closed its end, or has ended."""
    readable, _, _ = select.select([sys.stdin], [], [], patience_s)
    return bool(readable) and not os.read(sys.stdin.fileno(), 1)


def _say(text: str) -> None:
    print(f"galeway: {text}", file=sys.stderr, flush=True)


def _fall_silent() -> None:
    """Let go of the standard error: who waits for its end waits for the flight, not for the viewer."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stderr.fileno())
    os.close(nowhere)


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), sys.argv[2:])
    except (OSError, RecordingError) as problem:
        _say(f"{_UNSEEN}: {problem}")
