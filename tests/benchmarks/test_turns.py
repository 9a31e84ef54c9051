"""Sides that take turns, and what is made of their rounds."""

import importlib
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture
def load(monkeypatch):
    """A module of the benchmarks, which find each other in their folder."""
    monkeypatch.syspath_prepend(FOLDER)
    return importlib.import_module


def test_sides_take_turns_backwards_in_every_other_round(load):
    turns, called = load("turns"), []

    def side(name):
        return lambda number: called.append((number, name)) or f"{name}{number}"

    found = list(turns.in_turns([side("a"), side("b")], 3))
    assert called == [(0, "a"), (0, "b"), (1, "b"), (1, "a"), (2, "a"), (2, "b")]
    assert found == [("a0", "b0"), ("a1", "b1"), ("a2", "b2")]


def test_a_spread_is_the_median_with_the_least_and_the_greatest(load):
    spread = load("turns").Spread.of([1.9, 1.7, 1.8, 5.0])
    assert spread == pytest.approx((1.85, 1.7, 5.0))
    assert spread.told(load("tables").times) == "1.85 x (1.70 to 5.00)"


def test_a_machine_that_changes_its_speed_between_rounds_changes_no_ratio(load):
    sides = load("campaign_sides")
    rates = [[1.0, 1.9], [0.5, 0.95], [2.0, 3.8]]
    assert sides.row("all up", rates)[-1] == "1.90 x (1.90 to 1.90)"


def test_the_rate_of_workers_that_are_up_leaves_out_their_start_and_counts_each_one_s_flights(load):
    flown = load("campaign_sides").Flown
    one = flown(1, begin_s=0.0, landed_s=[13.0, 16.0, 19.0], end_s=20.0)
    assert one.steady_rate_hz == pytest.approx(1 / 3)
    assert one.whole_rate_hz == pytest.approx(3 / 20)
    two = flown(2, begin_s=0.0, landed_s=[13.0, 14.0, 16.0, 17.0, 19.0, 20.0], end_s=20.0)
    assert two.steady_rate_hz == pytest.approx(2 / 3)


def test_each_flight_of_a_pair_is_flown_alone_next_to_the_campaign_s_and_every_other_one_before_it(load):
    module, order = load("campaign_speed"), []

    class Design:
        count = 6

    pairs = module.Pairs(Design(), Path())
    pairs._alone = lambda run: order.append(f"alone {run}") or pairs.alone_s.update({run: 1.0})
    pairs.begin(6, 0)
    for run in range(6):
        order.append(f"campaign {run}")
        pairs.landed({"run": run, "passed": True})
    assert order[2:] == [
        *("campaign 1", "alone 1", "alone 2", "campaign 2"),
        *("campaign 3", "alone 3", "alone 4", "campaign 4"),
        *("campaign 5", "alone 5"),
    ]
    assert len(list(pairs.counted())) == 5
