"""Recordings that must not be measured, one thing wrong with each."""

import math
from dataclasses import replace

import pytest

from recordings.errors import BadRecordingError
from recordings.recorder import Layer
from recordings.tracking import track


@pytest.fixture(scope="module")
def flight(kept):
    return kept.fly(kept.header(kept.straight))


def refused(workshop, flight, message):
    with pytest.raises(BadRecordingError, match=message):
        track(workshop.recording(flight))


@pytest.mark.parametrize("name", ["lat_rad", "altitude_m", "roll_rad", "wind_north_mps", "fuel_kg"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_samples_that_are_not_finite(workshop, flight, name, value):
    refused(
        workshop, flight.changed(1000, **{name: value}), rf"{name} of sample 1000 is -?(nan|inf); 1 samples"
    )


def test_a_bad_sample_in_the_lead_in_counts_too(workshop, flight):
    refused(workshop, flight.changed(0, roll_rad=math.nan), "roll_rad of sample 0")


def test_times_that_repeat(workshop, flight):
    again = flight.states[999].time_s
    refused(workshop, flight.changed(1000, time_s=again), r"sample 1000 repeats the time .*69\.900 s")


def test_times_that_run_backwards(workshop, flight):
    refused(workshop, flight.changed(1000, time_s=50.0), "sample 1000 runs backwards")


def test_samples_that_are_missing(workshop, flight):
    cut = replace(
        flight,
        states=flight.states[:1000] + flight.states[1020:],
        guidance=flight.guidance[:1000] + flight.guidance[1020:],
    )
    refused(workshop, cut, r"missing from 00:01:10 to 00:01:12: a gap of 2\.10 s where 0\.10 s is usual")


def test_true_hazards_that_are_missing_at_departure(workshop, flight):
    forecast = [sheet for sheet in flight.sheets if sheet.layer == Layer.FORECAST]
    refused(workshop, replace(flight, sheets=forecast), "at departure are missing")


def test_true_hazards_that_begin_after_departure(workshop):
    flight = workshop.fly(workshop.header(workshop.straight, leg_s=480.0), sheets=workshop.sheets())
    sheets = [sheet for sheet in flight.sheets if sheet.stage > 0]
    refused(workshop, replace(flight, sheets=sheets), "at departure are missing")


def test_true_hazards_of_a_stage_that_are_missing(workshop):
    flight = workshop.fly(workshop.header(workshop.straight, leg_s=480.0), sheets=workshop.sheets())
    sheets = [sheet for sheet in flight.sheets if sheet.stage != 1]
    refused(workshop, replace(flight, sheets=sheets), "stage 2 at 1200 s follow those of stage 0")


def test_a_reference_of_another_plan(workshop, flight):
    other = replace(flight.header, reference=workshop.header(workshop.corners).reference)
    refused(workshop, replace(flight, header=other), "4 waypoints and the reference passes 5")


def test_a_reference_that_is_not_finite(workshop, flight):
    reference = flight.header.reference
    scale = reference.scale.copy()
    scale[1] = math.nan
    header = replace(flight.header, reference=replace(reference, scale=scale))
    refused(workshop, replace(flight, header=header), "scale of the reference is not finite")


def test_a_segment_without_length(workshop, flight):
    reference = flight.header.reference
    length_m = reference.length_m.copy()
    length_m[1] = 0.0
    header = replace(flight.header, reference=replace(reference, length_m=length_m))
    refused(workshop, replace(flight, header=header), "has no length")


def test_a_single_sample_is_sound(workshop, flight):
    one = replace(flight, states=flight.states[:1], guidance=flight.guidance[:1])
    assert track(workshop.recording(one)).samples == 0
