"""Serves a Rerun file and the viewer to a browser on this machine; it needs no internet."""

from __future__ import annotations

import signal
import socket
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryFile
from urllib.parse import quote

from recordings.errors import RecordingError
from recordings.rerun_viewer import PATIENCE_S, complaint
from recordings.viewer_program import LOCAL, free_port, viewer

_PAGE_PORT, _DATA_PORT = 9090, 9876  # Rerun's own, where they are free


def serve(path: Path, say: Callable[[str], object]) -> None:
    """Serve a Rerun file until Ctrl-C.

    Args:
        path: the file.
        say: told the address to open.

    Raises:
        RecordingError: if the server does not start.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # so that it ends like Ctrl-C
    page, data = free_port(_PAGE_PORT), free_port(_DATA_PORT)
    command: list[str | Path] = [
        viewer(),
        "--serve-web",
        f"--bind={LOCAL}",
        f"--port={data}",
        f"--web-viewer-port={page}",
        path,
    ]
    with TemporaryFile() as log:
        process = subprocess.Popen(command, stdout=log, stderr=log)
        try:
            _wait_until_served(process, page, data)
            source = quote(f"rerun+http://{LOCAL}:{data}/proxy", safe="")
            if process.poll() is None:
                say(f"http://{LOCAL}:{page}/?url={source}\nserved on this machine alone; Ctrl-C ends it")
                process.wait()
        except KeyboardInterrupt:
            return
        finally:
            process.kill()
            process.wait()
        raise RecordingError(f"the Rerun server ended with status {process.returncode}: {complaint(log)}")


def _wait_until_served(process: subprocess.Popen[bytes], *ports: int) -> None:
    """Return when all ports take connections, or the server has ended."""
    deadline = time.monotonic() + PATIENCE_S
    for port in ports:
        while process.poll() is None:
            try:
                socket.create_connection((LOCAL, port), timeout=5.0).close()
                break
            except OSError as error:
                if time.monotonic() > deadline:
                    raise RecordingError(f"the Rerun server does not listen on {port}: {error}") from error
                time.sleep(0.1)
