"""The planner against the paper word for word in pure Python, which its speed is measured against."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import planner
from planner.score import Weights

WEIGHTS = Weights(alpha=0.9, beta=1.7, gamma=0.13, delta=0.11, clearance_cap_cells=4.0)


@pytest.fixture(scope="module")
def literal():
    path = Path(__file__).resolve().parents[2] / "benchmarks" / "literal_planner.py"
    spec = importlib.util.spec_from_file_location("literal_planner", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("seed", range(20))
def test_finds_what_the_literal_version_finds(literal, seed):
    random = np.random.default_rng(seed)
    shape = (4, *(int(side) for side in random.integers(1, 13, 2)))
    hazard = random.random(shape) < random.choice([0.0, 0.1, 0.3])
    start = shape[1] // 2, shape[2] // 2
    goals = list(np.ndindex(shape[1:]))
    world = literal.LiteralWorld(hazard.tolist(), 6)
    arrivals = planner.plan(hazard, start, goals, steps_per_stage=6)
    expected = [None if entry.route is None else list(entry.route.cells) for entry in arrivals]
    assert literal.earliest_carried(world, start, goals) == expected
    assert literal.earliest_queued(world, start, goals) == expected
    weights = (WEIGHTS.alpha, WEIGHTS.beta, WEIGHTS.gamma, WEIGHTS.delta)
    scored = planner.plan(hazard, start, goals, steps_per_stage=6, objective="score", weights=WEIGHTS)
    for found, known in zip(scored, literal.best_score(world, start, goals, weights, 4), strict=True):
        assert (found.route is None) == (known is None)
        if found.route and known:
            assert found.route.score == pytest.approx(known[0], abs=1e-9)
