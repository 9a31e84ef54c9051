"""The aircraft of the oblique view: a body that light and eyes can make sense of."""

from collections import Counter

import numpy as np
import pytest

from recordings.aircraft_mesh import aircraft_mesh


@pytest.fixture(scope="module")
def mesh():
    return aircraft_mesh()


def test_its_span_is_one_and_it_is_longer_before_than_high(mesh):
    low, high = mesh.corners.reshape(-1, 3).min(axis=0), mesh.corners.reshape(-1, 3).max(axis=0)
    forward, left, up = high - low
    assert left == pytest.approx(1.0)
    assert 0.5 < forward < 1.0
    assert 0.1 < up < 0.3
    assert np.all(low < 0.0)
    assert np.all(high > 0.0)
    assert 50 < len(mesh.corners) < 200


def test_it_is_closed_each_edge_is_gone_along_as_often_one_way_as_the_other(mesh):
    points = [[tuple(corner) for corner in triangle] for triangle in np.round(mesh.corners, 9) + 0.0]
    ways = Counter((triangle[i], triangle[(i + 1) % 3]) for triangle in points for i in range(3))
    assert len(ways) > 300
    assert all(ways[begin, end] == ways[end, begin] for begin, end in ways)


def test_no_triangle_is_flat_and_normals_point_outward(mesh):
    first, second, third = mesh.corners.transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(second - first, third - first), axis=1) / 2.0
    assert areas.min() > 1e-6
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0)
    pod = mesh.corners[:10]
    outward = pod.mean(axis=1) - [pod[..., 0].mean(), 0.0, -0.02]
    assert np.all(np.einsum("ij,ij->i", outward, mesh.normals[:10]) > 0.0)


def test_left_and_right_are_alike_but_for_the_colours_of_the_tips(mesh):
    corners = {tuple(corner) for corner in np.round(mesh.corners.reshape(-1, 3), 9)}
    assert corners == {(forward, -left + 0.0, up) for forward, left, up in corners}
    red, green = (
        mesh.corners[np.all(mesh.colours == colour, axis=1)] for colour in ((235, 70, 60), (60, 200, 110))
    )
    assert red[..., 1].min() > 0.4
    assert green[..., 1].max() < -0.4
