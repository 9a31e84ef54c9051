"""What a worker of a cluster does with a chunk: hand it to a process of its own, and wait.

Tasks are not done in the worker itself: one that aborts, or never ends, would take the worker with it and
whatever else it is at, and the cluster would send it to the next. The process stays from chunk to chunk, and
keeps what its tasks share; there is one for each of the worker's threads, so that threads do no harm either.
"""

from __future__ import annotations

import multiprocessing
import pickle
import shutil
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from platform import node
from typing import Any

from sim.campaign.executor import Lost
from sim.campaign.pool import LocalPool
from sim.campaign.premises import Premises
from sim.errors import CampaignError


@dataclass(frozen=True, slots=True)
class Errand:
    """Chunk to answers, in order.

    `name`: tells it from all others, so that it can be called off. `work`: pickled, and left so until it is
    where it is done: what it needs takes seconds to import, in which a scheduler or worker does not answer.
    """

    name: str
    work: bytes
    timeout_s: float
    premises: Premises

    def __call__(self, chunk: Sequence[Any]) -> list[Any]:
        """Do a chunk.

        Returns:
            Of each task the result, or how it was `Lost`.

        Raises:
            Exception: what the work raised.
            CampaignError: if this machine is not fit for it, or it has been called off.
        """
        with _here.process_for(self) as process:
            return process.answers(chunk)

    def call_off(self) -> None:
        """End what is being done of it here, and do no more of it."""
        _here.call_off(self.name)


@dataclass(frozen=True, slots=True)
class _Unpacked:
    """Stands for pickled work, and is that itself in the process that it is sent to."""

    work: bytes
    scratch: str

    def __call__(self, task: Any) -> Any:
        return _unpack(self.work, self.scratch)(task)

    def __reduce__(self) -> tuple[Callable[[bytes, str], Any], tuple[bytes, str]]:
        return _unpack, (self.work, self.scratch)


def _unpack(work: bytes, scratch: str) -> Any:
    """The work, whose temporary files are in a folder that is taken away, whatever becomes of the process."""
    tempfile.tempdir = scratch
    return pickle.loads(work)


class _Process:
    """A process that is given one chunk after the other."""

    def __init__(self, errand: Errand) -> None:
        self.errand = errand
        self._is_stopped = False
        self._pool = LocalPool(1, errand.timeout_s)
        self._given = deque[Sequence[Any]]()
        self._scratch = tempfile.TemporaryDirectory(prefix="galeway-worker-", ignore_cleanup_errors=True)
        self._results = self._pool.results(_Unpacked(errand.work, self._scratch.name), self._chunks())
        self._answers = chain.from_iterable(self._results)

    def _chunks(self) -> Iterator[Sequence[Any]]:
        while True:  # the pool asks for a chunk only when it is to answer, and then there is one
            yield self._given.popleft()

    def answers(self, chunk: Sequence[Any]) -> list[Any]:
        """Those to a chunk; one process gives them in order."""
        self._given.append(chunk)
        found = []
        for _, answer in islice(self._answers, len(chunk)):
            if self._is_stopped:
                raise _called_off()
            if isinstance(answer, Lost):  # and nobody is at the next one yet
                for left in Path(self._scratch.name).iterdir():
                    shutil.rmtree(left, ignore_errors=True)
            found.append(answer)
        return found

    def stop(self) -> None:
        """End it, while another thread waits for its answers."""
        self._is_stopped = True
        self._pool.stop()

    def close(self) -> None:
        """End it; nobody waits for its answers."""
        self._results.close()
        self._scratch.cleanup()


class _Here:
    """The processes that this one has begun."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._idle: list[_Process] = []
        self._busy: list[_Process] = []
        self._fit_for: set[str] = set()
        self._called_off: set[str] = set()

    @contextmanager
    def process_for(self, errand: Errand) -> Iterator[_Process]:
        """One that has done something of the errand before, if there is one, or a new one.

        Those of an earlier errand make room, however it ended.
        """
        self._require_fit(errand)
        with self._lock:
            if errand.name in self._called_off:
                raise _called_off()
            process = next((one for one in self._idle if one.errand.name == errand.name), None)
            if process is not None:
                self._idle.remove(process)
            else:
                if self._idle:
                    self._idle.pop(0).close()
                process = _Process(errand)
            self._busy.append(process)
        is_sound = False
        try:
            yield process
            is_sound = True
        finally:
            with self._lock:
                self._busy.remove(process)
                if is_sound and errand.name not in self._called_off:
                    self._idle.append(process)
                else:
                    process.close()

    def _require_fit(self, errand: Errand) -> None:
        """Pass if this machine is like the leading one; workers may have come after those were compared."""
        if errand.name not in self._fit_for:
            if told := errand.premises.complaints():
                raise CampaignError(f"a worker on {node()} is not fit for the campaign: {'; '.join(told)}")
            multiprocessing.current_process().daemon = False  # it may have children: they end with it
            self._fit_for.add(errand.name)

    def call_off(self, name: str) -> None:
        """End those of an errand."""
        with self._lock:
            self._called_off.add(name)
            for process in self._busy:
                if process.errand.name == name:
                    process.stop()
            for process in [one for one in self._idle if one.errand.name == name]:
                self._idle.remove(process)
                process.close()


def _called_off() -> CampaignError:
    return CampaignError("the campaign was called off")


_here = _Here()
