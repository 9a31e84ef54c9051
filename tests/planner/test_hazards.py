"""Hazard and flyability against dense sampling of the same wind."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.errors import BadFieldError, OutsideFieldError
from planner.grid import Grid, geodesic_m
from planner.hazards import (
    OFFSETS,
    Move,
    StageClock,
    clearance_cells,
    clearance_m,
    flyable_moves,
    hazard_stages,
)
from planner.windfield import WindField

ROWS, COLUMNS = 6, 7
CORRIDOR_M = 900.0
THRESHOLD_MPS = 12.0


def field(seed, times=5):
    random = np.random.default_rng(seed)
    step = math.radians(0.03)
    grid = Grid(math.radians(25.0), math.radians(-85.0), step, step, ROWS, COLUMNS)
    shape = (times, ROWS, COLUMNS)
    return WindField(
        grid=grid,
        time_s=np.arange(times) * 1800.0,
        north_mps=random.normal(0.0, 6.0, shape),
        east_mps=random.normal(0.0, 6.0, shape),
    )


def clock(stages=2):
    return StageClock(0.0, stage_count=stages, steps_per_stage=30, step_s=120.0)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000))
def test_the_corridor_of_every_safe_move_stays_below_the_threshold(seed):
    """The promise of strict occupancy: on the way between two safe cells no sample is over the threshold."""
    wind = field(seed)
    hazard = hazard_stages(wind, clock(), threshold_mps=THRESHOLD_MPS, corridor_m=CORRIDOR_M)
    random = np.random.default_rng(seed)
    checked = 0
    for stage, row, column in np.argwhere(~hazard):
        for move in (Move.STAY, Move.NORTH, Move.EAST):
            target = row + OFFSETS[move][0], column + OFFSETS[move][1]
            if target[0] >= ROWS or target[1] >= COLUMNS or hazard[stage, *target]:
                continue
            share = random.random(40)
            aside = random.uniform(-CORRIDOR_M, CORRIDOR_M, (2, 40))
            north_m = share * OFFSETS[move][0] * wind.grid.north_cell_m[row] + aside[0]
            east_m = share * OFFSETS[move][1] * wind.grid.east_cell_m[row] + aside[1]
            if move is not Move.STAY:  # beside the line, not beyond its ends
                north_m = np.clip(north_m, -CORRIDOR_M, CORRIDOR_M + wind.grid.north_cell_m[row])
            rows = np.clip(row + north_m / wind.grid.north_cell_m[row], 0, ROWS - 1)
            columns = np.clip(column + east_m / wind.grid.east_cell_m[row], 0, COLUMNS - 1)
            north, east, _ = wind.at_many(
                (stage + random.random(40)) * 3600.0,
                wind.grid.south_rad + rows * wind.grid.north_step_rad,
                wind.grid.west_rad + columns * wind.grid.east_step_rad,
                np.zeros(40),
            )
            assert np.hypot(north, east).max() <= THRESHOLD_MPS + 1e-4
            checked += 1
    assert checked or hazard.all()


def test_a_cell_is_hazardous_if_it_is_so_at_any_time_of_the_stage():
    wind = field(1)
    north, east = np.zeros((2, 5, ROWS, COLUMNS))
    east[1, 2, 3] = 20.0  # half past the first hour only
    calm = WindField(grid=wind.grid, time_s=wind.time_s, north_mps=north, east_mps=east)
    hazard = hazard_stages(calm, clock(), threshold_mps=15.0, corridor_m=0.0)
    assert np.argwhere(hazard).tolist() == [[0, 2, 3]]


def test_a_wider_corridor_is_never_less_careful():
    wind = field(3)
    narrow, wide = (
        hazard_stages(wind, clock(), threshold_mps=THRESHOLD_MPS, corridor_m=corridor_m)
        for corridor_m in (0.0, 1500.0)
    )
    assert (wide >= narrow).all()
    assert wide.sum() > narrow.sum()


@pytest.mark.parametrize("corridor_m", [-1.0, 5000.0, math.nan])
def test_a_corridor_wider_than_a_cell_is_refused(corridor_m):
    with pytest.raises(BadFieldError, match="corridor"):
        hazard_stages(field(0), clock(), threshold_mps=15.0, corridor_m=corridor_m)


def test_a_horizon_beyond_the_wind_is_refused():
    with pytest.raises(OutsideFieldError, match="time"):
        hazard_stages(field(0), clock(3), threshold_mps=15.0, corridor_m=0.0)


def test_flyable_moves_follow_the_wind_triangle():
    wind = field(5)
    low_mps, high_mps = 25.0, 36.0
    flyable = flyable_moves(wind, clock(), airspeed_min_mps=low_mps, airspeed_max_mps=high_mps)
    for stage, row, column in np.ndindex(2, ROWS, COLUMNS):
        for move, (rows, columns) in OFFSETS.items():
            there = row + rows, column + columns
            inside = 0 <= there[0] < ROWS and 0 <= there[1] < COLUMNS
            if move is Move.STAY or not inside:
                assert flyable[stage, move, row, column] == (move is Move.STAY)
                continue
            ends_rad = [(wind.grid.lat_rad[r], wind.grid.lon_rad[c]) for r, c in ((row, column), there)]
            ground_mps = geodesic_m(*ends_rad[0], *ends_rad[1]) / 120.0
            airspeeds_mps = [
                math.hypot(
                    rows * ground_mps - wind.north_mps[time][cell],
                    columns * ground_mps - wind.east_mps[time][cell],
                )
                for time in range(2 * stage, 2 * stage + 3)
                for cell in ((row, column), there)
            ]
            expected = low_mps <= min(airspeeds_mps) and max(airspeeds_mps) <= high_mps
            if min(abs(speed - limit) for speed in airspeeds_mps for limit in (low_mps, high_mps)) > 0.01:
                assert flyable[stage, move, row, column] == expected


def test_clearance_is_the_distance_to_the_nearest_hazard():
    hazard = np.zeros((2, 5, 6), dtype=bool)
    hazard[0, 1, 1] = hazard[0, 4, 5] = True
    clearance = clearance_cells(hazard, cap_cells=3.0)
    for row, column in np.ndindex(5, 6):
        nearest = min(math.dist((row, column), place) for place in ((1, 1), (4, 5)))
        assert clearance[0, row, column] == pytest.approx(min(nearest, 3.0))
    assert (clearance[1] == 3.0).all()


def test_clearance_in_metres_is_near_the_geodesic():
    grid = field(0).grid
    hazard = np.zeros(grid.shape, dtype=bool)
    hazard[4, 6] = hazard[1, 0] = True
    clear_m = clearance_m(grid, hazard)
    for row, column in np.ndindex(grid.shape):
        expected_m = min(
            geodesic_m(grid.lat_rad[row], grid.lon_rad[column], grid.lat_rad[r], grid.lon_rad[c])
            for r, c in ((4, 6), (1, 0))
        )
        assert clear_m[row, column] == pytest.approx(expected_m, rel=1e-3)
    assert np.isinf(clearance_m(grid, np.zeros_like(hazard))).all()
