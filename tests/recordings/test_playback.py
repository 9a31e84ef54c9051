"""A recording played back: recorded again it is the same, and what is left of one stays what it is."""

import numpy as np
import pytest

from recordings.errors import RecordingError
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.playback import play
from recordings.recorder import Outcome


def played(recording, path):
    play(recording, McapRecorder(path))
    return read(path)


def assert_same(again, recording):
    assert again.header.plan == recording.header.plan
    assert again.header.scenario_toml == recording.header.scenario_toml
    np.testing.assert_array_equal(again.state, recording.state)
    np.testing.assert_array_equal(again.guidance, recording.guidance)
    np.testing.assert_array_equal(again.estimate, recording.estimate)
    assert len(recording.estimate)
    assert again.events == recording.events
    assert len(again.hazards) == len(recording.hazards) > 0
    for ours, theirs in zip(again.hazards, recording.hazards, strict=True):
        assert (ours.layer, ours.stage, ours.time_s) == (theirs.layer, theirs.stage, theirs.time_s)
        np.testing.assert_array_equal(ours.hazard, theirs.hazard)
        np.testing.assert_array_equal(ours.wind_north_mps, theirs.wind_north_mps)
        np.testing.assert_array_equal(ours.wind_east_mps, theirs.wind_east_mps)
        assert np.any(ours.wind_east_mps)
    assert [issue.time_s for issue in again.references] == [issue.time_s for issue in recording.references]
    for ours, theirs in zip(again.references, recording.references, strict=True):
        np.testing.assert_array_equal(ours.reference.north_m, theirs.reference.north_m)
    assert (again.outcome, again.end_time_s) == (recording.outcome, recording.end_time_s)


def test_a_recording_that_is_played_back_is_recorded_as_it_was(workshop, tmp_path):
    flight = workshop.fly_and_hold(workshop.header(workshop.straight), 70.0, 100.0)
    recording = workshop.recording(flight)
    assert len(recording.references) == 2
    assert_same(played(recording, tmp_path / "again.mcap"), recording)


def test_stages_come_at_their_times(workshop, tmp_path):
    recording = workshop.recording(workshop.fly(workshop.header(workshop.corners, leg_s=400.0), hz=1))
    assert {sheet.stage for sheet in recording.hazards} == {0, 1, 2}
    assert_same(played(recording, tmp_path / "again.mcap"), recording)


def test_more_samples_than_are_held_at_once_are_all_played(workshop, tmp_path, monkeypatch):
    monkeypatch.setattr("recordings.playback._BLOCK", 7)
    recording = workshop.recording(workshop.fly(workshop.header(workshop.straight), until_s=60.0))
    assert_same(played(recording, tmp_path / "again.mcap"), recording)


def test_what_is_left_of_a_flight_is_played_as_incomplete(workshop, tmp_path):
    recorder = McapRecorder(tmp_path / "killed.mcap")
    workshop.fly(workshop.header(workshop.straight)).record(recorder, finish=False)
    recorder.abandon()
    left = read(recorder.partial_path)
    assert not left.complete
    again = played(left, tmp_path / "again.mcap")
    assert again.outcome is Outcome.INCOMPLETE
    assert again.end_time_s == left.state["time_s"][-1]


def test_a_recorder_that_fails_is_abandoned(workshop, tmp_path):
    class Full(McapRecorder):
        abandoned = False

        def sample(self, *_):
            raise RecordingError("the disk is full")

        def abandon(self):
            self.abandoned = True
            super().abandon()

    recorder = Full(tmp_path / "full.mcap")
    with pytest.raises(RecordingError, match="disk is full"):
        play(workshop.recording(workshop.fly(workshop.header(workshop.straight))), recorder)
    assert recorder.abandoned
    assert recorder.partial_path.exists()
