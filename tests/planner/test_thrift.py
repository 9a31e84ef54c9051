"""The airspeeds along given legs: faster against the wind, slower before a gate, never unsafe."""

import math
from itertools import pairwise

import numpy as np
import pytest

from planner.air import Air, Chart
from planner.consumption import FuelFlow
from planner.grid import Grid
from planner.hazards import StageClock
from planner.intervals import SafeIntervals
from planner.legs import Country, fly, lay_legs
from planner.thrift import with_thrifty_speeds
from planner.way import Leg

STEP_RAD = 3600.0 / 6_371_000.0
GRID = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, 3, 30)
CLOCK = StageClock(0.0, stage_count=4)
SPEEDS = tuple(np.linspace(20.0, 40.0, 21).tolist())
FLOW = FuelFlow(SPEEDS, tuple(1e-5 + 2e-9 * speed**3 for speed in SPEEDS))


def country_of(east_mps, closed_until=0):
    hazard = np.zeros((4, *GRID.shape), dtype=bool)
    hazard[:closed_until, :, 15] = True
    wind_mps = np.broadcast_to(1j * np.asarray(east_mps), (5, *GRID.shape)).astype(np.complex64)
    return Country(Chart.of(GRID), Air(np.arange(5) * 3600.0, wind_mps), SafeIntervals.of(hazard), 3600.0)


def flown(country, cells, leave_s, airspeed_mps=27.0):
    legs = []
    for (start, end), left_s in zip(pairwise(cells), leave_s, strict=True):
        now_s = max(legs[-1].arrive_s if legs else 0.0, left_s)
        laid = lay_legs(country.chart, start, *(np.array([index]) for index in end))
        legs.append(
            Leg(start, end, now_s, float(fly(country, laid, now_s, airspeed_mps)[0, -1]), airspeed_mps)
        )
    return legs


def thrifty(country, legs):
    return with_thrifty_speeds(country, legs, FLOW, slowest_mps=22.0, fastest_mps=38.0, wait_min_s=120.0)


def test_each_leg_has_its_best_airspeed_in_its_wind():
    east_mps = np.where(np.arange(30) < 15, -14.0, 14.0)
    country = country_of(east_mps)
    against, with_it = thrifty(country, flown(country, [(1, 0), (1, 14), (1, 29)], [0.0, 0.0]))
    tried = np.linspace(22.0, 38.0, 12)
    best = tried[np.argmin(FLOW.at(tried) / (tried - 14.0))]
    assert against.airspeed_mps == pytest.approx(best)
    assert against.airspeed_mps > with_it.airspeed_mps == 22.0
    assert with_it.leave_s == against.arrive_s


def test_who_has_to_wait_comes_slowly_and_loiters_less():
    country = country_of(np.zeros(30), closed_until=1)
    legs = flown(country, [(1, 0), (1, 14), (1, 29)], [0.0, 3600.0])
    first, second = thrifty(country, legs)
    assert first.airspeed_mps == 22.0
    assert legs[0].arrive_s < first.arrive_s < second.leave_s == 3600.0
    near = flown(country, [(1, 0), (1, 14), (1, 29)], [1400.0, 3600.0], 22.5)
    slow, after = thrifty(country, near)
    assert slow.leave_s == 1400.0
    assert after.leave_s - slow.arrive_s == pytest.approx(0.0, abs=0.02) or (
        after.leave_s - slow.arrive_s >= 120.0 - 1e-6
    )


def test_no_legs_stay_no_legs():
    assert thrifty(country_of(np.zeros(30)), []) == []
