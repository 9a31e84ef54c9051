"""Results kept in files by what they were made from: a stopped run goes on, a page is made again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable
from itertools import chain
from pathlib import Path
from typing import Any

from sim.campaign.executor import Executor, Lost, Task
from sim.errors import SimError
from sim.job import write_whole


class Kept:
    """JSON files in a folder, one a task; a task's text, with all that decides its result, is its name."""

    def __init__(self, folder: Path, executor: Executor) -> None:
        """Keep in a folder what an executor does."""
        self._folder, self._executor = folder, executor
        folder.mkdir(parents=True, exist_ok=True)

    def all(
        self,
        work: Callable[[Task], Any],
        chunks: Iterable[Iterable[Task]],
        tell: Callable[[int, int], object],
    ) -> list[Any]:
        """The results of all tasks in their order; only those that are not kept are worked at.

        Args:
            work: task to what JSON knows; a function of a module, so that others can run it.
            chunks: of tasks that share something.
            tell: told how many are done, and of how many.

        Raises:
            SimError: if a task is lost with its process; what the work raises.
        """
        asked = [list(chunk) for chunk in chunks]
        tasks = [task for chunk in asked for task in chunk]
        paths = {task: self._path(work, task) for task in tasks}
        missing = [[task for task in chunk if not paths[task].exists()] for chunk in asked]
        done = len(tasks) - sum(map(len, missing))
        tell(done, len(tasks))
        results = self._executor.results(work, filter(None, missing))
        for task, result in chain.from_iterable(results):
            if isinstance(result, Lost):
                raise SimError(
                    f"a task was lost with its process, {result.reason}: {task!r}; what was done is kept, so "
                    "that the same command goes on from here"
                )
            write_whole(paths[task], json.dumps({"task": repr(task), "result": result}).encode())
            done += 1
            tell(done, len(tasks))
        return [json.loads(paths[task].read_bytes())["result"] for task in tasks]

    def _path(self, work: Callable[[Task], Any], task: Task) -> Path:
        name = hashlib.sha256(f"{work.__module__}.{work.__qualname__} {task!r}".encode()).hexdigest()
        return self._folder / f"{name[:20]}.json"
