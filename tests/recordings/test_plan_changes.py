"""Recordings of flights whose plan changed: every plan with its time, waypoints by the plan valid then."""

from dataclasses import fields, replace

import numpy as np
import pytest
from mcap.reader import make_reader
from rerun.chunk import RrdReader

import recordings
from planner.plans import Plan
from recordings.errors import BadRecordingError
from recordings.recorder import Outcome, PlanIssue
from recordings.rerun_writer import RerunRecorder
from recordings.schema import PLAN, PLAN_ISSUE, PLAN_PATH
from recordings.tracking import track

OTHER = ((0.0, 0.0), (0.0, 3600.0), (0.0, 7200.0), (-3600.0, 7200.0))
REPLAN_S = 40.0


@pytest.fixture
def replanned(workshop):
    """The turn at the second waypoint is not made; the old plan had five waypoints, this one has four."""
    flight = workshop.fly_and_replan(workshop.header(workshop.corners), OTHER, REPLAN_S)
    unchanged = PlanIssue(200.0, "forecast of 00:02 UTC, stage 2: unchanged", flight.plans[0].plan, False)
    return replace(flight, plans=(*flight.plans, unchanged))


def test_every_plan_is_read_back_with_time_and_reason(workshop, replanned):
    recording = workshop.recording(replanned)
    first, second, third = recording.plans
    assert first == (-30.0, "before take-off", replanned.header.plan, True)
    assert second == replanned.plans[0]
    assert third == replanned.plans[1]
    assert recording.plan == second.plan != recording.header.plan
    assert recording.first_waypoints == (0, 1)


def test_the_rerun_file_tells_the_same(workshop, replanned):
    path = workshop.folder / "flight.rrd"
    replanned.record(RerunRecorder(path))
    other = recordings.open(path)
    assert other.plans == workshop.recording(replanned).plans
    assert track(other).to_json() == track(workshop.recording(replanned)).to_json()


def test_the_lane_of_stages_has_a_colour_for_each_of_a_longer_plan(workshop, replanned):
    (first, _), path = replanned.plans, workshop.folder / "flight.rrd"
    *others, last = first.plan.waypoints
    plan = replace(first.plan, waypoints=(*others, replace(last, stage=17)))
    longer = first._replace(plan=plan)
    replace(replanned, plans=(longer,)).record(RerunRecorder(path))
    lanes = [
        chunk.to_record_batch()
        for chunk in RrdReader(path).stream()
        if chunk.entity_path == "/lanes/stage" and chunk.is_static
    ]
    (name,) = [name for name in lanes[-1].schema.names if name.endswith(":values")]
    assert lanes[-1].column(name).to_pylist()[-1] == [str(stage) for stage in range(19)]


def test_waypoints_are_measured_by_the_plan_that_was_in_force(workshop, replanned):
    report = track(workshop.recording(replanned))
    assert report.arrived
    assert report.waypoints_missed == 0
    assert len(report.series.waypoint_time_s) == len(OTHER)
    assert report.series.waypoint_time_error_s[1:] == pytest.approx(np.zeros(3), abs=0.01)
    assert report.cross_track_m.max == pytest.approx(0.0, abs=1e-3)
    assert (report.forecasts, report.plan_changes, report.holds) == (2, 1, 0)
    assert report.replanning == tuple(issue.reason for issue in replanned.plans)
    assert report.planned_time_s == 480.0
    late = track(workshop.recording(shifted(workshop, replanned, 200.0, 5.0)))
    assert late.cross_track_m.max == pytest.approx(5.0, abs=0.01)


def shifted(workshop, flight, from_s, right_m):
    """Aside of the new reference from some time on."""
    aside = workshop.fly(flight.header, right_m=right_m, relaid=flight.relaid, until_s=360.0)
    states = [b if b.time_s > from_s else a for a, b in zip(flight.states, aside.states, strict=True)]
    return replace(flight, states=states)


def test_a_flight_that_follows_the_old_plan_is_off_the_new_one(workshop, replanned):
    stubborn = workshop.fly(replanned.header)
    report = track(workshop.recording(replace(stubborn, relaid=replanned.relaid, plans=replanned.plans)))
    assert report.cross_track_m.max > 1000.0
    assert not report.arrived


@pytest.mark.parametrize(
    ("goal", "reachable", "arrived"), [("Port", True, True), ("Isle", True, False), ("Port", False, False)]
)
def test_it_has_arrived_at_the_missions_goal_alone(workshop, replanned, goal, reachable, arrived):
    plan = replanned.plans[0].plan
    plan = replace(plan, goal=goal, goals=tuple(replace(each, reachable=reachable) for each in plan.goals))
    flight = replace(replanned, outcome=Outcome.DIVERTED, plans=(replanned.plans[0]._replace(plan=plan),))
    report = track(workshop.recording(flight))
    assert report.arrived is arrived
    assert report.destination == goal
    assert "diverted" in report.summary()


def test_a_plan_whose_reference_was_lost_was_never_followed(workshop, replanned):
    recording = workshop.recording(replace(replanned, relaid=()))
    assert len(recording.plans) == 1
    assert track(recording).plan_changes == 0


def test_a_plan_that_begins_otherwise_than_what_was_flown_is_refused(workshop, replanned):
    recording = workshop.recording(replanned)
    first, second, third = recording.plans
    moved = replace(second.plan.waypoints[0], lat_deg=29.0)
    other = replace(second.plan, waypoints=(moved, *second.plan.waypoints[1:]))
    with pytest.raises(BadRecordingError, match=r"begins otherwise than that of -30\.0 s, of which 1 way"):
        track(replace(recording, plans=(first, second._replace(plan=other), third._replace(plan=other))))


def test_a_plan_that_makes_no_sense_is_named(workshop, replanned):
    class Senseless(Plan):
        def to_json(self):
            return b'{"planner": 1}'

    issue = replanned.plans[0]
    plan = Senseless(*(getattr(issue.plan, field.name) for field in fields(Plan)))
    with pytest.raises(BadRecordingError, match="a plan made in flight makes no sense: not a galeway plan"):
        workshop.recording(replace(replanned, plans=(issue._replace(plan=plan),)))


def test_viewers_get_each_new_plan_when_it_is_made(workshop, replanned):
    with workshop.file(replanned).open("rb") as stream:
        times = {PLAN.name: [], PLAN_PATH.name: [], PLAN_ISSUE.name: []}
        for _, channel, message in make_reader(stream).iter_messages(topics=list(times)):
            times[channel.topic].append(message.log_time / 1e9 - replanned.header.plan.departure_s)
    assert times == {
        PLAN.name: [-30.0, REPLAN_S],
        PLAN_PATH.name: [-30.0, REPLAN_S],
        PLAN_ISSUE.name: [REPLAN_S, 200.0],
    }
