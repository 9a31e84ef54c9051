"""A flight that followed several references is measured against each at its time."""

from dataclasses import fields, replace

import numpy as np
import pytest

from recordings.errors import BadRecordingError
from recordings.mcap_reader import read
from recordings.recording import Issue
from recordings.tracking import track

EARLY_S, HOLD_S = 70.0, 100.0


@pytest.fixture(scope="module")
def held(kept):
    """Early by a lap at the second waypoint, and on time from the third on."""
    return kept.fly_and_hold(kept.header(kept.corners), EARLY_S, HOLD_S)


def test_references_are_read_back_with_their_times(workshop, held):
    recording = workshop.recording(held)
    written = [(held.header.reference.start_time_s[0], held.header.reference), *held.relaid]
    assert len(recording.references) == 2
    assert recording.header.reference is recording.references[0].reference
    for found, (time_s, reference) in zip(recording.references, written, strict=True):
        assert found.time_s == time_s
        for field in fields(reference):
            ours, theirs = getattr(found.reference, field.name), getattr(reference, field.name)
            assert ours.dtype == theirs.dtype
            assert np.array_equal(ours, theirs), field.name


def test_each_sample_is_measured_against_the_reference_of_its_time(workshop, held):
    report = track(workshop.recording(held))
    assert report.arrived
    assert report.waypoints_missed == 0
    assert report.cross_track_m.max == pytest.approx(0.0, abs=1e-3)
    assert report.holds == 1
    assert "held to lose time    1 ×" in report.summary()
    assert report.delay_s == pytest.approx(0.0, abs=1e-3)
    late_s = report.series.waypoint_time_error_s[1:]  # the first lies before the first sample
    assert late_s == pytest.approx([-EARLY_S, 0.0, 0.0, 0.0], abs=0.01)
    steps_m = -np.diff(report.series.to_go_m)
    swap = int(np.argmin(steps_m))
    assert report.series.time_s[swap] == pytest.approx(HOLD_S, abs=0.11)
    assert -steps_m[swap] == pytest.approx(EARLY_S * 27.0, rel=0.01)  # the lap, at the limits' airspeed
    assert np.all(np.delete(steps_m, swap) > 0.0)


def test_an_offset_in_the_hold_is_an_error_and_flying_on_without_it_is_one_too(workshop, held):
    aside = workshop.fly_and_hold(held.header, EARLY_S, HOLD_S, right_m=3.0)
    assert track(workshop.recording(aside)).cross_track_m.p95 == pytest.approx(3.0, abs=0.01)
    straight_on = workshop.fly(held.header, late_s=-EARLY_S)
    report = track(workshop.recording(replace(straight_on, relaid=held.relaid)))
    assert report.cross_track_m.max > 100.0


def test_a_flight_that_was_early_all_the_way_did_not_hold(workshop):
    header = workshop.header(workshop.straight)
    early = workshop.fly(header, late_s=-EARLY_S)
    report = track(workshop.recording(early))
    assert report.holds == 0
    assert report.delay_s == pytest.approx(-EARLY_S, abs=0.01)


def test_a_recording_cut_off_after_the_swap_still_has_both(workshop, held):
    whole = workshop.file(held)
    cut = workshop.folder / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: int(0.8 * whole.stat().st_size)])
    recording = read(cut)
    assert not recording.complete
    assert len(recording.references) == 2
    assert track(recording).cross_track_m.max == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda issue: issue._replace(time_s=-40.0), "of -40.0 s that passes"),
        (lambda issue: issue._replace(reference=no_waypoint(issue.reference)), "passes 0 waypoints"),
        (lambda issue: issue._replace(reference=spoilt(issue.reference)), "course_rad of the reference"),
    ],
)
def test_references_that_do_not_follow_each_other_are_refused(workshop, held, change, message):
    recording = workshop.recording(held)
    first, second = recording.references
    with pytest.raises(BadRecordingError, match=message):
        track(replace(recording, references=(first, change(second))))


def test_one_with_more_waypoints_than_the_one_before_is_refused(workshop, held):
    recording = workshop.recording(held)
    first, second = recording.references
    third = Issue(second.time_s + 10.0, first.reference)
    with pytest.raises(BadRecordingError, match="waypoints become no more"):
        track(replace(recording, references=(first, second, third)))


def no_waypoint(reference):
    return replace(reference, waypoint_path_m=reference.waypoint_path_m[:0])


def spoilt(reference):
    return replace(reference, course_rad=np.full_like(reference.course_rad, np.nan))
