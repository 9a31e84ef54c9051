"""What is drawn once: the plan, the places and the flyable curve."""

from dataclasses import replace

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from recordings.rerun_chart import Chart
from recordings.rerun_labels import HEIGHT_PX, width_px
from recordings.rerun_scene import Scene, curve, south


@pytest.fixture
def header(workshop):
    return workshop.header(workshop.corners)


def drawn(header, path):
    """Entity to its components, by name."""
    stream = rr.RecordingStream("test", recording_id="scene", send_properties=False)
    stream.save(path)
    scene = Scene(header, Chart(header.grid))
    scene.draw(stream)
    for entity, archetype in scene.route(header.plan):
        stream.log(entity, archetype)
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
    scene = Scene(header, Chart(header.grid))
    heights_km = np.full(len(raised), scene.heights_by - 1.5 * scene.chart.px_km)  # 1000 m, under the flight
    np.testing.assert_allclose(raised, np.column_stack([east_km, north_km, heights_km]), atol=1e-4)


def test_each_place_is_named_and_one_without_a_route_is_marked(header, tmp_path):
    components = drawn(header, tmp_path / "scene.rrd")
    assert components["/chart/places/names", "labels"] == ["start", "goal: Port", "× Isle"]
    assert components["/scene/places", "labels"] == ["start", "goal: Port"]
    assert len(set(components["/chart/places", "colors"])) == 3


def test_the_legend_names_the_threshold_and_the_length_of_its_bar(header, tmp_path):
    components = drawn(replace(header, threshold_mps=12.5, also=()), tmp_path / "scene.rrd")
    names = components["/chart/legend/names", "labels"]
    assert {"plan", "reference", "flown", "× no route", "12.5 m/s, true", "12.5 m/s, forecast"} <= set(names)
    (begin, end) = components["/chart/legend", "strips"][-1]
    assert names[-1] == f"{end[0] - begin[0]:g} km"


def test_where_more_than_wind_is_hazard_its_outline_is_not_called_the_threshold(header, tmp_path):
    components = drawn(replace(header, also=("gusts over 20 m/s",)), tmp_path / "scene.rrd")
    names = set(components["/chart/legend/names", "labels"])
    assert {"hazard, true", "hazard, forecast"} <= names
    assert not any("m/s, true" in name for name in names)


def test_where_all_places_can_be_reached_the_legend_has_no_sign_for_others(header, tmp_path):
    plan = replace(header.plan, goals=header.plan.goals[:1])
    components = drawn(replace(header, plan=plan), tmp_path / "scene.rrd")
    assert "× no route" not in components["/chart/legend/names", "labels"]


@pytest.mark.parametrize(
    ("entity", "edges"),
    [
        ("chart/legend/scale", ["43", "33", "25", "18", "15", "10", "5", "0"]),
        ("chart/weather/difference/scale", ["+5", "+2", "+1", "+0.1", "-0.1", "-1", "-2", "-5"]),
    ],
)
def test_the_scales_of_colours_have_a_number_at_each_edge(header, tmp_path, entity, edges):
    components = drawn(replace(header, threshold_mps=18.0), tmp_path / "scene.rrd")
    title, *numbers = components[f"/{entity}_names", "labels"]
    assert "m/s" in title
    assert numbers == edges
    (picture,) = components[f"/{entity}", "buffer"]
    assert len(picture) == 3 * len(edges) + 3 * ("difference" in entity)


def test_no_label_of_the_chart_hides_another(header, tmp_path):
    components, chart = drawn(header, tmp_path / "scene.rrd"), Chart(header.grid)
    boxes = []
    for (entity, name), texts in components.items():
        if name == "labels" and entity.startswith("/chart") and "difference" not in entity:
            for text, place in zip(texts, components[entity, "positions"], strict=True):
                boxes.append((np.array(place) / chart.px_km, np.array([width_px(text), HEIGHT_PX]), text))
    for i, (place, size, text) in enumerate(boxes):
        for other, other_size, other_text in boxes[:i]:
            apart = abs(place - other) >= 0.9 * (size + other_size) / 2.0  # widths are estimates
            assert apart.any(), (text, other_text)


def test_the_aircraft_has_a_glyph_on_the_chart_and_a_lit_body_in_the_oblique_view(header, tmp_path):
    components = drawn(header, tmp_path / "scene.rrd")
    _, wing, _ = components["/chart/aircraft/glyph", "strips"]
    assert wing[0][0] == -wing[-1][0] != 0.0
    corners = np.array(components["/scene/aircraft/mesh", "vertex_positions"])
    normals = np.array(components["/scene/aircraft/mesh", "vertex_normals"])
    span_km = corners[:, 1].max() - corners[:, 1].min()
    assert span_km == pytest.approx(0.3 * Scene(header, Chart(header.grid)).eye.distance_km, rel=1e-4)
    assert corners.shape == normals.shape
    assert len(corners) % 3 == 0
    assert len(components["/scene/aircraft/mesh", "vertex_colors"]) == len(corners)


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
