"""Small worlds in which the planners differ; a stage has five steps."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner.hazards import StageClock
from planner.score import Weights
from planner.staged import Occupancy, StagedProblem


def make(hazard, steps=5, occupancy=Occupancy.STRICT, flyable=None):
    clock = StageClock(0.0, stage_count=len(hazard), steps_per_stage=steps)
    return StagedProblem(
        np.asarray(hazard, dtype=bool), clock, Weights(clearance_cap_cells=4.0), occupancy, flyable
    )


@pytest.fixture
def world():
    """(hazard, steps=5, occupancy=strict, flyable=None) -> problem."""
    return make


def world_of(hazard, start, goal, optimum):
    return SimpleNamespace(problem=make(hazard), start=start, goal=goal, optimum=optimum)


@pytest.fixture
def still():
    """A wall that stands, with a gap at its east end."""
    hazard = np.zeros((8, 9, 9), dtype=bool)
    hazard[:, 4, :6] = True
    return world_of(hazard, (1, 1), (7, 1), 6 + 2 * 5)


@pytest.fixture
def door():
    """A wall across the whole map that opens in the fourth stage: everyone must wait."""
    hazard = np.zeros((8, 7, 9), dtype=bool)
    hazard[:, :, 4] = True
    hazard[3:, 2:5, 4] = False
    return world_of(hazard, (3, 1), (3, 7), 15 + 4)


@pytest.fixture
def shutter():
    """Two gaps in a wall, and the one on the straight way shuts before anyone gets there."""
    hazard = np.zeros((8, 9, 12), dtype=bool)
    hazard[:, :, 8] = True
    hazard[0, 0:2, 8] = False
    hazard[:, 6:8, 8] = False
    return world_of(hazard, (0, 0), (0, 11), 11 + 2 * 6)


@pytest.fixture
def siding():
    """A corridor that must be left for its siding while hazard passes, and entered again."""
    hazard = np.ones((4, 2, 6), dtype=bool)
    hazard[0, 0, :3] = False  # the corridor as far as the door in column 3
    hazard[:, 1, 1] = False  # the siding, always safe
    hazard[0:2, 0, 1] = False
    hazard[2:, 0, :] = False  # the hazard has passed, and the door is open
    hazard[1, 0, 1] = True
    return world_of(hazard, (0, 0), (0, 5), 10 + 1 + 4)
