"""Legs in any direction: their time against a fine integration, their safety against dense sampling."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.air import Air, Chart
from planner.grid import Grid, geodesic_m
from planner.hazards import StageClock, hazard_stages
from planner.intervals import SafeIntervals
from planner.legs import Country, are_safe, fly, lay_legs
from planner.windfield import WindField

AIRSPEED_MPS = 27.0
THRESHOLD_MPS = 15.0
CORRIDOR_M = 1100.0
STEP_RAD = 3600.0 / 6_371_000.0
GRID = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, 12, 16)
CLOCK = StageClock(1000.0, stage_count=3, steps_per_stage=5)
CELLS = st.tuples(st.integers(0, GRID.rows - 1), st.integers(0, GRID.columns - 1))


def storm(seed, mean_mps=11.0, spread_mps=3.0):
    """Wind near the threshold that changes from cell to cell, with one time inside a stage."""
    random = np.random.default_rng(seed)
    time_s = CLOCK.departure_s + np.array([0.0, 600.0, 900.0, 1200.0, 1800.0])
    shape = time_s.size, *GRID.shape
    speed = random.normal(mean_mps, spread_mps, shape)
    angle = random.uniform(0.0, 2.0 * math.pi) + random.normal(0.0, 0.3, shape)
    return country_in(WindField(GRID, time_s, speed * np.cos(angle), speed * np.sin(angle)))


def breeze(seed):
    """Wind of several m/s that bends smoothly over the area and in time."""
    random = np.random.default_rng(seed)
    time_s = CLOCK.departure_s + np.array([0.0, 700.0, 1800.0])
    time, north, east = (np.linspace(-1.0, 1.0, size) for size in (time_s.size, *GRID.shape))
    slopes = random.normal(0.0, 0.5, 3)
    bend = slopes[0] * time[:, None, None] + slopes[1] * north[:, None] + slopes[2] * east
    angle = random.uniform(0.0, 2.0 * math.pi) + bend
    speed = 8.0 + 2.0 * np.sin(2.0 * bend)
    return country_in(WindField(GRID, time_s, speed * np.cos(angle), speed * np.sin(angle)))


def country_in(wind):
    hazard = hazard_stages(wind, CLOCK, threshold_mps=THRESHOLD_MPS, corridor_m=CORRIDOR_M)
    return wind, Country(Chart.of(GRID), Air.over(wind, CLOCK), SafeIntervals.of(hazard), CLOCK.stage_s)


def leg(country, start, end):
    return lay_legs(country.chart, start, np.array([end[0]]), np.array([end[1]]))


def by_small_steps(wind, start, end, depart_s):
    """Arrival after so many short stretches, each with the wind at its middle."""
    frame = GRID.frame
    north_m, east_m = frame.to_plane(
        *(
            axis[[first, last]]
            for axis, first, last in zip((GRID.lat_rad, GRID.lon_rad), start, end, strict=True)
        )
    )
    north, east = north_m[1] - north_m[0], east_m[1] - east_m[0]
    count = 300
    now_s = CLOCK.departure_s + depart_s
    course = math.atan2(east, north)
    for at in range(count):
        share = (at + 0.5) / count
        lat_rad, lon_rad = frame.to_geodetic(north_m[0] + share * north, east_m[0] + share * east)
        length_m = math.hypot(north, east) / count / frame.scale(lat_rad)
        blow = wind.at(min(now_s + 0.5 * length_m / AIRSPEED_MPS, wind.time_s[-1]), lat_rad, lon_rad)
        along = blow.north_mps * math.cos(course) + blow.east_mps * math.sin(course)
        across = blow.east_mps * math.cos(course) - blow.north_mps * math.sin(course)
        now_s += length_m / (along + math.sqrt(AIRSPEED_MPS**2 - across**2))
    return now_s - CLOCK.departure_s


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), start=CELLS, end=CELLS, depart_s=st.floats(0.0, 900.0))
def test_the_time_is_that_of_a_fine_integration(seed, start, end, depart_s):
    if start == end:
        return
    wind, country = breeze(seed)
    flown_s = float(fly(country, leg(country, start, end), depart_s, AIRSPEED_MPS)[0, -1]) - depart_s
    # Simpson's rule does not see where within a cell the wind's course of time has its kinks
    assert flown_s == pytest.approx(by_small_steps(wind, start, end, depart_s) - depart_s, rel=2e-3)


@given(start=CELLS, end=CELLS)
def test_the_pieces_add_up_to_the_leg_and_lie_each_in_one_square(start, end):
    if start == end:
        return
    country = Country(Chart.of(GRID), *[None] * 2, CLOCK.stage_s)
    laid = leg(country, start, end)
    straight_m = geodesic_m(
        *(
            axis[at]
            for cell in (start, end)
            for axis, at in zip((GRID.lat_rad, GRID.lon_rad), cell, strict=True)
        )
    )
    assert laid.length_m.sum() == pytest.approx(straight_m, rel=2e-5)
    assert (laid.row[0, 0], laid.column[0, 0]) == start
    assert (laid.row[0, -1], laid.column[0, -1]) == pytest.approx(end)
    for cuts in (laid.row[0], laid.column[0]):
        low, high = np.minimum(cuts[1:], cuts[:-1]), np.maximum(cuts[1:], cuts[:-1])
        assert (np.ceil(high - 1e-9) - np.floor(low + 1e-9) <= 1.0).all()


def test_legs_together_are_each_alone():
    _, country = storm(5)
    ends = [(0, 3), (7, 3), (11, 15), (6, 4), (5, 2)]
    together = lay_legs(country.chart, (5, 3), *np.array(ends).T)
    time_s = fly(country, together, 100.0, AIRSPEED_MPS)
    safe = are_safe(country, together, time_s)
    for at, end in enumerate(ends):
        alone = leg(country, (5, 3), end)
        alone_s = fly(country, alone, 100.0, AIRSPEED_MPS)
        assert time_s[at, -1] == pytest.approx(alone_s[0, -1], abs=0.01)
        assert safe[at] == are_safe(country, alone, alone_s)[0]


@settings(max_examples=50, deadline=None)
@given(
    seed=st.integers(0, 1000),
    start=CELLS,
    end=CELLS,
    departs=st.lists(st.floats(0.0, 1500.0), min_size=2, max_size=2),
)
def test_who_leaves_first_arrives_first(seed, start, end, departs):
    if start == end:
        return
    _, country = storm(seed)
    laid = leg(country, start, end)
    first, second = (fly(country, laid, depart_s, AIRSPEED_MPS)[0, -1] for depart_s in sorted(departs))
    assert first <= second + 2e-3


def test_nowhere_on_a_safe_leg_or_in_its_corridor_is_wind_above_the_threshold():
    """Every leg that is called safe is sampled densely, at the times of its flight and to both sides."""
    random = np.random.default_rng(3)
    safe_legs = unsafe_legs = 0
    worst_mps = 0.0
    for seed in range(60):
        wind, country = storm(seed, mean_mps=9.0)
        for _ in range(20):
            start, end = (tuple(int(random.integers(2, size - 2)) for size in GRID.shape) for _ in range(2))
            if start == end:
                continue
            depart_s = float(random.uniform(0.0, 1500.0))
            laid = leg(country, start, end)
            time_s = fly(country, laid, depart_s, AIRSPEED_MPS)
            if not are_safe(country, laid, time_s)[0]:
                unsafe_legs += 1
                continue
            safe_legs += 1
            worst_mps = max(worst_mps, sampled_wind_mps(wind, country, laid, time_s))
    assert safe_legs > 100
    assert unsafe_legs > 100
    assert 14.0 < worst_mps <= THRESHOLD_MPS + 1e-3


def sampled_wind_mps(wind, country, laid, time_s):
    """Highest wind on a leg and up to the corridor to both sides, 40 times a cell."""
    share = np.linspace(0.0, 1.0, 40 * int(max(abs(np.ptp(laid.row)), abs(np.ptp(laid.column)))) + 1)
    row = np.interp(share, laid.share[0], laid.row[0])
    column = np.interp(share, laid.share[0], laid.column[0])
    at_s = CLOCK.departure_s + np.interp(share, laid.share[0], time_s[0])
    course = laid.course[0]
    highest = 0.0
    for aside_m in (-CORRIDOR_M, -0.5 * CORRIDOR_M, 0.0, 0.5 * CORRIDOR_M, CORRIDOR_M):
        lat_rad = np.interp(row, np.arange(GRID.rows), GRID.lat_rad)
        lon_rad = np.interp(column, np.arange(GRID.columns), GRID.lon_rad)
        lat_rad = lat_rad - aside_m * course.imag / GRID.north_cell_m[0] * GRID.north_step_rad
        lon_rad = lon_rad + aside_m * course.real / GRID.east_cell_m[0] * GRID.east_step_rad
        north, east, _ = wind.at_many(at_s, lat_rad, lon_rad)
        highest = max(highest, float(np.hypot(north, east).max()))
    return highest


def test_a_leg_that_outlasts_the_horizon_is_not_safe():
    _, country = storm(0, mean_mps=0.0, spread_mps=0.0)
    laid = leg(country, (0, 0), (0, 10))
    for depart_s, safe in ((0.0, True), (1000.0, False)):
        assert are_safe(country, laid, fly(country, laid, depart_s, AIRSPEED_MPS))[0] == safe


def test_wind_stronger_than_the_airspeed_stops_a_leg():
    _, country = storm(0, mean_mps=40.0, spread_mps=0.0)
    laid = lay_legs(country.chart, (5, 5), np.array([5, 5, 9, 1]), np.array([9, 1, 5, 5]))
    time_s = fly(country, laid, 0.0, AIRSPEED_MPS)
    assert not np.isfinite(time_s[:, -1]).all()
    assert not are_safe(country, laid, time_s).any()
