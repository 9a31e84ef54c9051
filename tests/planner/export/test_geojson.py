"""GeoJSON, judged by the models of geojson-pydantic."""

import datetime
import json
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.export.geojson import to_geojson

geojson_pydantic = pytest.importorskip("geojson_pydantic", reason="the reader geojson-pydantic is missing")


def read(plan):
    """The features, once the validator has taken the file, by role."""
    text = to_geojson(plan)
    geojson_pydantic.FeatureCollection.model_validate_json(text)
    by_role = {}
    for feature in json.loads(text)["features"]:
        by_role.setdefault(feature["properties"]["role"], []).append(feature)
    return by_role


def parts_of(route):
    """Lists of (longitude, latitude, altitude, Unix seconds)."""
    lines, times = route["geometry"]["coordinates"], route["properties"]["coordTimes"]
    if route["geometry"]["type"] == "LineString":
        lines, times = [lines], [times]
    return [
        [
            (*position, datetime.datetime.fromisoformat(time).timestamp())
            for position, time in zip(line, moments, strict=True)
        ]
        for line, moments in zip(lines, times, strict=True)
    ]


@settings(deadline=None)
@given(data=st.data())
def test_positions_times_and_waits_come_back(journeys, data):
    plan, visits = data.draw(journeys)
    by_role = read(plan)
    (route,) = by_role["route"]
    found = iter(fix for part in parts_of(route) for fix in part)
    for visit in visits:
        for time_s in visit.times_s:
            fix = next(found)
            while abs(fix[0]) == 180.0 and visit.lon_deg != -180.0:
                fix = next(found)  # a point that the antimeridian added
            assert (fix[0] - visit.lon_deg) % 360.0 == pytest.approx(0.0, abs=1e-8)
            assert fix[1:] == pytest.approx((visit.lat_deg, visit.altitude_m, plan.departure_s + time_s))
    waits = [visit.leave_s - visit.arrive_s for visit in visits if len(visit.times_s) == 2]
    assert [loiter["properties"]["waiting_s"] for loiter in by_role.get("loiter", [])] == pytest.approx(waits)


@settings(deadline=None)
@given(data=st.data())
def test_no_part_crosses_the_antimeridian(journeys, data):
    plan, _ = data.draw(journeys)
    parts = parts_of(read(plan)["route"][0])
    for part in parts:
        assert len(part) >= 2
        assert all(-180.0 <= fix[0] <= 180.0 for fix in part)
        assert all(abs(after[0] - before[0]) <= 180.0 for before, after in pairwise(part))
        assert all(before[3] <= after[3] for before, after in pairwise(part))
    for before, after in pairwise(parts):
        assert before[-1][0] == -after[0][0]
        assert abs(before[-1][0]) == 180.0
        assert before[-1][1:] == after[0][1:]


def test_a_cut_lies_on_the_straight_line_between_its_neighbours(make_plan):
    plan = make_plan([(10.0, 179.0, 1000.0, 0.0, 0.0), (14.0, -178.0, 1400.0, 300.0, 300.0)], departure_s=0.0)
    (route,) = read(plan)["route"]
    assert route["geometry"] == {
        "type": "MultiLineString",
        "coordinates": [
            [[179.0, 10.0, 1000.0], [180.0, 11.333333333, 1133.333]],
            [[-180.0, 11.333333333, 1133.333], [-178.0, 14.0, 1400.0]],
        ],
    }
    assert route["properties"]["coordTimes"] == [
        ["1970-01-01T00:00:00Z", "1970-01-01T00:01:40Z"],
        ["1970-01-01T00:01:40Z", "1970-01-01T00:05:00Z"],
    ]


@pytest.mark.parametrize(
    ("longitudes", "expected"),
    [
        ([179.0, 180.0], [[179.0, 180.0]]),
        ([179.0, 180.0, 179.0], [[179.0, 180.0, 179.0]]),
        ([179.0, 180.0, -179.0], [[179.0, 180.0], [-180.0, -179.0]]),
        ([180.0, 179.0], [[180.0, 179.0]]),
        ([180.0, -179.0], [[-180.0, -179.0]]),
        ([-179.0, 179.0, -179.0], [[-179.0, -180.0], [180.0, 179.0, 180.0], [-180.0, -179.0]]),
        ([0.0, 100.0, -100.0], [[0.0, 100.0, 180.0], [-180.0, -100.0]]),
    ],
)
def test_routes_on_and_over_the_antimeridian(make_plan, longitudes, expected):
    plan = make_plan([(0.0, lon_deg, 0.0, at, at) for at, lon_deg in enumerate(longitudes)])
    parts = parts_of(read(plan)["route"][0])
    assert [[fix[0] for fix in part] for part in parts] == expected


def test_start_loiter_and_goals_are_points(short_plan):
    by_role = read(short_plan)
    (start,), (loiter,) = by_role["start"], by_role["loiter"]
    assert start["geometry"] == {"type": "Point", "coordinates": [-84.0, 24.0, 1000.0]}
    assert start["properties"]["time"] == "2022-09-28T00:00:00Z"
    assert loiter["properties"] == {
        "role": "loiter",
        "from": "2022-09-28T00:03:00Z",
        "until": "2022-09-28T00:13:00.500Z",
        "waiting_s": 600.5,
    }
    reached, missed = by_role["goal"]
    assert reached["geometry"]["coordinates"] == [-83.97, 24.06]
    assert reached["properties"]["chosen"]
    assert reached["properties"]["arrival_s"] == 960.0
    assert missed["properties"]["reason"] == "no safe way"
    assert missed["properties"]["arrival_s"] is None


def test_a_route_of_one_waypoint_is_still_a_line(make_plan):
    (route,) = read(make_plan([(1.0, 2.0, 3.0, 0.0, 0.0)]))["route"]
    assert route["geometry"] == {"type": "LineString", "coordinates": [[2.0, 1.0, 3.0]] * 2}
