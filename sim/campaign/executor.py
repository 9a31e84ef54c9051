"""What flies a campaign's flights: any number of processes, here or on other machines."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")


class Loss(StrEnum):
    """How a task was lost with the process that did it."""

    PROCESS_CRASHED = "process_crashed"
    TIMED_OUT = "timed_out"


@dataclass(frozen=True, slots=True)
class Lost:
    """What there is instead of a task's result where its process ended, or was ended, in the midst of it.

    `reason`: for people, such as the signal. `wall_time_s`: since the task was begun, as far as is known.
    """

    loss: Loss
    reason: str
    wall_time_s: float | None = None


class Executor(Protocol):
    """Does tasks in processes of its own.

    A task is a small value that can be pickled, such as a `Flight`; `work` too, such as `Flying`, and its
    results. What an executor promises:

    - Each task is answered once, by its result or by why it was lost, in any order, as soon as it is known;
      what is known at the same time comes together, so that it can be kept together.
    - A task that ends its process does not take others of its chunk with it: those are done again or by
      another process. `work` gives the same result when it is called twice, and may be.
    - A chunk is done by one process, which keeps what its tasks share (their weather) from one to the next.
    - An exception that `work` raises is raised here, and ends it all.
    - Closing the generator ends every process that it began, or at least what they are at.
    """

    workers: int
    """How many tasks are done at once, as far as is known."""

    is_local: bool
    """Whether its processes are on this machine, and see its disk."""

    def results(
        self, work: Callable[[Task], Result], chunks: Iterable[Sequence[Task]]
    ) -> Generator[Sequence[tuple[Task, Result | Lost]]]:
        """Do all tasks, and give the answers that there are by now, one at least, until there are all.

        Chunks are taken when there is somebody to do them.
        """
