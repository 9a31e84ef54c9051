"""Reading back: everything as it was written."""

from dataclasses import replace

import numpy as np
import pytest

from recordings.playback import weather_of
from recordings.recorder import Layer, Outcome


@pytest.fixture(scope="module")
def flight(kept):
    return kept.fly(kept.header(kept.corners), right_m=0.5)


def test_what_is_read_is_what_was_written(workshop, flight, assert_same):
    recording = workshop.recording(flight)
    assert_same(recording, flight)
    assert (recording.complete, recording.missing) == (True, "")
    assert (recording.outcome, recording.outcome_detail) == (Outcome.ARRIVED, "as it was told")
    assert recording.end_time_s == flight.states[-1].time_s
    assert [(event.time_s, event.text) for event in recording.events] == [(60.0, "a minute has passed")]
    assert recording.limits == flight.header.limits


def test_estimates_are_read_back(workshop, flight):
    found = workshop.recording(flight).estimate
    assert found["time_s"].tolist() == [state.time_s for state in flight.seen]
    assert found["lat_rad"].tolist() == [state.lat_rad for state in flight.seen]
    wind_mps = np.array([state.wind_north_mps for state in flight.seen], dtype=np.float32)
    assert np.array_equal(found["wind_north_mps"], wind_mps)
    assert len(workshop.recording(replace(flight, seen=[])).estimate) == 0


def test_hazards_are_read_back_bit_by_bit(workshop):
    hazard = np.random.default_rng(5).random(workshop.grid.shape) < 0.3
    flight = workshop.fly(workshop.header(workshop.straight), sheets=workshop.sheets(hazard))
    recording = workshop.recording(flight)
    assert [(sheet.layer, sheet.stage) for sheet in recording.hazards] == [
        (Layer.FORECAST, 0),
        (Layer.TRUTH, 0),
    ]
    for sheet in recording.hazards:
        assert np.array_equal(sheet.hazard, hazard)
        assert (sheet.grid, sheet.threshold_mps, sheet.time_s) == (workshop.grid, 15.0, -30.0)


def test_closed_cells_are_read_back_bit_by_bit(workshop):
    closed = np.random.default_rng(6).random(workshop.grid.shape) < 0.3
    sheets = [
        replace(sheet, closed=closed) if sheet.layer is Layer.TRUTH else sheet for sheet in workshop.sheets()
    ]
    recording = workshop.recording(workshop.fly(workshop.header(workshop.straight), sheets=sheets))
    forecast, truth = recording.hazards[:2]
    assert forecast.closed is None
    assert np.array_equal(truth.closed, closed)
    assert np.array_equal(weather_of(truth).closed, closed)


def test_the_altitude_of_a_sheet_is_read_back_and_none_where_it_was_not_written(workshop):
    sheets = [
        replace(sheet, altitude_m={Layer.TRUTH: 0.0, Layer.FORECAST: None}[sheet.layer])
        for sheet in workshop.sheets()
    ]
    recording = workshop.recording(workshop.fly(workshop.header(workshop.straight), sheets=sheets))
    forecast, truth = recording.hazards[:2]
    assert (forecast.altitude_m, truth.altitude_m) == (None, 0.0)
    assert (weather_of(forecast).altitude_m, weather_of(truth).altitude_m) == (None, 0.0)


def test_a_crash_is_a_whole_recording(workshop, flight):
    recording = workshop.recording(replace(flight, outcome=Outcome.CRASHED))
    assert recording.complete
    assert recording.outcome == Outcome.CRASHED
