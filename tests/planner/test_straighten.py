"""Straight legs along ways found by the sweep: never later, never unsafe, straight where nothing forbids."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.air import Air, Chart
from planner.earliest import sweep
from planner.edges import TimedProblem
from planner.grid import Grid, geodesic_m
from planner.hazards import StageClock
from planner.intervals import SafeIntervals
from planner.legs import Country, are_safe, fly, lay_legs
from planner.moves import Moves
from planner.straighten import cell_by_cell, nodes_to, straighten

AIRSPEED_MPS = 27.0
STEP_RAD = 3600.0 / 6_371_000.0
GRID = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, 12, 16)
CLOCK = StageClock(0.0, stage_count=6, steps_per_stage=5)
TIME_S = np.arange(7) * CLOCK.stage_s


def country_of(hazard, wind_mps):
    intervals = SafeIntervals.of(hazard)
    return Country(Chart.of(GRID), Air(TIME_S, wind_mps.astype(np.complex64)), intervals, CLOCK.stage_s)


def way_to(country, goal, start=(0, 0)):
    problem = TimedProblem(
        country.intervals, CLOCK, country.air, Moves.on(country.chart), AIRSPEED_MPS, AIRSPEED_MPS + 15.1
    )
    found = sweep(problem, start)
    state = found.best_state(goal)
    return None if state is None else nodes_to(found, state, CLOCK.stage_s)


def smooth_wind(random):
    """Up to 10 m/s, linear over the area and in time."""
    shape = TIME_S.size, *GRID.shape
    slopes = random.normal(0.0, 3.0, (4, 2)) @ [1.0, 1.0j]
    time, north, east = (np.linspace(-0.5, 0.5, size) for size in shape)
    wind = slopes[0] + slopes[1] * time[:, None, None] + slopes[2] * north[:, None] + slopes[3] * east
    return wind * np.minimum(1.0, 10.0 / np.maximum(np.abs(wind), 1e-9))


def blobs(random, count):
    """Hazard of squares that come and go."""
    hazard = np.zeros((CLOCK.stage_count, *GRID.shape), dtype=bool)
    for _ in range(count):
        stage, row, column = (int(random.integers(0, size)) for size in hazard.shape)
        hazard[stage : stage + 3, row : row + 4, column : column + 4] = True
    hazard[0, 0, 0] = False
    return hazard


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_never_later_than_the_way_and_always_safe(seed):
    random = np.random.default_rng(seed)
    country = country_of(blobs(random, 8), smooth_wind(random))
    way = way_to(country, (11, 15))
    if way is None:
        return
    legs = straighten(country, way, AIRSPEED_MPS)
    assert legs is not None
    assert legs[-1].arrive_s <= way[-1].arrive_s + 0.3
    assert (legs[0].start, legs[-1].end) == ((0, 0), (11, 15))
    now_s, place = 0.0, (0, 0)
    for leg in legs:
        assert leg.start == place
        assert leg.leave_s >= now_s
        waited = range(int(now_s // CLOCK.stage_s), int(leg.leave_s // CLOCK.stage_s) + 1)
        assert (country.intervals.run[waited, country.intervals.place_of(*place)] >= 0).all()
        laid = lay_legs(country.chart, leg.start, *(np.array([index]) for index in leg.end))
        time_s = fly(country, laid, leg.leave_s, AIRSPEED_MPS)
        assert are_safe(country, laid, time_s)[0]
        assert time_s[0, -1] == pytest.approx(leg.arrive_s, abs=0.01)
        now_s, place = leg.arrive_s, leg.end


@pytest.mark.parametrize("goal", [(11, 15), (3, 14), (11, 2), (0, 9)])
def test_in_still_air_it_is_one_leg_and_distance_over_airspeed(goal):
    country = country_of(np.zeros((6, *GRID.shape), dtype=bool), np.zeros((7, *GRID.shape)))
    legs = straighten(country, way_to(country, goal), AIRSPEED_MPS)
    straight_m = geodesic_m(GRID.lat_rad[0], GRID.lon_rad[0], GRID.lat_rad[goal[0]], GRID.lon_rad[goal[1]])
    assert len(legs) == 1
    assert legs[0].arrive_s == pytest.approx(straight_m / AIRSPEED_MPS, rel=2e-5)


@pytest.mark.parametrize(("wind_mps", "speed_mps"), [(10.0, 37.0), (-10.0, 17.0), (10.0j, 25.079872)])
def test_tail_head_and_cross_wind_have_the_analytic_time(wind_mps, speed_mps):
    country = country_of(np.zeros((6, *GRID.shape), dtype=bool), np.full((7, *GRID.shape), wind_mps))
    legs = straighten(country, way_to(country, (11, 0)), AIRSPEED_MPS)
    straight_m = geodesic_m(GRID.lat_rad[0], GRID.lon_rad[0], GRID.lat_rad[11], GRID.lon_rad[0])
    assert legs[-1].arrive_s == pytest.approx(straight_m / speed_mps, rel=2e-5)


def test_a_leg_waits_for_hazard_to_lift_and_goes_round_it_if_that_is_sooner():
    hazard = np.zeros((6, *GRID.shape), dtype=bool)
    hazard[:3, :, 8] = True
    still = np.zeros((7, *GRID.shape))
    legs = straighten(country_of(hazard, still), way_to(country_of(hazard, still), (0, 15)), AIRSPEED_MPS)
    waits = [leg.leave_s for before, leg in pairwise(legs) if leg.leave_s > before.arrive_s]
    assert waits == [3 * CLOCK.stage_s]
    hazard[:, 2:, 8] = False
    country = country_of(hazard, still)
    legs = straighten(country, way_to(country, (0, 15)), AIRSPEED_MPS)
    assert all(leg.leave_s == before.arrive_s for before, leg in pairwise(legs))
    assert len(legs) == 3  # to one corner of the wall, past it, and on


def test_a_way_of_one_cell_has_no_legs():
    country = country_of(np.zeros((6, *GRID.shape), dtype=bool), np.zeros((7, *GRID.shape)))
    way = way_to(country, (0, 0))
    assert straighten(country, way, AIRSPEED_MPS) == cell_by_cell(way, AIRSPEED_MPS) == []
