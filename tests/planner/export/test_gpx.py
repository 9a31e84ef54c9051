"""GPX, read by gpxpy."""

import dataclasses

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.export.gpx import to_gpx
from planner.plans import GoalOutcome

gpxpy = pytest.importorskip("gpxpy", reason="the reader gpxpy is missing")


@settings(deadline=None)
@given(data=st.data())
def test_positions_times_and_waits_come_back(journeys, data):
    plan, visits = data.draw(journeys)
    read = gpxpy.parse(to_gpx(plan), version="1.1")
    (route,) = read.routes
    found = [
        (point.latitude, point.longitude, point.elevation, point.time.timestamp()) for point in route.points
    ]
    assert found == [
        pytest.approx((*visit[:3], plan.departure_s + time_s), rel=1e-15, abs=1e-9)
        for visit in visits
        for time_s in visit.times_s
    ]
    assert all(-180.0 <= point.longitude < 180.0 for point in route.points)


def test_goals_are_waypoints_with_what_became_of_them(short_plan):
    read = gpxpy.parse(to_gpx(short_plan))
    assert [(place.name, place.description) for place in read.waypoints] == [
        ("Tampa", "reached 2022-09-28T00:16:00Z"),
        ("Ponce & <co>", "no route: no safe way"),
    ]
    assert [point.description for point in read.routes[0].points] == [
        None,
        "loiter for 600 s",
        "loiter for 600 s",
        None,
    ]


@pytest.mark.parametrize("lon_deg", [180.0, -180.0, 540.0, 179.9999999999])
def test_the_antimeridian_is_at_minus_180_as_the_schema_asks(make_plan, lon_deg):
    (point,) = gpxpy.parse(to_gpx(make_plan([(0.0, lon_deg, 0.0, 0.0, 0.0)]))).routes[0].points
    assert point.longitude == -180.0


@settings(deadline=None)
@given(name=st.text(st.characters(codec="utf-8"), min_size=1))
def test_any_name_gives_a_file_that_can_be_read(short_plan, name):
    goals = (GoalOutcome(name, 0.0, 0.0, False, name),)
    read = gpxpy.parse(to_gpx(dataclasses.replace(short_plan, goal=name, goals=goals)))
    legal = "".join(c if c in "\t\n" or (c >= " " and c not in "\ufffe\uffff") else "\ufffd" for c in name)
    if "\r" not in name and name.strip() == name:
        assert read.waypoints[0].name == legal
