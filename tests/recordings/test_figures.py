"""Figures of values that are known."""

import numpy as np
import pytest

from recordings.figures import Extent, Largest, Places, Spread, Statistics, clock_tenths, number


@pytest.fixture
def places():
    phase = np.ones(101, np.int64)
    return Places(np.arange(101.0), np.linspace(-50.0, 50.0, 101), np.linspace(100.0, 0.0, 101), phase)


def test_a_spread_is_of_absolute_errors(places):
    statistics = Statistics()
    errors = np.where(np.arange(101) % 2 == 0, 1.0, -1.0) * np.arange(101.0)
    assert statistics.spread("height_m", errors, places) == Spread(50.0, 95.0, 100.0)
    assert {str(moment) for moment in statistics.worst.values()} == {"100 m at 00:01:40, 50.00 N 0.00 E"}


def test_a_spread_leaves_out_what_was_not_measured(places):
    statistics = Statistics()
    errors = np.full(101, np.nan)
    assert statistics.spread("height_m", errors, places) == Spread(None, None, None)
    errors[[3, 4]] = -2.0, 1.0
    assert statistics.spread("height_m", errors, places) == Spread(1.5, 1.95, 2.0)
    assert statistics.worst["height_m.mean"].time_s == 3.0


def test_an_extent_keeps_the_moments_of_both_ends(places):
    statistics = Statistics()
    assert statistics.extent("air_mps", np.arange(101.0)[::-1] - 50.0, places) == Extent(-50.0, 0.0, 50.0)
    assert str(statistics.worst["air_mps.min"]) == "-50 m/s at 00:01:40, 50.00 N 0.00 E"
    assert str(statistics.worst["air_mps.max"]) == "50 m/s at 00:00:00, 50.00 S 100.00 E"


def test_a_moment_without_a_unit_has_one_space(places):
    assert str(places.moment(0, 0.0, "")) == "0 at 00:00:00, 50.00 S 100.00 E"


@pytest.mark.parametrize(
    ("time_s", "text"),
    [(1080.22, "00:18:00.2"), (3599.96, "01:00:00.0"), (-30.25, "-00:00:30.3"), (-0.04, "00:00:00.0")],
)
def test_a_clock_with_tenths(time_s, text):
    assert clock_tenths(time_s) == text


@pytest.mark.parametrize(
    ("value", "text"), [(-0.0, "0"), (0.0, "0"), (-0.25, "-0.25"), (0.45341, "0.4534"), (1080.04, "1080")]
)
def test_a_number_has_the_digits_that_say_something(value, text):
    assert number(value) == text


def test_nothing_is_none(places):
    statistics = Statistics()
    assert statistics.extent("air_mps", np.array([]), places) == Extent(None, None, None)
    assert statistics.largest("cut_m", np.array([]), places) == Largest(None)
    assert statistics.worst == {}
