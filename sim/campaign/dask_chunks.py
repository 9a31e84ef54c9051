"""The chunks that a Dask cluster is at."""

from __future__ import annotations

import math
import queue
import time
import uuid
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Generic

from sim.campaign.errand import Errand
from sim.campaign.executor import Loss, Lost, Result, Task
from sim.errors import CampaignError

if TYPE_CHECKING:
    from distributed import Client, Future

CHUNKS_PER_THREAD = 2
"""Sent at once: one to be at and one to go on with, however many a campaign has."""

LOOK_EVERY_S = 10.0
PATIENCE_S = 300.0
"""Without a single worker."""

GO_ON = "what has landed is kept, and the same command goes on"


class Sent(Generic[Task, Result]):
    """The chunks that the cluster has and that are not answered."""

    def __init__(self, client: Client, address: str, errand: Errand) -> None:
        self._client, self._address, self._errand = client, address, errand
        self._chunks: dict[str, tuple[Future[Any], Sequence[Task]]] = {}
        self._done = queue.SimpleQueue[str]()
        self._threads, self._looked_s = 0, -math.inf
        self._peopled_s = time.monotonic()

    def __len__(self) -> int:
        return len(self._chunks)

    def has_room(self) -> bool:
        """Whether the workers there are can do with another chunk."""
        self._look()
        return len(self) < CHUNKS_PER_THREAD * max(self._threads, 1)

    def send(self, chunk: Sequence[Task]) -> None:
        """Give the cluster a chunk."""
        key = f"flights-{uuid.uuid4().hex}"
        future = self._client.submit(self._errand, chunk, key=key, pure=False)
        self._chunks[key] = (future, chunk)
        future.add_done_callback(lambda done: self._done.put(str(done.key)))

    def done(self) -> Iterator[tuple[Sequence[Task], list[Result | Lost] | Lost]]:
        """Chunks that are answered by now, at least one, with their answers, or why there are none.

        Raises:
            Exception: what the work raised.
            CampaignError: if there is nobody left to wait for.
        """
        keys = [self._wait()]
        with suppress(queue.Empty):
            while True:
                keys.append(self._done.get_nowait())
        for key in keys:
            future, chunk = self._chunks.pop(key)
            yield chunk, self._answers(future)

    def call_off(self) -> None:
        """Leave the cluster with nothing of it, queued or begun."""
        if self._client.status == "running":
            with suppress(Exception):  # the scheduler may be lost just now, and there is nothing to lose
                self._client.cancel([future for future, _ in self._chunks.values()])
                self._client.run(self._errand.call_off, on_error="ignore")

    def _wait(self) -> str:
        while True:
            with suppress(queue.Empty):
                return self._done.get(timeout=LOOK_EVERY_S)
            self._look()

    def _look(self) -> None:
        """Count the workers' threads now and then.

        Raises:
            CampaignError: if the scheduler is lost, or there has been no worker for long.
        """
        now_s = time.monotonic()
        if now_s - self._looked_s < LOOK_EVERY_S:
            return
        try:
            self._threads = sum(self._client.nthreads().values())
        except Exception as error:  # of many kinds
            raise self._lost() from error
        self._looked_s = now_s
        if self._threads:
            self._peopled_s = now_s
        elif now_s - self._peopled_s > PATIENCE_S:
            raise CampaignError(
                f"the Dask scheduler at {self._address} has had no workers for {PATIENCE_S:.0f} s; start "
                f"some with `dask worker {self._address}`: {GO_ON}"
            )

    def _answers(self, future: Future[Any]) -> list[Result | Lost] | Lost:
        from distributed import KilledWorker

        try:
            answers: list[Result | Lost] = future.result()
        except KilledWorker as error:
            times = error.allowed_failures + 1
            return Lost(
                Loss.PROCESS_CRASHED,
                f"{times} workers of the cluster ended while they were at it, the last of them "
                f"{error.last_worker.address}",
            )
        except Exception as error:
            if future.status != "error":
                raise self._lost() from error
            if isinstance(error, ImportError | AttributeError):  # a worker that came later
                raise CampaignError(f"a worker has another galeway, or none ({error})") from error
            raise
        return answers

    def _lost(self) -> CampaignError:
        return CampaignError(
            f"the Dask scheduler at {self._address} is lost; start it and its workers again: {GO_ON}"
        )
