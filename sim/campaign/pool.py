"""The executor of one machine: processes that are started anew (spawn) and told chunks of tasks.

Libraries' pools answer for a task or a chunk as a whole. Here a worker tells of every task when it is begun
and done, so that nothing done is lost with a process that a later task of its chunk ends, and the one that
ended it is known.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import connection, resource_tracker
from typing import Any, Generic

from sim.campaign.executor import Loss, Lost, Result, Task
from sim.errors import CampaignError

_SPAWN = multiprocessing.get_context("spawn")
_MOST_STILLBORN = 3
_START_TIMEOUT_S = 300.0  # Python and its packages come from slow disks, too


class LocalPool:
    """An `Executor` of worker processes; one whose task takes longer than `timeout_s` is ended."""

    is_local = True

    def __init__(self, workers: int, timeout_s: float) -> None:
        self.workers, self._timeout_s = workers, timeout_s
        self._crew: tuple[_Worker[Any, Any], ...] = ()

    def stop(self) -> None:
        """End what is being done, from another thread than the one that waits for it; what was, is lost."""
        for worker in self._crew:
            worker.stop()

    def results(
        self, work: Callable[[Task], Result], chunks: Iterable[Sequence[Task]]
    ) -> Generator[Sequence[tuple[Task, Result | Lost]]]:
        """See `Executor.results`."""
        left, coming = deque[Sequence[Task]](), iter(chunks)
        crew: list[_Worker[Task, Result]] = []
        stillborn = 0
        try:
            while True:
                crew = [worker for worker in crew if not worker.ended]
                for chunk in self._chunks_for(crew, left, coming):
                    idle = next((worker for worker in crew if not worker.tasks), None)
                    if idle is None:
                        idle = _Worker(work, self._timeout_s)
                        crew.append(idle)
                    idle.give(chunk)
                self._crew = tuple(crew)
                if not crew or not any(worker.tasks for worker in crew):
                    return
                known: list[tuple[Task, Result | Lost]] = []
                failure: Exception | None = None
                for worker in self._heard(crew):
                    try:
                        known.extend(worker.answers())
                    except Exception as error:  # what others have done in the same moment is not lost by it
                        failure = error
                    if worker.ended:
                        stillborn = 0 if worker.has_begun else stillborn + 1
                        left.extend([tuple(worker.tasks)] if worker.tasks else [])
                if known:
                    yield known
                if failure is not None:
                    raise failure
                if stillborn >= _MOST_STILLBORN:
                    raise CampaignError(
                        f"{stillborn} worker processes in a row ended before they began with a flight; "
                        "what they printed says why"
                    )
        finally:
            for worker in crew:
                worker.kill()

    def _chunks_for(
        self,
        crew: Sequence[_Worker[Task, Any]],
        left: deque[Sequence[Task]],
        coming: Iterator[Sequence[Task]],
    ) -> Iterator[Sequence[Task]]:
        """As many chunks as there are workers without one, first those that others left."""
        for _ in range(self.workers - sum(bool(worker.tasks) for worker in crew)):
            chunk = left.popleft() if left else next(coming, None)
            if chunk is None:
                return
            yield chunk

    def _heard(self, crew: Sequence[_Worker[Task, Result]]) -> list[_Worker[Task, Result]]:
        """Wait until a worker tells something, or has been at a task for too long."""
        busy = {worker.connection: worker for worker in crew if worker.tasks}
        ready = connection.wait(list(busy), max(min(worker.rest_s() for worker in busy.values()), 0.0))
        return [worker for pipe, worker in busy.items() if pipe in ready or worker.rest_s() <= 0.0]


class _Worker(Generic[Task, Result]):
    """A process and the tasks that it has been given and not answered."""

    def __init__(self, work: Callable[[Task], Result], timeout_s: float) -> None:
        self.connection, theirs = _SPAWN.Pipe()
        self._process = _SPAWN.Process(target=_serve, args=(theirs, work), daemon=True)
        with _no_interrupt():
            self._process.start()
        theirs.close()
        self.tasks = deque[Task]()
        self.ended = self.has_begun = False
        self._is_at_task, self._since_s = False, time.monotonic()
        self._timeout_s = timeout_s

    def give(self, chunk: Sequence[Task]) -> None:
        """Send it a chunk; it has none."""
        self.tasks.extend(chunk)
        self._turn(is_at_task=False)
        with suppress(OSError):  # it has died, as the next look at it tells
            self.connection.send(tuple(chunk))

    def rest_s(self) -> float:
        """The time that it has left for what it is at."""
        allowed_s = self._timeout_s if self._is_at_task else max(self._timeout_s, _START_TIMEOUT_S)
        return self._since_s + allowed_s - time.monotonic()

    def answers(self) -> Iterator[tuple[Task, Result | Lost]]:
        """What it has told by now.

        Raises:
            Exception: what the work raised.
        """
        if not self.connection.poll():
            self.kill()
            yield from self._lost(Loss.TIMED_OUT, f"not done after {self._timeout_s:g} s")
            return
        try:
            word, value = self.connection.recv()
        except (EOFError, OSError):
            self._process.join()
            self.kill()
            yield from self._lost(Loss.PROCESS_CRASHED, _ending(self._process.exitcode))
            return
        if word == "begun":
            self.has_begun = True
            self._turn(is_at_task=True)
        elif word == "done":
            self._turn(is_at_task=False)
            yield self.tasks.popleft(), value
        else:
            raise value

    def _turn(self, *, is_at_task: bool) -> None:
        self._is_at_task, self._since_s = is_at_task, time.monotonic()

    def _lost(self, loss: Loss, reason: str) -> Iterator[tuple[Task, Lost]]:
        if self._is_at_task:
            yield self.tasks.popleft(), Lost(loss, reason, round(time.monotonic() - self._since_s, 3))

    def stop(self) -> None:
        """End its process; the thread that waits for it sees to the rest."""
        self._process.kill()

    def kill(self) -> None:
        """End it."""
        self.ended = True
        self._process.kill()
        self._process.join()
        self.connection.close()


def _serve(pipe: Any, work: Callable[[Task], Result]) -> None:
    """What a worker process does: chunk after chunk until nobody is there any more."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            chunk = pipe.recv()
        except (EOFError, OSError):
            return
        for task in chunk:
            pipe.send(("begun", None))
            try:
                result = work(task)
            except Exception as error:
                pipe.send(("raised", _picklable(error)))
                return
            pipe.send(("done", result))


def _end_with_parent() -> None:
    """Wait for the parent's end, however it comes, and end with it."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _picklable(error: Exception) -> Exception:
    """The error itself, its cause lost on the way; of unknown kinds what it says."""
    if isinstance(error, OSError):
        return error
    known = type(error).__module__.partition(".")[0] in ("sim", "recordings", "planner", "aircraft")
    return error if known else CampaignError("".join(traceback.format_exception(error)))


@contextmanager
def _no_interrupt() -> Iterator[None]:
    """Processes started here hear neither of Ctrl-C nor of SIGTERM; their parent ends them.

    A terminal sends the one to all, a batch system the other.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # the first process would begin it, and it lets signals through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _ending(code: int | None) -> str:
    """How a process ended, in words."""
    if code is None or code >= 0:
        return f"its process ended with code {code}"
    try:
        return f"its process was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"its process was killed by signal {-code}"
