"""Waits become loiters that are long enough, or slower legs."""

import math
from itertools import pairwise

import numpy as np
import pytest

from planner.air import Air, Chart
from planner.grid import Grid
from planner.intervals import SafeIntervals
from planner.legs import Country, are_safe, fly, lay_legs
from planner.waits import with_flyable_waits
from planner.way import Leg

STAGE_S = 600.0
STEP_RAD = 3600.0 / 6_371_000.0
GRID = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, 5, 16)
SLOWEST_MPS, CRUISE_MPS = 22.0, 27.0


def country_of(paint=lambda _: None):
    hazard = np.zeros((5, *GRID.shape), dtype=bool)
    paint(hazard)
    still = np.zeros((6, *GRID.shape), dtype=np.complex64)
    return Country(Chart.of(GRID), Air(np.arange(6) * STAGE_S, still), SafeIntervals.of(hazard), STAGE_S)


def eastward(country, *stops):
    """Legs along row 2 between columns, each with the time at which it is left (or None: at once)."""
    legs, now_s = [], 0.0
    for (first, leave_s), (last, _) in pairwise(stops):
        now_s = now_s if leave_s is None else leave_s
        laid = lay_legs(country.chart, (2, first), np.array([2]), np.array([last]))
        arrive_s = float(fly(country, laid, now_s, CRUISE_MPS)[0, -1])
        legs.append(Leg((2, first), (2, last), now_s, arrive_s, CRUISE_MPS))
        now_s = arrive_s
    return legs


def flyable(country, legs):
    return with_flyable_waits(country, legs, slowest_mps=SLOWEST_MPS, wait_min_s=120.0)


def waits(legs):
    return [after.leave_s - before.arrive_s for before, after in pairwise(legs)]


def test_legs_without_waits_and_long_waits_stay_as_they_are():
    country = country_of()
    for legs in (
        eastward(country, (0, None), (4, None), (7, None)),
        eastward(country, (0, None), (2, 600.0), (7, None)),
        [],
    ):
        assert flyable(country, legs) == legs


def test_a_short_wait_becomes_slower_legs():
    country = country_of()
    legs = eastward(country, (0, None), (2, None), (4, 550.0), (7, None))
    assert 0.0 < waits(legs)[1] < 120.0
    slower = flyable(country, legs)
    assert waits(slower) == [0.0, 0.0]
    assert slower[2].leave_s == pytest.approx(550.0, abs=0.02)
    assert slower[2].leave_s >= 550.0
    assert SLOWEST_MPS <= slower[0].airspeed_mps == slower[1].airspeed_mps < CRUISE_MPS
    assert slower[2].airspeed_mps == CRUISE_MPS


def test_a_wait_too_short_to_loiter_and_too_long_to_be_slow_is_lengthened():
    country = country_of()
    legs = eastward(country, (0, None), (2, 360.0), (7, None))
    assert 90.0 < waits(legs)[0] < 120.0
    longer = flyable(country, legs)
    assert waits(longer) == pytest.approx([120.0])
    assert longer[-1].arrive_s == pytest.approx(legs[-1].arrive_s + 120.0 - waits(legs)[0])


def test_slower_legs_begin_after_the_wait_before():
    country = country_of()
    legs = eastward(country, (0, None), (1, 500.0), (4, 930.0), (7, None))
    slower = flyable(country, legs)
    assert [leg.airspeed_mps for leg in (slower[0], slower[2])] == [CRUISE_MPS, CRUISE_MPS]
    assert slower[1].airspeed_mps < CRUISE_MPS
    assert slower[1].leave_s == 500.0


def test_being_later_must_be_safe_too():
    def closing(hazard):
        hazard[1:, 2, 5:8] = True

    country = country_of(closing)
    assert flyable(country, eastward(country, (0, None), (2, None), (3, None))) is not None
    legs = eastward(country, (4, 40.0), (8, None))  # through the door at 600 s: no time for a loiter of 120 s
    assert flyable(country, legs) is None


def test_a_wait_is_not_lengthened_into_hazard():
    def closing(hazard):
        hazard[1:, 2, 1] = True

    country = country_of(closing)
    legs = eastward(country, (0, None), (1, 200.0), (4, None))
    assert flyable(country, legs) is not None
    late = eastward(country, (0, 420.0), (1, 590.0), (4, None))
    assert flyable(country, late) is None


def test_slowed_legs_are_safe():
    def wall(hazard):
        hazard[0, :, 5] = True

    country = country_of(wall)
    legs = eastward(country, (0, None), (4, 600.0), (9, None))
    for leg in flyable(country, legs):
        laid = lay_legs(country.chart, leg.start, *(np.array([index]) for index in leg.end))
        assert are_safe(country, laid, fly(country, laid, leg.leave_s, leg.airspeed_mps))[0]
