"""Smooth noise: its moments over many seeds, and that it can be asked in any order."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.weather.smooth_noise import NoiseAxis, SmoothNoise


def noise(seed, *axes):
    return SmoothNoise(axes, np.random.default_rng(seed))


@given(st.floats(0.0, 10.0), st.floats(0.2, 30.0))
def test_the_variance_is_one_everywhere(value, length):
    weights = NoiseAxis(0.0, 10.0, length).weights([value])
    assert (weights**2).sum() == pytest.approx(1.0)


@pytest.mark.parametrize("distance", [0.0, 0.5, 1.0, 2.0])
def test_the_correlation_is_a_gaussian_of_the_distance(distance):
    axis = NoiseAxis(0.0, 50.0, 4.0)
    for begin in np.linspace(0.0, 30.0, 17):
        here, there = axis.weights([begin, begin + 4.0 * distance])
        assert here @ there == pytest.approx(np.exp(-(distance**2) / 2.0), abs=3e-3)


def test_many_draws_have_mean_nought_and_variance_one():
    drawn = np.array([noise(seed, NoiseAxis(0.0, 1.0, 0.5)).on([0.3])[0] for seed in range(2000)])
    assert abs(drawn.mean()) < 4.0 / np.sqrt(2000)
    assert drawn.var() == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / 2000))


def test_it_answers_the_same_in_any_order_and_company():
    one = noise(3, NoiseAxis(0.0, 5.0, 2.0), NoiseAxis(-1.0, 1.0, 0.3))
    together = one.on([0.0, 2.5, 5.0], [-1.0, 0.1, 0.2, 1.0])
    assert together.shape == (3, 4)
    for row, first in enumerate((0.0, 2.5, 5.0)):
        for column, second in enumerate((-1.0, 0.1, 0.2, 1.0)):
            assert one.on(first, second)[0, 0] == pytest.approx(together[row, column], abs=1e-12)


def test_it_is_smooth():
    values = noise(8, NoiseAxis(0.0, 10.0, 1.0)).on(np.linspace(0.0, 10.0, 1001))
    assert (
        np.abs(np.diff(values, 2)).max() < 1e-3
    )  # a second derivative of 10 would be far out of the ordinary
    assert np.ptp(values) > 1.0
