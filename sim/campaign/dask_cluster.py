"""The executor over a Dask cluster: chunks go to its workers, a bounded number of them at a time."""

from __future__ import annotations

import asyncio
import logging
import pickle
import uuid
from collections import deque
from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.campaign.dask_chunks import Sent
from sim.campaign.errand import Errand
from sim.campaign.executor import Lost, Result, Task
from sim.campaign.premises import Premises
from sim.errors import CampaignError

if TYPE_CHECKING:  # distributed is an extra, and takes seconds to import
    from distributed import Client

CONNECT_S = 10.0
SAME = (
    "install the same galeway and packages on all machines, and have its files on a disk that all of them "
    "see by the same path"
)


@contextmanager
def connected(
    address: str, timeout_s: float, *, reads: Collection[Path] = (), writes: Path | None = None
) -> Iterator[DaskCluster]:
    """An executor for a cluster that has workers.

    Args:
        address: the scheduler's, such as "tcp://10.0.0.1:8786".
        timeout_s: that a task may take.
        reads: files that each worker must see as they are here when the first task is done.
        writes: a folder that each must see and be able to write to.

    Raises:
        CampaignError: if there is no such cluster, or Dask is not installed.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise CampaignError("--scheduler needs Dask: pip install 'galeway[dask]'") from error
    with _silent():
        try:
            asyncio.run(_answered(address))  # a client that finds nobody leaves more than an error behind
            client = Client(address, timeout=CONNECT_S, set_as_default=False, name="galeway")
        except (OSError, ValueError) as error:
            raise CampaignError(
                f"no Dask scheduler answers at {address} ({_first_line(error)}); start one with "
                "`dask scheduler`, which prints its address, such as tcp://10.0.0.1:8786"
            ) from error
        try:
            yield DaskCluster(client, address, timeout_s, reads, writes)
        finally:
            with suppress(Exception):  # the scheduler may be gone
                client.close(timeout=CONNECT_S)


class DaskCluster:
    """An `Executor` of the threads of all workers, those that come and go meanwhile among them."""

    is_local = False

    def __init__(
        self, client: Client, address: str, timeout_s: float, reads: Collection[Path], writes: Path | None
    ) -> None:
        self._client, self._address, self._timeout_s = client, address, timeout_s
        self._reads, self._writes = reads, writes
        with suppress(TimeoutError):
            client.wait_for_workers(1, timeout=CONNECT_S)
        self.workers = sum(client.nthreads().values())
        if not self.workers:
            raise CampaignError(
                f"the Dask scheduler at {address} has no workers; start some with `dask worker {address}`"
            )

    def results(
        self, work: Callable[[Task], Result], chunks: Iterable[Sequence[Task]]
    ) -> Generator[Sequence[tuple[Task, Result | Lost]]]:
        """See `Executor.results`.

        Workers that end or come later make no difference but in time. Tasks whose workers ended again and
        again are done once more, each alone on the whole cluster: if its workers end then, too, that is the
        task's doing.

        Raises:
            CampaignError: if a machine is not like this one, or the scheduler is lost, or all workers.
        """
        premises = Premises.here(self._reads, self._writes)
        require_same(self._client, premises)
        errand = Errand(uuid.uuid4().hex, pickle.dumps(work), self._timeout_s, premises)
        sent: Sent[Task, Result] = Sent(self._client, self._address, errand)
        coming, suspects = iter(chunks), deque[Task]()
        try:
            while True:
                while not suspects and sent.has_room():
                    chunk = next(coming, None)
                    if chunk is None:
                        break
                    sent.send(chunk)
                is_alone = bool(suspects) and not len(sent)
                if is_alone:
                    sent.send((suspects.popleft(),))
                if not len(sent):
                    return
                known: list[tuple[Task, Result | Lost]] = []
                failure: Exception | None = None
                try:
                    for chunk, answers in sent.done():
                        if not isinstance(answers, Lost):
                            known.extend(zip(chunk, answers, strict=True))
                        elif is_alone:
                            known.append((chunk[0], answers))
                        else:
                            suspects.extend(chunk)
                except Exception as error:  # the chunks before it are not lost by it
                    failure = error
                if known:
                    yield known
                if failure is not None:
                    raise failure
        finally:
            sent.call_off()


async def _answered(address: str) -> None:
    """Pass if somebody speaks Dask's language there."""
    from distributed.comm.core import connect

    comm = await connect(address, timeout=CONNECT_S)
    await comm.close()


def require_same(client: Client, premises: Premises) -> None:
    """Pass if the scheduler and all workers are like this machine.

    Raises:
        CampaignError: naming one that is not, and in what.
    """
    found: dict[str, Any] = {}
    try:
        found["the scheduler"] = client.run_on_scheduler(premises.of_versions.complaints)
    except Exception as error:  # it cannot so much as read the question
        found["the scheduler"] = error
    found |= client.run(premises.complaints, on_error="return")
    for machine, told in found.items():
        if isinstance(told, OSError):  # it is lost, which is found out by whoever waits for it
            continue
        if isinstance(told, Exception):
            raise CampaignError(
                f"{_named(machine)} has another galeway, or none ({_first_line(told)}); {SAME}"
            )
        if told:
            raise CampaignError(f"{_named(machine)} is not fit for the campaign: {'; '.join(told)}; {SAME}")


def _named(machine: str) -> str:
    return machine if machine.startswith("the ") else f"the worker {machine}"


def _first_line(error: BaseException) -> str:
    return str(error).strip().partition("\n")[0] or type(error).__name__


@contextmanager
def _silent() -> Iterator[None]:
    """Without what Dask logs of lost connections; we say it ourselves, once and with the remedy."""
    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.client")]
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)
