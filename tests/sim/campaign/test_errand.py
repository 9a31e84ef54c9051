"""An errand where it is done: by a worker that is fit for it, and as long as it is not called off."""

import os
import pickle
import tempfile
from pathlib import Path

import pytest

from sim.campaign.errand import Errand
from sim.campaign.premises import Premises
from sim.errors import CampaignError


class Unreadable:
    """Cannot be unpacked."""

    def __reduce__(self):
        return pytest.fail, ("it was unpacked where it is not done",)


def leaving(path):
    """Ends its process, and leaves a folder, whose name it has written down."""
    path.write_text(tempfile.mkdtemp())
    if path.name == "lost":
        os.abort()


def errand(name, premises):
    return Errand(name, pickle.dumps(Unreadable()), 60.0, premises)


def test_a_worker_that_is_not_fit_does_nothing():
    unfit = Premises((("galeway", "0.0"),))
    with pytest.raises(
        CampaignError, match=r"a worker on .* is not fit .* galeway is \S+ there and 0\.0 here"
    ):
        errand("unfit", unfit)([1, 2, 3])


def test_an_errand_that_is_called_off_is_not_begun():
    called_off = errand("called off", Premises.here())
    called_off.call_off()
    with pytest.raises(CampaignError, match="called off"):
        called_off([1, 2, 3])


def test_work_that_cannot_be_unpacked_is_told_and_travels_unread():
    sent = pickle.loads(pickle.dumps(errand("unreadable", Premises.here())))
    with pytest.raises(CampaignError, match="3 worker processes in a row ended before they began"):
        sent([1, 2, 3])


def test_what_a_lost_task_leaves_behind_is_taken_away(tmp_path):
    paths = [tmp_path / name for name in ("lost", "done")]
    leaves = Errand("leaves", pickle.dumps(leaving), 60.0, Premises.here())
    lost, done = leaves(paths)
    assert (lost.reason, done) == ("its process was killed by SIGABRT", None)
    left = [Path(path.read_text()) for path in paths]
    assert [path.exists() for path in left] == [False, True]
    leaves.call_off()
    assert not left[1].parent.exists()
