"""A Dask cluster of real processes as an executor: each task answered once, whatever becomes of them."""

import sys
import time
from contextlib import closing
from itertools import chain
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from sim.campaign import dask_chunks, dask_cluster, premises
from sim.campaign.campaign import Campaign
from sim.campaign.columns import NOT_REPRODUCED
from sim.campaign.dask_cluster import connected
from sim.campaign.design import Design
from sim.campaign.executor import Loss, Lost
from sim.campaign.flight import Origin
from sim.campaign.folder import CampaignFolder
from sim.campaign.keeping import Keep
from sim.campaign.pool import LocalPool
from sim.campaign.variation import parse_variations
from sim.cli import main
from sim.errors import CampaignError
from tests.sim.campaign.dask_programs import started
from tests.sim.campaign.dask_tasks import begun, fragile, full, poisonous, square

each = chain.from_iterable

TIMEOUT_S = 900.0
HOP = Path(__file__).parents[1] / "scenarios" / "hop.toml"


@pytest.fixture(scope="session")
def cluster(tmp_path_factory):
    """A scheduler and two workers; a task is given up when a second one has ended."""
    with started(tmp_path_factory.mktemp("dask"), allowed_failures=1) as cluster:
        cluster.workers = [cluster.start_worker(), cluster.start_worker()]
        yield cluster


@pytest.fixture
def executor(cluster):
    with connected(cluster.address, TIMEOUT_S) as executor:
        yield executor


class Watch:
    """Does something at the landing of some flights."""

    def __init__(self, at=()):
        self.at, self.count = dict(at), 0

    def begin(self, total, landed):
        pass

    def landed(self, row):
        assert row["outcome"] == "arrived"
        self.count += 1
        self.at.pop(self.count, lambda: None)()


def campaign(folder, runs):
    design = Design.of(Origin.of(str(HOP)), parse_variations(["turbulence.severity=0,4"]), runs)
    return Campaign(design, CampaignFolder(folder), Keep.parse("all"))


def rows(folder):
    """What is the same whenever a campaign is flown, and the bytes of each recording."""
    table = pq.read_table(folder / "flights.parquet").drop_columns(NOT_REPRODUCED)
    return [row | {"bytes": (folder / row["recording"]).read_bytes()} for row in table.to_pylist()]


def test_each_task_is_answered_and_a_chunk_is_done_by_one_process_of_its_own(executor):
    assert executor.workers == 2
    chunks = [range(4), range(4, 6), *([number] for number in range(6, 100))]
    taken = []
    answers = []
    for answer in each(executor.results(square, (taken.append(chunk) or chunk for chunk in chunks))):
        answers.append(answer)
        answered = {task for task, _ in answers}
        open_chunks = [chunk for chunk in taken if not answered.issuperset(chunk)]
        assert len(open_chunks) <= dask_chunks.CHUNKS_PER_THREAD * executor.workers
    assert len(answers) == 100
    found = dict(answers)
    assert {task: square for task, (square, _, _) in found.items()} == {n: n * n for n in range(100)}
    for chunk in chunks[:2]:
        assert len({found[task][1:] for task in chunk}) == 1
    for worker in {worker for _, _, worker in found.values()}:  # its process is kept from chunk to chunk
        assert len({process for _, process, at in found.values() if at == worker}) == 1


def test_a_campaign_whose_worker_is_killed_is_the_same_as_on_this_machine(cluster, executor, tmp_path):
    watch = Watch({2: lambda: cluster.kill_worker(cluster.workers[0])})
    campaign(tmp_path / "dask", 4).fly(executor, watch, print)
    assert (watch.count, watch.at) == (8, {})
    campaign(tmp_path / "here", 4).fly(LocalPool(1, TIMEOUT_S), Watch(), print)
    found = rows(tmp_path / "dask")
    assert [row["run"] for row in found] == list(range(8))
    assert found == rows(tmp_path / "here")


def test_a_task_that_aborts_or_never_ends_takes_no_other_with_it(cluster):
    with connected(cluster.address, 1.0) as executor:
        answers = list(each(executor.results(fragile, [range(5)])))
    found = dict(answers)
    assert len(answers) == len(found) == 5
    assert (found[1].loss, found[1].reason) == (Loss.PROCESS_CRASHED, "its process was killed by SIGABRT")
    assert found[3].loss is Loss.TIMED_OUT
    assert [found[task] for task in (0, 2, 4)] == [0, 2, 4]


