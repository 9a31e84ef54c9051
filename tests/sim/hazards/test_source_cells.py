"""Hazard brought from one grid to another: against every pair of cells, and what does not fit."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.grid import Grid
from planner.hazards import StageClock
from sim.errors import HazardError
from sim.hazards.source_cells import SourceCells, edges
from sim.weather.spans import Spans

CLOCK = StageClock(0.0, stage_count=3)  # hours 0 to 3


def grid_of(south, west, rows, columns, step_deg):
    return Grid(*map(math.radians, (south, west, step_deg, step_deg)), rows, columns)


def expected(source, grid, corridor_m, hazard):
    """Every planner's cell against every source cell, as boxes in degrees."""
    cells = np.zeros(grid.shape, dtype=bool)
    lat_edges, lon_edges = edges(source.lat_deg), edges(source.lon_deg)
    for row, lat in enumerate(np.degrees(grid.lat_rad)):
        high = max(0.5, corridor_m / grid.north_cell_m[row]) * math.degrees(grid.north_step_rad)
        wide = max(0.5, corridor_m / grid.east_cell_m[row]) * math.degrees(grid.east_step_rad)
        for column, lon in enumerate(np.degrees(grid.lon_rad)):
            for i, j in np.argwhere(hazard):
                tall = min(lat + high, lat_edges[i + 1]) - max(lat - high, lat_edges[i])
                broad = min(lon + wide, lon_edges[j + 1]) - max(lon - wide, lon_edges[j])
                cells[row, column] |= tall > 1e-5 and broad > 1e-5
    return cells


@settings(max_examples=30, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([0.03, 0.1, 0.25, 0.6]),
    st.floats(0.0, 0.5),
    st.sampled_from([0.0, 1100.0, 8000.0]),
    st.sampled_from([-360.0, 0.0, 360.0]),
)
def test_a_cell_is_hazardous_if_any_source_cell_it_touches_is(seed, step_deg, off, corridor_m, turn_deg):
    random = np.random.default_rng(seed)
    grid = grid_of(28.0, -82.0, 5, 6, 0.1)
    lat = 27.3 + off * step_deg + step_deg * np.arange(math.ceil(2.0 / step_deg))
    lon = -82.7 + off * step_deg + step_deg * np.arange(math.ceil(2.2 / step_deg))
    hazard = random.random((1, lat.size, lon.size)) < 0.02 + 0.1 * (step_deg > 0.2)
    source = SourceCells("rain", Spans.at(np.array([0.0, 10800.0])), lat, lon, np.repeat(hazard, 2, axis=0))
    turned = SourceCells("rain", source.spans, lat, lon + turn_deg, source.hazard)
    found = turned.on(grid, CLOCK, corridor_m=corridor_m)
    np.testing.assert_array_equal(found[0], expected(source, grid, corridor_m, hazard[0]))
    assert (found == found[0]).all()


def test_no_hazardous_source_cell_is_lost():
    """Even one far smaller than the planner's cells, which nearest neighbours would miss."""
    grid = grid_of(28.0, -82.0, 4, 4, 0.5)
    lat, lon = np.arange(27.7, 29.9, 0.05), np.arange(-82.3, -80.1, 0.05)
    for row, column in ((3, 5), (17, 30), (20, 11)):
        hazard = np.zeros((2, lat.size, lon.size), dtype=bool)
        hazard[:, row, column] = True
        found = SourceCells("rain", Spans.at(np.array([0.0, 1e4])), lat, lon, hazard).on(
            grid, StageClock(0.0, stage_count=1), corridor_m=0.0
        )
        assert found[0][grid.nearest_cell(math.radians(lat[row]), math.radians(lon[column]))]
        assert found[0].sum() <= 4


def test_the_same_grid_is_taken_cell_by_cell():
    grid = grid_of(28.0, -82.0, 7, 5, 0.1)
    hazard = np.random.default_rng(1).random((2, 7, 5)) < 0.3
    lat, lon = np.degrees(grid.lat_rad), np.degrees(grid.lon_rad)
    found = SourceCells("own", Spans.at(np.array([0.0, 10800.0])), lat, lon, hazard).on(
        grid, CLOCK, corridor_m=1100.0
    )
    np.testing.assert_array_equal(found[0], hazard.any(axis=0))


@pytest.mark.parametrize(
    ("time_h", "held"),
    [
        ([0, 1, 2, 3], [[0, 1], [1, 2], [2, 3]]),
        ([-2, -0.5, 0.5, 1.5, 9], [[1, 2, 3], [2, 3, 4], [3, 4]]),
        ([0, 3], [[0, 1], [0, 1], [0, 1]]),
        ([-1, 0, 0.2, 0.4, 1, 3, 4], [[1, 2, 3, 4], [4, 5], [4, 5]]),
    ],
)
def test_the_times_of_a_stage_and_those_around_it_count(time_h, held):
    grid = grid_of(28.0, -82.0, 2, 2, 0.1)
    lat, lon = np.degrees(grid.lat_rad), np.degrees(grid.lon_rad)
    for number in range(len(time_h)):
        hazard = np.zeros((len(time_h), 2, 2), dtype=bool)
        hazard[number] = True
        source = SourceCells("rain", Spans.at(3600.0 * np.array(time_h)), lat, lon, hazard)
        stages = source.on(grid, CLOCK, corridor_m=0.0).any(axis=(1, 2))
        assert stages.tolist() == [number in times for times in held]


@pytest.mark.parametrize(
    ("time_h", "south", "west", "message"),
    [
        ([0.5, 3], 27.9, -82.1, r"rain holds 1970-01-01T00:30:00 to .*, but the mission takes"),
        ([0, 2.5], 27.9, -82.1, "bring more"),
        ([0, 3], 28.2, -82.1, "deg of latitude, but the mission's grid from 28.000"),
        ([0, 3], 27.9, -81.8, "deg of longitude, but the mission's grid from -82.000"),
    ],
)
def test_a_source_that_does_not_reach_is_refused(time_h, south, west, message):
    lat, lon = south + 0.1 * np.arange(12), west + 0.1 * np.arange(12)
    source = SourceCells(
        "rain", Spans.at(3600.0 * np.array(time_h)), lat, lon, np.zeros((2, 12, 12), dtype=bool)
    )
    with pytest.raises(HazardError, match=message):
        source.on(grid_of(28.0, -82.0, 5, 6, 0.1), CLOCK, corridor_m=0.0)
