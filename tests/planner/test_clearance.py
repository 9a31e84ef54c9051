"""Capped clearance against scipy's distance transform."""

import numpy as np
import pytest

from planner.clearance import capped_clearance
from planner.hazards import clearance_cells


@pytest.mark.parametrize("cap", [0.0, 0.5, 1.0, 1.5, 4.0, 30.0, 100.0, 120.0])
@pytest.mark.parametrize("share", [0.0, 0.002, 0.1, 1.0])
def test_is_the_distance_transform_up_to_the_cap(cap, share):
    hazard = np.random.default_rng(1).random((2, 37, 53)) < share
    assert np.array_equal(capped_clearance(hazard, cap), clearance_cells(hazard, cap))
