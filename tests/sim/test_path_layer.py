"""How long laps take in wind."""

import math

import numpy as np
import pytest

from planner.grid import Grid
from planner.plans import Waypoint
from planner.windfield import WindField
from sim.path_layer import PathLayer

GRID = Grid.covering(*np.radians([29.0, 29.32, -90.0, -89.63]).tolist(), rows=5, columns=5)
RADIUS_M, AIRSPEED_MPS = 550.0, 27.0
HERE = Waypoint(29.1, -89.8, 1000.0, 600.0, 0)


def wind_of(north_mps, east_mps):
    """The same everywhere."""
    sheet = np.ones((2, *GRID.shape))
    return WindField(GRID, np.array([0.0, 3600.0]), north_mps * sheet, east_mps * sheet)


@pytest.mark.parametrize("wind_mps", [0.0, 5.0, 12.0, 18.0, 0.8 * AIRSPEED_MPS])
def test_most_of_a_lap_is_more_than_half_and_less_than_one(wind_mps):
    layer = PathLayer(GRID.frame, 0.0, 1000.0, 400.0, RADIUS_M, AIRSPEED_MPS, math.radians(35.0))
    course_rad = np.linspace(0.0, 2.0 * math.pi, 3601)
    ahead_mps = np.sqrt(AIRSPEED_MPS**2 - (wind_mps * np.sin(course_rad)) ** 2)
    lap_s = np.trapezoid(RADIUS_M / (wind_mps * np.cos(course_rad) + ahead_mps), course_rad)
    most_s = layer.lap_s(HERE, wind_of(0.6 * wind_mps, -0.8 * wind_mps))
    assert lap_s * (1.0 - 1e-9) <= most_s < lap_s / 0.75
