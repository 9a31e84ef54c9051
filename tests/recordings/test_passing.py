"""Passing times against a walk through the samples."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recordings.passing import PASSED_M, passing_times_s


def walked(waypoint_m, times_s, paths_m):
    """The first moment at which progress, a polygon over time, is at or beyond a waypoint."""
    if paths_m[0] >= waypoint_m:
        return times_s[0]
    for i in range(1, len(paths_m)):
        if paths_m[i] >= waypoint_m:
            share = (waypoint_m - paths_m[i - 1]) / (paths_m[i] - paths_m[i - 1])
            return times_s[i - 1] + share * (times_s[i] - times_s[i - 1])
    return math.nan


@given(
    steps_m=st.lists(st.floats(0.0, 40.0), min_size=1, max_size=30),
    waypoints_m=st.lists(st.floats(-10.0, 500.0), min_size=1, max_size=5),
)
def test_progress_that_never_falls_back(steps_m, waypoints_m):
    paths_m = np.cumsum(steps_m)
    times_s = 0.5 * np.arange(len(paths_m))
    found = passing_times_s(np.array(waypoints_m), times_s, paths_m)
    for waypoint_m, time_s in zip(waypoints_m, found, strict=True):
        if not paths_m[-1] < waypoint_m <= paths_m[-1] + PASSED_M:
            assert time_s == pytest.approx(walked(waypoint_m, times_s, paths_m), nan_ok=True)


def test_progress_that_falls_back_counts_from_the_farthest_so_far():
    paths_m = np.array([0.0, 10.0, 20.0, 12.0, 8.0, 21.0, 40.0])
    found = passing_times_s(np.array([15.0, 20.0, 20.5, 30.0]), np.arange(7.0), paths_m)
    assert found == pytest.approx([1.5, 2.0, 4.5, 5.0 + 9.0 / 19.0])


def test_what_is_a_hand_ahead_of_the_end_was_passed_there():
    paths_m, times_s = np.array([0.0, 10.0, 20.0, 20.0]), np.arange(4.0)
    found = passing_times_s(np.array([20.0 + PASSED_M, 20.01 + PASSED_M]), times_s, paths_m)
    assert found == pytest.approx([2.0, math.nan], nan_ok=True)


def test_one_sample():
    found = passing_times_s(np.array([-1.0, 0.0, 5.0]), np.array([3.0]), np.array([0.0]))
    assert found == pytest.approx([3.0, 3.0, math.nan], nan_ok=True)
