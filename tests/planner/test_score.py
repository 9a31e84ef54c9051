"""Equation (2) of the paper."""

import pytest

from planner.score import Weights


def test_equation_two():
    weights = Weights(alpha=2.0, beta=3.0, gamma=0.5, delta=0.25)
    score = weights.score(clearance=4.0, mean_clearance=5.0, moves=6.0, steps=8)
    assert score == pytest.approx(2 * 4 + 3 * 5 - 0.5 * 6 - 0.25 * 8)
