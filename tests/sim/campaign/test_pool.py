"""Tasks in worker processes: each answered once, whatever ends a process."""

import os
import signal
import time
from contextlib import closing
from itertools import chain
from pathlib import Path

import pytest

from sim.campaign.executor import Loss, Lost
from sim.campaign.pool import LocalPool
from sim.errors import CampaignError

each = chain.from_iterable


def square(number):
    return number * number, os.getpid()


def fragile(number):
    if number == 3:
        os.abort()
    if number == 6:
        os._exit(7)
    if number == 8:
        os.kill(os.getpid(), signal.SIGSEGV)
    return number


def slow(number):
    if number == 2:
        time.sleep(600.0)
    return number


def full(number):
    if number == 2:
        raise OSError(28, "No space left on device")
    return number


def told_by_a_file(task):
    folder, name = task
    while name == "other" and not (folder / "first").exists():
        time.sleep(0.01)
    (folder / name).touch()
    if name == "failing":
        raise OSError(28, "No space left on device")
    if name == "other":
        time.sleep(0.2)
    return name


def noted(task):
    folder, number = task
    (folder / f"{number}_{os.getpid()}").touch()
    if number:
        time.sleep(600.0)
    return number


class Unready:
    """Ends the process that takes it, before any task."""

    def __call__(self, task):
        return task

    def __reduce__(self):
        return os._exit, (9,)


def test_each_task_is_answered_and_a_chunk_is_done_by_one_process():
    chunks = [range(4), range(4, 6), range(6, 9), range(9, 10)]
    answers = dict(each(LocalPool(2, 60.0).results(square, chunks)))
    assert {task: square for task, (square, _) in answers.items()} == {n: n * n for n in range(10)}
    for chunk in chunks:
        assert len({answers[task][1] for task in chunk}) == 1
    assert os.getpid() not in {process for _, process in answers.values()}


def test_what_is_done_while_nobody_listens_comes_together():
    with closing(LocalPool(2, 60.0).results(square, [range(5), range(5, 10)])) as results:
        answers = [next(results)]
        time.sleep(1.0)  # both workers go on with their chunks
        answers += results
    assert sorted(task for task, _ in each(answers)) == list(range(10))
    assert all(answers)
    assert [len(together) for together in answers].count(2) >= 3


def test_what_is_done_when_another_task_fails_is_told_before_that(tmp_path):
    first, failing, other = ((tmp_path, name) for name in ("first", "failing", "other"))
    with closing(LocalPool(2, 60.0).results(told_by_a_file, [[first, failing], [other]])) as results:
        assert [task for task, _ in next(results)] == [first]
        while len(list(tmp_path.iterdir())) < 3:
            time.sleep(0.01)
        time.sleep(1.0)  # both have sent what became of them
        assert [task for task, _ in next(results)] == [other]
        with pytest.raises(OSError, match="No space left"):
            next(results)


def test_a_task_that_ends_its_process_is_told_and_takes_no_other_with_it():
    answers = list(each(LocalPool(2, 60.0).results(fragile, [range(5), range(5, 10)])))
    found = dict(answers)
    assert sorted(found) == list(range(10))
    assert len(answers) == 10
    lost = {task: answer for task, answer in found.items() if isinstance(answer, Lost)}
    assert {task: (answer.loss, answer.reason) for task, answer in lost.items()} == {
        3: (Loss.PROCESS_CRASHED, "its process was killed by SIGABRT"),
        6: (Loss.PROCESS_CRASHED, "its process ended with code 7"),
        8: (Loss.PROCESS_CRASHED, "its process was killed by SIGSEGV"),
    }
    assert all(found[task] == task for task in found if task not in lost)


def test_a_task_that_takes_too_long_is_ended_and_the_others_done():
    found = dict(each(LocalPool(1, 1.0).results(slow, [range(5)])))
    assert found[2].loss is Loss.TIMED_OUT
    assert found[2].reason == "not done after 1 s"
    assert found[2].wall_time_s >= 1.0
    assert [found[task] for task in (0, 1, 3, 4)] == [0, 1, 3, 4]


def test_an_error_of_the_machine_ends_it_all():
    with pytest.raises(OSError, match="No space left"):
        list(each(LocalPool(1, 60.0).results(full, [range(5)])))


def test_workers_that_never_begin_end_it_with_a_message():
    with pytest.raises(CampaignError, match="3 worker processes in a row"):
        list(each(LocalPool(1, 60.0).results(Unready(), [range(5)])))


def test_closing_ends_the_processes(tmp_path):
    with closing(LocalPool(2, 60.0).results(noted, [[(tmp_path, 0)], [(tmp_path, 1)]])) as answers:
        next(answers)
        while len(list(tmp_path.iterdir())) < 2:
            time.sleep(0.01)
    for path in tmp_path.iterdir():
        assert not Path(f"/proc/{path.name.split('_')[1]}").exists()
