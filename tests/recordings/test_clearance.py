"""Clearance against the distance of every sample from every hazardous cell."""

import math
from dataclasses import replace

import numpy as np
import pyproj
import pytest

from planner.errors import OutsideGridError
from planner.grid import Grid
from recordings.clearance import in_closed_cells, nearest_approach
from recordings.recorder import Layer
from recordings.recording import HazardSheet
from recordings.tracking import track

GEOD = pyproj.Geod(ellps="WGS84")


def brute_force(sheets, time_s, lat_rad, lon_rad):
    best = math.inf, -1
    for sample, now_s in enumerate(time_s):
        sheet = [sheet for sheet in sheets if sheet.time_s <= now_s][-1]
        for row, column in np.argwhere(sheet.hazard):
            cell = sheet.grid.lon_rad[column], sheet.grid.lat_rad[row]
            best = min(best, (GEOD.inv(*cell, lon_rad[sample], lat_rad[sample], radians=True)[2], sample))
    return best


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("lat_deg", [-60.0, 0.0, 30.0])
def test_every_pair_says_the_same(seed, lat_deg):
    generator = np.random.default_rng(seed)
    grid = Grid.covering(
        math.radians(lat_deg),
        math.radians(lat_deg + 2.0),
        math.radians(10.0),
        math.radians(14.0),
        rows=12,
        columns=16,
    )
    sheets = [
        HazardSheet(Layer.TRUTH, stage, 30.0 * stage, 15.0, grid, generator.random(grid.shape) < 0.03)
        for stage in range(3)
    ]
    time_s = np.arange(100.0)
    lat_rad = math.radians(lat_deg + 0.5) + np.cumsum(generator.normal(2e-4, 2e-4, 100))
    lon_rad = math.radians(11.0) + np.cumsum(generator.normal(2e-4, 2e-4, 100))
    found = nearest_approach(sheets, time_s, lat_rad, lon_rad)
    assert found is not None
    distance_m, sample = brute_force(sheets, time_s, lat_rad, lon_rad)
    assert (found.distance_m, found.sample) == (pytest.approx(distance_m, rel=1e-6), sample)


def test_no_hazard_is_no_clearance(workshop):
    flight = workshop.fly(
        workshop.header(workshop.straight), sheets=workshop.sheets(np.zeros(workshop.grid.shape, bool))
    )
    assert track(workshop.recording(flight)).min_clearance_m is None


def test_hazards_of_another_stage_do_not_count(workshop):
    """The second stage is hazardous right on the path, where the flight was in the first."""
    row, column = workshop.grid.nearest_cell(
        workshop.grid.frame.origin_lat_rad, workshop.grid.frame.origin_lon_rad
    )
    here, far = np.zeros(workshop.grid.shape, bool), np.zeros(workshop.grid.shape, bool)
    here[row, column] = far[0, 0] = True
    sheets = [*workshop.sheets(far)[:2], *workshop.sheets(here)[2:]]
    header = workshop.header(workshop.straight, leg_s=300.0)
    flight = workshop.fly(header, sheets=sheets)
    report = track(workshop.recording(flight))
    state = flight.states[6300]
    cell = workshop.grid.lon_rad[column], workshop.grid.lat_rad[row]
    _, _, distance_m = GEOD.inv(*cell, state.lon_rad, state.lat_rad, radians=True)
    assert report.min_clearance_m == pytest.approx(distance_m)
    assert report.worst["min_clearance_m"].time_s == 600.0


def test_only_the_truth_counts(workshop):
    sheets = workshop.sheets()
    for sheet in sheets[::2]:
        assert sheet.layer == Layer.FORECAST
    none = workshop.sheets(np.zeros(workshop.grid.shape, bool))
    header = workshop.header(workshop.straight)
    mixed = [sheet for pair in zip(sheets[::2], none[1::2], strict=True) for sheet in pair]
    assert track(workshop.recording(workshop.fly(header, sheets=mixed))).min_clearance_m is None


def closing(sheets, closed, layer=Layer.TRUTH):
    """The sheets with cells of one layer closed for another reason than the wind."""
    return [
        replace(sheet, hazard=sheet.hazard | closed, closed=closed) if sheet.layer is layer else sheet
        for sheet in sheets
    ]


@pytest.mark.parametrize("layer", list(Layer))
def test_time_in_cells_that_are_truly_closed_is_exposure(workshop, layer):
    grid, header = workshop.grid, workshop.header(workshop.straight, leg_s=300.0)
    plain = workshop.fly(header, sheets=workshop.sheets(np.zeros(grid.shape, bool)))
    cells = [grid.nearest_cell(state.lat_rad, state.lon_rad) for state in plain.states]
    middle = cells[len(cells) // 2]
    closed = np.zeros(grid.shape, bool)
    closed[middle] = True
    sheets = closing(workshop.sheets(np.zeros(grid.shape, bool)), closed, layer)
    report = track(workshop.recording(workshop.fly(header, sheets=sheets)))
    inside = [state.time_s for state, cell in zip(plain.states, cells, strict=True) if cell == middle]
    if layer is Layer.FORECAST:  # what was only feared is no exposure
        assert report.hazard_exposure_s == 0.0
        return
    assert len(inside) > 20
    assert report.hazard_exposure_s == pytest.approx(0.1 * len(inside))
    assert report.worst["hazard_exposure_s"].time_s == pytest.approx(inside[0])
    assert report.min_clearance_m < 0.5 * float(grid.north_cell_m[0] + grid.east_cell_m.max())


@pytest.mark.parametrize("seed", range(5))
def test_closed_cells_are_those_that_a_sample_lies_in(seed):
    random = np.random.default_rng(seed)
    grid = Grid.covering(*map(math.radians, (10.0, 12.0, 179.0, 181.0)), rows=9, columns=7)
    none = np.zeros(grid.shape, bool)
    sheets = [
        HazardSheet(Layer.TRUTH, stage, 100.0 * stage, 15.0, grid, none, closed=closed)
        for stage, closed in enumerate(
            [random.random(grid.shape) < 0.4, None, random.random(grid.shape) < 0.4]
        )
    ]
    time_s = np.sort(random.uniform(0.0, 300.0, 200))
    lat_rad, lon_rad = (
        np.radians(random.uniform(9.8, 12.2, 200)),
        np.radians(random.uniform(178.8, 181.2, 200)),
    )
    lon_rad = np.where(lon_rad > math.pi, lon_rad - 2.0 * math.pi, lon_rad)
    found = in_closed_cells(sheets, time_s, lat_rad, lon_rad)
    for sample, (now_s, lat, lon) in enumerate(zip(time_s, lat_rad, lon_rad, strict=True)):
        closed = sheets[int(now_s // 100.0)].closed
        try:
            expected = closed is not None and closed[grid.nearest_cell(lat, lon)]
        except OutsideGridError:
            expected = False
        assert found[sample] == expected
    assert 20 < found.sum() < 120
