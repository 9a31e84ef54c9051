"""What is drawn once: the plan, the places and the flyable curve."""

from dataclasses import replace

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from recordings.rerun_chart import Chart
from recordings.rerun_scene import Scene, curve, south


@pytest.fixture
def header(workshop):
    return workshop.header(workshop.corners)


def drawn(header, path):
    """Entity to its static components, by name."""
    stream = rr.RecordingStream("test", recording_id="scene", send_properties=False)
    stream.save(path)
    Scene(header, Chart(header.grid)).draw(stream)
    stream.flush()
    stream.disconnect()
    components = {}
    for chunk in RrdReader(path).stream():
        table = chunk.to_record_batch()
        for name in table.schema.names[1:]:
            components[chunk.entity_path, name.partition(":")[2]] = table.column(name).to_pylist()[-1]
    return components


def test_the_plan_is_drawn_through_its_waypoints_in_both_views(header, tmp_path):
    components = drawn(header, tmp_path / "scene.rrd")
    east_km, north_km = np.transpose(
        [Chart(header.grid).km(point.lat_deg, point.lon_deg) for point in header.plan.waypoints]
    )
    (flat,), (raised,) = components["/chart/plan", "strips"], components["/scene/plan", "strips"]
    np.testing.assert_allclose(flat, np.column_stack([east_km, -north_km]), atol=1e-4)
    heights_km = np.full(len(raised), Scene(header, Chart(header.grid)).heights_by)  # at 1000 m
    np.testing.assert_allclose(raised, np.column_stack([east_km, north_km, heights_km]), atol=1e-4)


def test_each_place_is_named_and_one_without_a_route_is_marked(header, tmp_path):
    components = drawn(header, tmp_path / "scene.rrd")
    assert components["/chart/places", "labels"] == ["goal: Port", "× Isle", "start"]
    assert components["/scene/places", "labels"] == ["goal: Port", "start"]
    assert len(set(components["/chart/places", "colors"])) == 3


def test_the_legend_names_the_threshold_and_the_length_of_its_bar(header, tmp_path):
    components = drawn(replace(header, threshold_mps=12.5), tmp_path / "scene.rrd")
    names = components["/chart/legend/names", "labels"]
    assert "wind over 12.5 m/s" in names
    (begin, end) = components["/chart/legend", "strips"][-1]
    assert names[-1] == f"{end[0] - begin[0]:g} km"


def test_the_drawn_curve_is_the_reference(header):
    reference = header.reference
    line_m = 1000.0 * curve(reference)
    exact = reference.at_many(np.arange(0.0, reference.end_m, 5.0))
    for east_m, north_m in zip(exact.east_m, exact.north_m, strict=True):
        assert distance_m(np.array([east_m, north_m]), line_m) < 0.5
    assert len(line_m) < len(exact.east_m) / 10


def distance_m(point, line):
    """From a point to the nearest of a line's pieces."""
    begin, step = line[:-1], np.diff(line, axis=0)
    share = np.einsum("ij,ij->i", point - begin, step) / np.maximum(np.einsum("ij,ij->i", step, step), 1e-9)
    nearest = begin + np.clip(share, 0.0, 1.0)[:, None] * step
    return np.hypot(*(point - nearest).T).min()


@pytest.mark.parametrize(("altitude_m", "heights_by"), [(1000.0, 20.0), (5000.0, 4.0), (0.0, 200.0)])
def test_heights_are_exaggerated_by_a_round_number_that_fits_the_flight(header, altitude_m, heights_by):
    waypoints = tuple(replace(point, altitude_m=altitude_m) for point in header.plan.waypoints)
    raised = replace(header, plan=replace(header.plan, waypoints=waypoints))
    assert Scene(raised, Chart(raised.grid)).heights_by == heights_by


def test_south_is_down():
    np.testing.assert_array_equal(south(np.array([[3.0, 4.0]])), [[3.0, -4.0]])
