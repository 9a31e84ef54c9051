import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from recordings.oblique_eye import nearest_eye

ASPECT = 4.4


def on_screen(eye, points_km):
    """Where points are seen, -1 to 1 from edge to edge, by the matrices that OpenGL uses."""
    forward = (eye.target_km - eye.position_km) / np.linalg.norm(eye.target_km - eye.position_km)
    side = np.cross(forward, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side)
    view = np.eye(4)
    view[:3, :3] = side, np.cross(side, forward), -forward
    shift = np.eye(4)
    shift[:3, 3] = -eye.position_km
    near, far, cotangent = 1e-3, 1e6, 1.0 / math.tan(math.radians(55.0) / 2.0)
    project = np.zeros((4, 4))
    project[0, 0], project[1, 1] = cotangent / ASPECT, cotangent
    project[2, 2:] = (far + near) / (near - far), 2.0 * far * near / (near - far)
    project[3, 2] = -1.0
    clip = project @ view @ shift @ np.column_stack([points_km, np.ones(len(points_km))]).T
    assert np.all(clip[3] > 0.0)  # before the eye
    return clip[:2] / clip[3]


@given(across_km=st.floats(0.0, 3000.0), deep_km=st.floats(0.0, 3000.0), high_km=st.floats(0.0, 200.0))
@settings(max_examples=25, deadline=None)
def test_it_sees_all_of_a_route_from_above_in_the_south_and_no_more_than_it_must(across_km, deep_km, high_km):
    box = np.array(np.meshgrid([0.0, across_km], [0.0, deep_km], [0.0, high_km])).reshape(3, -1).T
    middle = np.array([across_km, deep_km, high_km]) / 2.0
    eye = nearest_eye(box, 10.0)
    assert eye.position_km[1] < middle[1]
    assert eye.position_km[2] > middle[2]
    right, up = on_screen(eye, box)
    filled = max(abs(right).max() / 0.85, up.max() / 0.85, -up.min() / 0.68)  # labels hang under places
    assert filled <= 1.0 + 1e-6
    assert filled > 0.9 or eye.distance_km == pytest.approx(10.0, rel=0.01)


def test_a_larger_route_is_seen_from_farther_and_a_small_one_from_the_least_distance():
    distances_km = [
        nearest_eye(np.array([[-size_km, 0.0, 0.0], [size_km, 0.0, 0.0]]), 50.0).distance_km
        for size_km in (1.0, 200.0, 400.0)
    ]
    assert distances_km[0] == pytest.approx(50.0, rel=0.01)
    assert distances_km[2] == pytest.approx(2.0 * distances_km[1], rel=0.06)
