from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aircraft.timing import Stretch, times_at_one_airspeed

stretches = st.lists(
    st.builds(
        Stretch,
        st.just(0.0),
        st.just(0.0),
        st.floats(-math.pi, math.pi),
        st.floats(1.0, 700.0),
    ),
    min_size=1,
    max_size=12,
)


@given(stretches, st.floats(0.0, 80.0), st.floats(-math.pi, math.pi), st.floats(10.0, 45.0))
@settings(derandomize=True, deadline=None, max_examples=200)
def test_times_rise_to_the_end_in_any_wind(
    parts: list[Stretch], wind_mps: float, toward_rad: float, speed_mps: float
) -> None:
    whole_s = sum(part.length_m for part in parts) / speed_mps
    wind = wind_mps * math.cos(toward_rad), wind_mps * math.sin(toward_rad)
    times_s = times_at_one_airspeed(parts, 100.0, 100.0 + whole_s, lambda *_: wind)
    assert times_s[-1] == 100.0 + whole_s
    assert (np.diff(np.append(100.0, times_s)) > 0.0).all()


def test_up_and_down_wind_takes_the_times_of_the_wind_triangle() -> None:
    parts = [Stretch(0.0, 0.0, 0.0, 600.0), Stretch(600.0, 0.0, math.pi / 2.0, 600.0)]
    wind = (-12.0, 0.0)  # at an airspeed of 28 m/s
    expected_s = [600.0 / 16.0, 600.0 / math.sqrt(28.0**2 - 12.0**2)]
    times_s = times_at_one_airspeed(parts, 0.0, sum(expected_s), lambda *_: wind)
    assert times_s == pytest.approx(np.cumsum(expected_s), rel=1e-6)


def test_without_wind_the_time_is_spread_evenly() -> None:
    parts = [Stretch(0.0, 0.0, 0.0, 100.0), Stretch(0.0, 0.0, 1.0, 300.0)]
    assert times_at_one_airspeed(parts, 5.0, 13.0, None).tolist() == [7.0, 13.0]
