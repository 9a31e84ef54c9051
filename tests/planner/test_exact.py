"""The true optimum against the enumeration of every route."""

import math

import numpy as np
import pytest

from planner.exact import search_exact
from planner.hazards import StageClock, clearance_cells
from planner.score import Weights
from planner.staged import StagedProblem, search


def random_weights(seed):
    random = np.random.default_rng([seed, 1])
    alpha, beta, gamma, delta = random.choice([0.0, 0.1, 0.3, 1.0, 2.0, 5.0], 4)
    return Weights(alpha, beta, gamma, delta, clearance_cap_cells=float(random.choice([1.5, 3.0, 30.0])))


@pytest.mark.parametrize("block", range(10))
def test_is_the_best_of_every_route(block, small_world, enumeration):
    for seed in range(block * 40, block * 40 + 40):
        ground, start, goal = small_world(seed)
        weights = random_weights(seed)
        problem = StagedProblem(ground.hazard, ground.clock, weights, ground.occupancy)
        clearance = clearance_cells(ground.hazard, weights.clearance_cap_cells)
        scores = [
            enumeration.score_of(cells, ground, weights, clearance)
            for cells in enumeration.every_route(ground, start)
            if cells[-1] == goal
        ]
        (one_label,) = search(problem, start, [goal])
        assert (one_label.best is None) == (not scores)
        if ground.hazard[0][start]:
            continue
        (exact,) = search_exact(problem, start, [goal])
        assert (exact.route is None) == (not scores)
        if exact.route:
            assert exact.route.score == pytest.approx(max(scores), abs=1e-6)
            assert exact.gap == 0.0
            assert exact.upper_bound >= max(scores) - 1e-6
            assert one_label.best.score <= exact.route.score + 1e-6


def test_one_label_can_miss_the_optimum_and_exact_finds_it(small_world):
    missed = 0
    for seed in range(3000):
        ground, start, goal = small_world(seed, steps=16, side=6)
        weights = Weights(alpha=1.0, beta=5.0, gamma=0.3, delta=0.1)
        problem = StagedProblem(ground.hazard, ground.clock, weights, ground.occupancy)
        (one_label,) = search(problem, start, [goal])
        if one_label.best and one_label.best.waits:
            (exact,) = search_exact(problem, start, [goal])
            missed += exact.route.score > one_label.best.score + 1e-6
        if missed:
            return
    pytest.fail("no world in which one label misses the optimum")


def test_a_bounded_number_of_sweeps_reports_the_gap_it_leaves():
    random = np.random.default_rng(5)
    hazard = random.random((4, 14, 14)) < 0.2
    hazard[:, 0, 0] = hazard[:, 13, 13] = False
    problem = StagedProblem(hazard, StageClock(0.0, 4, 15), Weights(beta=5.0, gamma=0.4))
    goals = [(13, 13), (0, 13), (13, 0)]
    rough = search_exact(problem, (0, 0), goals, sweeps=3)
    exact = search_exact(problem, (0, 0), goals)
    for one, other in zip(rough, exact, strict=True):
        assert (one.route is None) == (other.route is None)
        if one.route and other.route:
            assert one.upper_bound >= other.route.score - 1e-6
            assert one.gap == pytest.approx(one.upper_bound - one.route.score, abs=2e-6)
            assert other.gap == 0.0


def test_a_goal_out_of_reach_has_no_route():
    hazard = np.zeros((1, 1, 3), dtype=bool)
    hazard[0, 0, 1] = True
    (found,) = search_exact(StagedProblem(hazard, StageClock(0.0, 1, 5), Weights()), (0, 0), [(0, 2)])
    assert found.route is None
    assert math.isinf(found.upper_bound)
