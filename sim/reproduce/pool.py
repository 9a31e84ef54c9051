"""What does the tasks: this process, or several of the kind that fly campaigns."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Sequence

from sim.campaign.executor import Executor, Lost, Result, Task
from sim.campaign.pool import LocalPool

TIMEOUT_S = 4 * 3600.0
"""After which the process of a task is ended; the longest takes a minute, or an hour on a crowded machine."""


class InTurn:
    """An `Executor` that does task after task in this process."""

    workers = 1
    is_local = True

    def results(
        self, work: Callable[[Task], Result], chunks: Iterable[Sequence[Task]]
    ) -> Generator[Sequence[tuple[Task, Result | Lost]]]:
        """See `Executor.results`."""
        for chunk in chunks:
            for task in chunk:
                yield [(task, work(task))]


def executor_of(workers: int) -> Executor:
    """Does tasks in so many processes; with one worker, in this one."""
    if workers == 1:
        return InTurn()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of the children: threads of many would wait
    return LocalPool(workers, TIMEOUT_S)
