"""A small world whose days take a tenth of a second."""

from dataclasses import replace

import pytest

from sim.reproduce.days import Day
from sim.reproduce.forecasts import DayForecasts
from sim.reproduce.worlds import QUICK

SMALL = replace(QUICK, rows=41, columns=37, stage_count=4, distances_cells=(8, 20), goals=5)


@pytest.fixture(scope="session")
def small():
    return SMALL


@pytest.fixture(scope="session")
def cases():
    """Cases of a few days at twice the published errors."""
    return [DayForecasts(Day(SMALL, seed), 2.0, members=8).case() for seed in range(3, 7)]
