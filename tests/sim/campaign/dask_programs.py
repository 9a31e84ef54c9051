"""A Dask cluster of this machine, from its command-line programs, as the documents say."""

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

ROOT = Path(__file__).resolve().parents[3]
DASK = str(Path(sys.executable).parent / "dask")
START_S = 120.0


class Cluster:
    """A scheduler, and workers that are started as they are wanted; each with a nanny, as is usual."""

    def __init__(self, folder: Path, allowed_failures: int) -> None:
        folder.mkdir(exist_ok=True)
        self.folder, self.processes = folder, []
        path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
        self.environment = os.environ | {
            "PYTHONPATH": path,
            "PYTHONWARNINGS": "default",
            "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": str(allowed_failures),
            "DASK_TEMPORARY_DIRECTORY": str(folder),
        }
        self.scheduler = self._started("scheduler", "--host", "127.0.0.1", "--port", "0")
        self.address = self._logged(self.scheduler, r"Scheduler at:\s+(tcp://\S+)")

    def start_worker(self, *options: str) -> subprocess.Popen:
        """Start one, with one thread if nothing else is said, and wait until the scheduler knows it."""
        worker = self._started("worker", self.address, *(options or ("--nthreads", "1")))
        self._logged(worker, r"Registered to:\s+(\S+)")
        return worker

    @staticmethod
    def kill_worker(worker: subprocess.Popen) -> None:
        """Kill the process that works, under its nanny, which starts another."""
        children = psutil.Process(worker.pid).children()
        (working,) = [child for child in children if "spawn_main" in " ".join(child.cmdline())]
        working.kill()

    def log(self, process: subprocess.Popen) -> str:
        return (self.folder / f"{process.args[1]}-{self.processes.index(process)}.log").read_text()

    def close(self) -> None:
        """End the workers, then the scheduler, which they take leave of."""
        for process in self.processes[1:]:
            process.terminate()
        for process in reversed(self.processes):
            process.terminate()
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def _started(self, *words: str) -> subprocess.Popen:
        log = self.folder / f"{words[0]}-{len(self.processes)}.log"
        with log.open("wb") as file:
            process = subprocess.Popen(
                [DASK, *words, "--no-dashboard"], env=self.environment, stdout=file, stderr=file
            )
        self.processes.append(process)
        return process

    def _logged(self, process: subprocess.Popen, pattern: str) -> str:
        end_s = time.monotonic() + START_S
        while not (found := re.search(pattern, self.log(process))):
            assert process.poll() is None, self.log(process)
            assert time.monotonic() < end_s, self.log(process)
            time.sleep(0.05)
        return found[1]


@contextmanager
def started(folder: Path, allowed_failures: int = 3) -> Iterator[Cluster]:
    """A scheduler without workers."""
    cluster = Cluster(folder, allowed_failures)
    try:
        yield cluster
    finally:
        cluster.close()
