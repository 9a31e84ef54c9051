import os

import pytest

from sim.errors import SimError
from sim.reproduce.kept import Kept
from sim.reproduce.pool import executor_of


def unheard(done, of):
    pass


def squared(number):
    if number < 0:
        raise ValueError("negative")
    return number * number


def test_what_is_done_is_not_done_again(tmp_path):
    asked, told = [], []

    def work(number):
        asked.append(number)
        return squared(number)

    kept = Kept(tmp_path, executor_of(1))
    assert kept.all(work, [[1, 2], [3]], unheard) == [1, 4, 9]
    assert kept.all(work, [[3, 4], [2]], lambda *done: told.append(done)) == [9, 16, 4]
    assert asked == [1, 2, 3, 4]
    assert told == [(2, 3), (3, 3)]


def test_another_task_or_another_work_is_another_result(tmp_path):
    kept = Kept(tmp_path, executor_of(1))
    assert kept.all(squared, [[3]], unheard) == [9]
    assert kept.all(abs, [[3]], unheard) == [3]
    assert kept.all(squared, [[3.0]], unheard) == [9.0]
    assert len(list(tmp_path.iterdir())) == 3


def test_what_was_done_before_an_error_stays(tmp_path):
    kept = Kept(tmp_path, executor_of(1))
    with pytest.raises(ValueError, match="negative"):
        kept.all(squared, [[2, -1, 3]], unheard)
    assert len(list(tmp_path.iterdir())) == 1


def test_processes_give_what_one_does_and_one_that_is_lost_is_told(tmp_path):
    kept = Kept(tmp_path, executor_of(2))
    assert kept.all(abs, [[-1, 2], [-3]], unheard) == [1, 2, 3]
    with pytest.raises(SimError, match="goes on from here"):
        kept.all(os._exit, [[1]], unheard)
    assert len(list(tmp_path.iterdir())) == 3
