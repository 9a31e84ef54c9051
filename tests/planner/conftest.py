"""Small worlds for the planner's tests."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from planner.ground import Ground, Occupancy
from planner.hazards import StageClock


@pytest.fixture(scope="session")
def enumeration():
    """The oracle that lists every route."""
    spec = importlib.util.spec_from_file_location("enumeration", Path(__file__).with_name("enumeration.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def small_world():
    """Draws a world from a seed: (seed, largest number of steps) -> ground, start, goal."""

    def draw(seed, steps=7, side=3):
        random = np.random.default_rng(seed)
        stages = int(random.integers(1, 4))
        per_stage = steps // stages
        shape = (stages, *random.integers(2, side + 1, 2))
        hazard = random.random(shape) < 0.25
        cell = tuple(tuple(int(random.integers(0, size)) for size in shape[1:]) for _ in range(2))
        clock = StageClock(0.0, stages, per_stage)
        return Ground(hazard, clock, random.choice(list(Occupancy))), *cell

    return draw