def test_closing_and_an_error_end_the_processes_and_what_is_queued_and_leave_the_cluster_usable(
    executor, tmp_path
):
    chunks = [[(tmp_path, number)] for number in range(30)]
    with closing(executor.results(begun, chunks)) as results:
        assert next(results) == [((tmp_path, 0), 0)]
        while len(list(tmp_path.iterdir())) < 3:
            time.sleep(0.01)
    with pytest.raises(OSError, match="No space left"):
        list(each(executor.results(full, [[number] for number in range(20)])))
    assert len(list(each(executor.results(square, [range(3), range(3, 5)])))) == 5
    noted = [path.name.split("_") for path in tmp_path.iterdir()]
    assert len(noted) == 3
    for _, process in noted:
        assert not Path(f"/proc/{process}").exists()


def test_a_cluster_with_another_version_is_refused_and_told(executor, monkeypatch):
    ours = premises._versions()
    monkeypatch.setattr(premises, "_versions", lambda: ours | {"numpy": "1.0"})
    with pytest.raises(CampaignError, match=r"the scheduler is not fit .*: numpy is \S+ there and 1\.0 here"):
        list(each(executor.results(square, [range(3)])))


def test_a_folder_that_a_worker_cannot_write_to_is_told(cluster, tmp_path):
    missing = tmp_path / "missing"
    with (
        connected(cluster.address, 60.0, writes=missing) as executor,
        pytest.raises(CampaignError, match=f"the worker tcp.* is not fit .* cannot write to {missing}"),
    ):
        list(each(executor.results(square, [range(3)])))


def test_a_scheduler_without_workers_and_one_that_is_lost_are_told(tmp_path, monkeypatch):
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 2.0)
    with started(tmp_path) as cluster:
        with (
            pytest.raises(
                CampaignError, match=f"has no workers; start some with `dask worker {cluster.address}`"
            ),
            connected(cluster.address, 60.0),
        ):
            pass
        cluster.start_worker("--nthreads", "1", "--no-nanny")
        with connected(cluster.address, 60.0) as executor:
            results = executor.results(square, ([number] for number in range(10**9)))
            next(results)
            cluster.scheduler.kill()
            with pytest.raises(CampaignError, match=f"{cluster.address} is lost; start it .* goes on"):
                list(results)


@pytest.fixture
def called(monkeypatch, capsys):
    """Runs `galeway campaign` in this process: (*arguments) -> exit code, stdout, stderr."""

    def call(*arguments):
        monkeypatch.setattr("sys.argv", ["galeway", "campaign", str(HOP), *arguments])
        with pytest.raises(SystemExit) as stopped:
            sys.exit(main())
        told = capsys.readouterr()
        return stopped.value.code or 0, told.out, told.err

    return call


def test_the_command_flies_on_a_cluster(cluster, called, tmp_path):
    code, told, _ = called("--runs", "1", "--scheduler", cluster.address, "--out", str(tmp_path / "out"))
    assert code == 0
    assert "1 flight" in told


def test_the_command_tells_what_is_missing(called, tmp_path, monkeypatch):
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 0.2)
    options = ("--runs", "2", "--scheduler", "tcp://127.0.0.1:9", "--out", str(tmp_path / "out"))
    code, _, told = called(*options)
    assert code == 2
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in told
    assert "start one with `dask scheduler`" in told
    code, _, told = called(*options, "--workers", "2")
    assert (code, "leave one out" in told) == (2, True)
    monkeypatch.setitem(sys.modules, "distributed", None)
    code, _, told = called(*options)
    assert (code, "pip install 'galeway[dask]'" in told) == (2, True)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_task_that_ends_its_workers_again_and_again_is_told_and_the_others_are_done(executor):
    answers = list(each(executor.results(poisonous, [range(3), [3]])))
    found = dict(answers)
    assert len(answers) == len(found) == 4
    assert isinstance(found[1], Lost)
    assert found[1].loss is Loss.PROCESS_CRASHED
    assert "2 workers of the cluster ended while they were at it" in found[1].reason
    assert [found[task] for task in (0, 2, 3)] == [0, 2, 3]


@pytest.mark.slow
def test_two_hundred_flights_while_workers_go_and_come(tmp_path):
    with started(tmp_path / "cluster") as cluster:
        first, _ = (
            cluster.start_worker("--nthreads", "1", "--no-nanny"),
            cluster.start_worker("--nthreads", "2"),
        )
        watch = Watch({60: first.kill, 120: lambda: cluster.start_worker()})
        with connected(cluster.address, TIMEOUT_S) as executor:
            assert executor.workers == 3
            campaign(tmp_path / "dask", 100).fly(executor, watch, print)
        assert (watch.count, watch.at) == (200, {})
    campaign(tmp_path / "here", 100).fly(LocalPool(2, TIMEOUT_S), Watch(), print)
    assert rows(tmp_path / "dask") == rows(tmp_path / "here")
