"""A Dask cluster on this machine, from Dask's own programs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

START_S = 120.0


class Started(NamedTuple):
    """Where the scheduler is, and its process."""

    address: str
    scheduler_pid: int


@contextmanager
def cluster(workers: int) -> Iterator[Started]:
    """A scheduler and workers of one thread each, which end with the context."""
    from distributed import Client

    with TemporaryDirectory() as folder:
        found = Path(folder) / "scheduler.json"
        processes: list[subprocess.Popen[bytes]] = []

        def start(*words: str) -> None:
            command = [str(Path(sys.executable).parent / "dask"), *words, "--no-dashboard"]
            processes.append(
                subprocess.Popen(
                    command,
                    env=os.environ | {"DASK_TEMPORARY_DIRECTORY": folder},
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
            )

        try:
            start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(found))
            address = _address(found)
            for _ in range(workers):
                start("worker", address, "--nthreads", "1")
            with Client(address, set_as_default=False) as client:
                client.wait_for_workers(workers, timeout=START_S)
            yield Started(address, processes[0].pid)
        finally:
            for process in reversed(processes):  # the scheduler last, of which workers take leave
                process.terminate()
                process.wait()


def _address(file: Path) -> str:
    end_s = time.monotonic() + START_S
    while time.monotonic() < end_s:
        if file.exists() and (text := file.read_text(encoding="utf-8")):
            return str(json.loads(text)["address"])
        time.sleep(0.05)
    raise SystemExit(f"no scheduler within {START_S:.0f} s")
