"""Which recordings stay."""

import random

import pytest

from sim.campaign.keeping import Keep, WorstKept
from sim.errors import CampaignError


def row(run, *, arrived=True, broken=0, off_m=1.0, passed=None, **more):
    limits = [{"limit": str(n), "passed": n >= broken} for n in range(4)]
    landed = {"run": run, "arrived": arrived, "limits": limits, "cross_track_m.p95": off_m}
    passed = arrived and not broken if passed is None else passed
    return {**landed, "passed": passed, "recording_bytes": 9, **more}


@pytest.mark.parametrize("text", ["all", "failed", "none", "worst:3", "worst:12:altitude_error_m.max"])
def test_what_is_kept_is_written_as_it_is_read(text):
    assert str(Keep.parse(text)) == text


@pytest.mark.parametrize("text", ["", "som", "worst", "worst:0", "worst:-1", "worst:x", "worst:3:outcome"])
def test_anything_else_is_refused(text):
    with pytest.raises(CampaignError, match="--keep"):
        Keep.parse(text)
    with pytest.raises(CampaignError, match=r"cross_track_m\.p95"):
        Keep.parse("worst:3:cross_track_m")


def test_what_a_worker_leaves():
    good, bad = row(1), row(2, broken=1)
    assert [Keep.parse("all").may_keep(one) for one in (good, bad)] == [True, True]
    assert [Keep.parse("failed").may_keep(one) for one in (good, bad)] == [False, True]
    assert [Keep.parse("none").may_keep(one) for one in (good, bad)] == [False, False]
    assert [Keep.parse("worst:1").may_keep(one) for one in (good, bad)] == [True, True]


def test_the_worst_are_those_that_broke_most_then_those_farthest_off(tmp_path):
    landed = [
        row(0, off_m=5.0),
        row(1, arrived=False, off_m=0.1),
        row(2, broken=1, off_m=0.2),
        row(3, broken=2, off_m=0.1),
        row(4, off_m=9.0),
        row(5, off_m=9.0),
        row(6, arrived=None, recording_bytes=None),
    ]
    keep = Keep.parse("worst:4")
    order = sorted(landed, key=keep.badness, reverse=True)
    assert [one["run"] for one in order] == [6, 1, 3, 2, 4, 5, 0]
    for seed in range(20):
        for one in landed[:6]:
            keep.path(tmp_path, one["run"]).touch()
        worst = WorstKept(keep, tmp_path)
        for one in random.Random(seed).sample(landed, len(landed)):
            worst.add(one)
        assert sorted(path.name for path in tmp_path.iterdir()) == [
            f"run_00000{run}.mcap" for run in (1, 2, 3, 4)
        ]


def test_the_worst_by_another_figure():
    keep = Keep.parse("worst:1:flight_time_s")
    assert keep.badness(row(1, flight_time_s=9.0)) > keep.badness(row(2, off_m=7.0, flight_time_s=8.0))
