"""Contours against brute force: every edge of the grid that a level crosses, and nothing else."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from recordings.contours import dashed, hazard_edges, level_lines

ROWS, COLUMNS = 9, 12
EAST_KM = 3.0 * np.arange(COLUMNS)
NORTH_KM = np.cumsum(1.0 + 0.1 * np.arange(ROWS))  # rows lie unequally far apart


def crossings(values, level):
    """The points of all edges between neighbouring cells where the value, linear along it, is the level."""
    found = []
    for row in range(ROWS):
        for column in range(COLUMNS):
            for other in ((row + 1, column), (row, column + 1)):
                if other[0] == ROWS or other[1] == COLUMNS:
                    continue
                here, there = values[row, column], values[other]
                if (here > level) != (there > level):
                    share = (level - here) / (there - here)
                    found.append(
                        (
                            EAST_KM[column] + share * (EAST_KM[other[1]] - EAST_KM[column]),
                            NORTH_KM[row] + share * (NORTH_KM[other[0]] - NORTH_KM[row]),
                        )
                    )
    return sorted(found)


@given(seed=st.integers(0, 2**32 - 1), level=st.floats(-1.0, 1.0))
@settings(max_examples=50, deadline=None)
def test_a_contour_goes_through_every_crossing_of_its_level_and_through_nothing_else(seed, level):
    values = np.random.default_rng(seed).normal(size=(ROWS, COLUMNS))
    lines = level_lines(values, level, EAST_KM, NORTH_KM)
    points = {tuple(point) for line in lines for point in np.round(line, 9)}  # closed ones end as they begin
    np.testing.assert_allclose(sorted(points), crossings(values, level), atol=1e-8)


def test_contours_are_closed_or_end_at_the_edge():
    values = np.random.default_rng(3).normal(size=(ROWS, COLUMNS))
    for line in level_lines(values, 0.2, EAST_KM, NORTH_KM):
        ends = line[[0, -1]]
        on_edge = np.isin(ends[:, 0], EAST_KM[[0, -1]]) | np.isin(ends[:, 1], NORTH_KM[[0, -1]])
        assert np.array_equal(*ends) or on_edge.all()


@pytest.mark.parametrize("level", [-5.0, 5.0])
def test_a_level_that_is_not_reached_has_no_contour(level):
    values = np.random.default_rng(3).uniform(-1.0, 1.0, size=(ROWS, COLUMNS))
    assert level_lines(values, level, EAST_KM, NORTH_KM) == []


def test_a_single_row_has_no_contour():
    assert level_lines(np.array([[0.0, 2.0]]), 1.0, EAST_KM[:2], NORTH_KM[:1]) == []


def test_where_the_wind_is_not_known_the_edge_runs_between_cells_in_and_out(workshop):
    sheet = workshop.sheets(stages=1)[0]
    rows, columns = sheet.hazard.shape
    assert sheet.peak_mps is None
    lines = hazard_edges(sheet, 15.0, np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    assert lines
    for east, north in np.concatenate(lines):
        between = {
            bool(sheet.hazard[row, column])
            for row in {int(np.floor(north)), int(np.ceil(north))}
            for column in {int(np.floor(east)), int(np.ceil(east))}
        }
        assert between == {False, True}


def test_dashes_are_half_of_a_line_and_lie_on_it():
    angle_rad = np.linspace(0.0, 2.0 * np.pi, 400)
    circle = 10.0 * np.column_stack([np.cos(angle_rad), np.sin(angle_rad)])
    dashes = dashed([circle], 2.0)
    lengths = [np.hypot(*np.diff(dash, axis=0).T).sum() for dash in dashes]
    assert sum(lengths) == pytest.approx(10.0 * np.pi, abs=2.0)
    assert lengths[:-1] == pytest.approx([2.0] * (len(dashes) - 1))
    for dash in dashes:
        np.testing.assert_allclose(np.hypot(*dash.T), 10.0, atol=0.01)
    for before, after in pairwise(dashes):
        assert np.hypot(*(after[0] - before[-1])) == pytest.approx(2.0, abs=0.01)


def test_cells_that_are_closed_for_another_reason_have_an_edge_too(workshop):
    (sheet,) = workshop.sheets(stages=1)[:1]
    peak_mps = np.zeros(workshop.grid.shape, np.float32)
    peak_mps[:10] = 30.0
    closed = np.zeros(workshop.grid.shape, bool)
    closed[30:40, 30:40] = True
    east_km, north_km = (np.arange(float(size)) for size in reversed(workshop.grid.shape))
    windy = hazard_edges(replace(sheet, peak_mps=peak_mps), 15.0, east_km, north_km)
    both = hazard_edges(replace(sheet, peak_mps=peak_mps, closed=closed), 15.0, east_km, north_km)
    assert len(both) == len(windy) + 1
    edge = both[-1]
    assert edge.min() == 29.5
    assert edge.max() == 39.5
