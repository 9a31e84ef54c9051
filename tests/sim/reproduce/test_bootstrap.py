import math

import numpy as np

from sim.reproduce.bootstrap import mean_interval, ratio_interval


def test_the_interval_of_a_mean_is_that_of_the_normal_distribution():
    days = np.random.default_rng(2).normal(3.0, 2.0, 400)
    found = mean_interval(days)
    half = 1.96 * days.std() / math.sqrt(days.size)
    assert found.value == days.mean()
    np.testing.assert_allclose([found.low, found.high], [days.mean() - half, days.mean() + half], atol=0.03)


def test_it_covers_the_truth_about_as_often_as_it_says():
    random = np.random.default_rng(3)
    intervals = [mean_interval(random.normal(0.0, 1.0, 40)) for _ in range(25)]
    hit = sum(found.low <= 0.0 <= found.high for found in intervals)
    assert 20 <= hit <= 25


def test_days_that_differ_by_the_same_amount_leave_no_doubt():
    found = mean_interval([0.2] * 30)
    assert found.low == found.value == found.high


def test_pairing_cancels_what_days_share():
    random = np.random.default_rng(4)
    below = random.uniform(10.0, 1000.0, 50)
    found = ratio_interval(2.0 * below, below)
    np.testing.assert_allclose(found, 2.0)


def test_one_day_has_no_interval_and_nothing_no_ratio():
    assert math.isnan(mean_interval([0.5]).low)
    assert ratio_interval([0.0, 0.0], [0.0, 0.0]) is None
    some = ratio_interval([1.0, 0.0, 2.0], [2.0, 0.0, 4.0])
    assert some.value == some.low == some.high == 0.5
