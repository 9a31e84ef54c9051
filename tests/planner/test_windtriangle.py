"""Ground speed from airspeed, wind and course; edges in wind that changes: first in, first out."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.windtriangle import arrival_times, ground_speed

TIME_S = np.array([0.0, 300.0, 360.0, 1500.0])
SPEEDS = st.lists(st.floats(4.0, 60.0), min_size=4, max_size=4)


def arrivals(depart_s, length_m, speeds):
    """Arrivals of departures, in any span, on one edge with these speeds at `TIME_S`."""
    result = np.empty(len(depart_s))
    for at, depart in enumerate(depart_s):
        span = min(int(np.searchsorted(TIME_S, depart, side="right")) - 1, 2)
        result[at] = arrival_times(
            np.array([depart]),
            np.array([length_m]),
            TIME_S,
            span,
            lambda place, which: np.full(which.shape, speeds[place]),
        )[0]
    return result


@given(
    airspeed_mps=st.floats(16.0, 50.0),
    wind=st.complex_numbers(max_magnitude=15.0, allow_nan=False),
    course_rad=st.floats(-math.pi, math.pi),
)
def test_the_velocity_through_the_air_has_the_airspeed(airspeed_mps, wind, course_rad):
    course = cmath.rect(1.0, course_rad)
    turned = wind * course.conjugate()
    speed_mps = ground_speed(turned.real, turned.imag, airspeed_mps)
    assert abs(speed_mps * course - wind) == pytest.approx(airspeed_mps)
    assert speed_mps > 0.0


def test_head_tail_and_cross_wind():
    assert ground_speed(10.0, 0.0, 25.0) == 35.0
    assert ground_speed(-10.0, 0.0, 25.0) == 15.0
    assert ground_speed(0.0, 15.0, 25.0) == 20.0


@given(depart_s=st.floats(0.0, 1499.0), length_m=st.floats(1.0, 50_000.0), speeds=SPEEDS)
def test_an_edge_takes_as_long_as_its_integral(depart_s, length_m, speeds):
    arrive_s = arrivals([depart_s], length_m, speeds)[0]
    end_s = min(arrive_s, TIME_S[-1])
    fine_s = np.union1d(np.linspace(depart_s, end_s, 5001), TIME_S[(depart_s < TIME_S) & (end_s > TIME_S)])
    covered_m = np.trapezoid(np.interp(fine_s, TIME_S, speeds), fine_s)
    if math.isfinite(arrive_s):
        assert covered_m == pytest.approx(length_m, rel=1e-9, abs=1e-6)
    else:
        assert covered_m < length_m * (1.0 + 1e-9)


@given(
    departs=st.lists(st.floats(0.0, 1499.0), min_size=2, max_size=2),
    length_m=st.floats(1.0, 20_000.0),
    speeds=SPEEDS,
)
def test_who_leaves_first_arrives_first(departs, length_m, speeds):
    first, second = arrivals(sorted(departs), length_m, speeds)
    assert first <= second or first == pytest.approx(second, abs=1e-9)
    assert first > min(departs)


def test_many_edges_at_once_are_each_alone():
    speeds = np.array([[10.0, 20.0, 30.0, 40.0], [50.0, 8.0, 8.0, 9.0], [5.0, 5.0, 5.0, 5.0]]).T
    depart_s, length_m = np.array([10.0, 290.0, 0.0]), np.array([3000.0, 2000.0, 90_000.0])
    together = arrival_times(depart_s, length_m, TIME_S, 0, lambda place, which: speeds[place, which])
    alone = [
        arrivals([depart], length, speeds[:, at])[0]
        for at, (depart, length) in enumerate(zip(depart_s, length_m, strict=True))
    ]
    np.testing.assert_array_equal(together, alone)
    assert math.isinf(together[2])
