"""The suffix chooses the format, what cannot be exported is refused, and files come whole or not at all."""

import dataclasses

import pytest

from planner.errors import BadPlanError, PlannerError
from planner.export import FORMATS, export
from planner.plans import GoalOutcome, Plan

every_format = pytest.mark.parametrize("suffix", FORMATS)
STARTS = {".geojson": b"{", ".kml": b"<?xml", ".gpx": b"<?xml", ".plan": b"{", ".waypoints": b"QGC WPL 110"}


@every_format
def test_the_suffix_chooses_the_format(tmp_path, short_plan, suffix):
    export(short_plan, tmp_path / f"a.b{suffix.upper()}")
    written = (tmp_path / f"a.b{suffix.upper()}").read_bytes()
    assert written == FORMATS[suffix](short_plan)
    assert written.startswith(STARTS[suffix])
    assert [path.name for path in tmp_path.iterdir()] == [f"a.b{suffix.upper()}"]


@pytest.mark.parametrize("name", ["route.txt", "route", ".kml", "route.kmz"])
def test_other_suffixes_are_refused(tmp_path, short_plan, name):
    with pytest.raises(PlannerError, match=r"\.geojson, \.kml, \.gpx, \.plan, \.waypoints"):
        export(short_plan, tmp_path / name)
    assert not list(tmp_path.iterdir())


@every_format
def test_a_plan_without_a_route_is_refused_and_the_old_file_stays(tmp_path, suffix):
    goal = GoalOutcome("Tampa", 27.9, -82.5, False, "the goal is in hazard in every stage")
    path = tmp_path / f"route{suffix}"
    path.write_text("old")
    with pytest.raises(BadPlanError, match="no route to Tampa to export: the goal is in hazard"):
        export(Plan("staged", "score", 0.0, "Tampa", (), (goal,)), path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_that_cannot_be_written_is_named(tmp_path, short_plan):
    (tmp_path / "folder.kml").mkdir()
    (tmp_path / "file").touch()
    for path in (tmp_path / "missing/route.kml", tmp_path / "folder.kml", tmp_path / "file/route.kml"):
        with pytest.raises(PlannerError, match=f"cannot write the route to {path}"):
            export(short_plan, path)
    assert {path.name for path in tmp_path.iterdir()} == {"folder.kml", "file"}


BAD = [
    ([(91.0, 0.0, 0.0, 0.0, 0.0)], "waypoint 0 lies at latitude 91"),
    ([(0.0, float("nan"), 0.0, 0.0, 0.0)], "longitude nan"),
    ([(0.0, 0.0, float("inf"), 0.0, 0.0)], "altitude of waypoint 0 is inf"),
    ([(0.0, 0.0, 0.0, float("nan"), 0.0)], "time of waypoint 0 is nan"),
    ([(0.0, 0.0, 0.0, 9.0, 9.0), (0.0, 1.0, 0.0, 8.0, 8.0)], "waypoint 1 comes at 8.0 s"),
    ([(0.0, 0.0, 0.0, 9.0, 9.0), (0.0, 0.0, 0.0, 8.0, 8.0)], "waypoint 1 comes at 8.0 s"),
    ([(0.0, 0.0, 0.0, 9.0, 9.0), (0.0, 1.0, 0.0, 9.0, 9.0)], "times that rise"),
    ([(0.0, 0.0, 0.0, 9.0, 9.0), (0.0, 1.0, 0.0, 9.0001, 9.0001)], "by a millisecond"),
]


@every_format
@pytest.mark.parametrize(("visits", "message"), BAD)
def test_routes_that_no_vehicle_could_follow_are_refused(make_plan, visits, message, suffix):
    with pytest.raises(BadPlanError, match=message):
        FORMATS[suffix](make_plan(visits))


@pytest.mark.parametrize("suffix", [".geojson", ".kml", ".gpx"])
@pytest.mark.parametrize("departure_s", [float("nan"), float("inf"), -1e12, 1e300])
def test_departures_that_are_no_date_are_refused(short_plan, suffix, departure_s):
    with pytest.raises(BadPlanError, match="is not a date"):
        FORMATS[suffix](dataclasses.replace(short_plan, departure_s=departure_s))


@pytest.mark.parametrize("suffix", [".geojson", ".kml", ".gpx"])
def test_goals_off_the_earth_are_refused(short_plan, suffix):
    goals = (GoalOutcome("Nowhere", float("nan"), 0.0, False),)
    with pytest.raises(BadPlanError, match="the goal Nowhere lies at latitude nan"):
        FORMATS[suffix](dataclasses.replace(short_plan, goals=goals))


@every_format
def test_a_wait_told_in_three_waypoints_or_more_is_one_wait(make_plan, suffix):
    told = [(9.0, 9.0, 0.0, 0.0, 0.0), (8.0, 9.0, 0.0, 10.0, 20.0), (8.0, 9.0, 0.0, 30.0, 40.0)]
    assert FORMATS[suffix](make_plan(told)) == FORMATS[suffix](
        make_plan([(9.0, 9.0, 0.0, 0.0, 0.0), (8.0, 9.0, 0.0, 10.0, 40.0)])
    )


@every_format
def test_longitudes_off_by_turns_are_the_same_place(make_plan, suffix):
    one, other = (
        FORMATS[suffix](make_plan([(1.0, 170.0 + turn, 0.0, 0.0, 0.0), (1.0, 190.0 + turn, 0.0, 9.0, 9.0)]))
        for turn in (0.0, -720.0)
    )
    assert one == other
