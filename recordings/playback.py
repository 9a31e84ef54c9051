"""Plays a recording back to a recorder, as if its flight were flown again."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import numpy as np

from aircraft.state import Command, FlightState
from recordings.recorder import GuidanceSample, Recorder, WeatherSheet
from recordings.recording import HazardSheet, Recording

_BLOCK = 6000  # samples as Python objects at once: those of 18 hours would take a gigabyte


def play(recording: Recording, recorder: Recorder) -> None:
    """Tell a recorder all of a flight, each thing at its time.

    Args:
        recording: whole, or what is left of one: then the flight ends where that ends.
        recorder: one that has not begun.
    """
    try:
        recorder.begin(recording.header)
        _tell(recording, recorder)
        recorder.finish(recording.end_time_s, recording.outcome, recording.outcome_detail)
    except BaseException:
        recorder.abandon()
        raise


def _tell(recording: Recording, recorder: Recorder) -> None:
    """What happens between beginning and end; the order within a moment is that of the closed loop."""
    sheets = deque(sorted(recording.hazards, key=lambda sheet: sheet.time_s))
    references, plans = deque(recording.references[1:]), deque(recording.plans[1:])
    events = deque(sorted(recording.events, key=lambda event: event.time_s))
    estimates = _estimates(recording)
    estimate = next(estimates, None)
    for state, guidance in _moments(recording):
        time_s = state.time_s
        while sheets and sheets[0].time_s <= time_s:
            recorder.weather(weather_of(sheets.popleft()))
        recorder.sample(state, guidance)
        if estimate and estimate["time_s"] <= time_s:
            recorder.estimate(state._replace(**estimate))
            estimate = next(estimates, None)
        while plans and plans[0].time_s <= time_s:
            recorder.plan(plans.popleft())
        while references and references[0].time_s <= time_s:
            recorder.reference(*references.popleft())
        while events and events[0].time_s <= time_s:
            event = events.popleft()
            recorder.event(event.time_s, event.text)


def _moments(recording: Recording) -> Iterator[tuple[FlightState, GuidanceSample]]:
    count = min(len(recording.state), len(recording.guidance))  # what is cut off may lack a sample of one
    for begin in range(0, count, _BLOCK):
        block = slice(begin, min(begin + _BLOCK, count))
        guided = recording.guidance[block].tolist()
        for state, (_, *progress, roll, airspeed, altitude, climb) in zip(
            recording.state[block].tolist(), guided, strict=True
        ):
            command = Command(roll, airspeed, altitude, climb)
            yield FlightState._make(state), GuidanceSample._make((*progress, command))


def _estimates(recording: Recording) -> Iterator[dict[str, float]]:
    """What sensors and estimators made of some of the moments."""
    for begin in range(0, len(recording.estimate), _BLOCK):
        for row in recording.estimate[begin : begin + _BLOCK].tolist():
            yield dict(zip(recording.estimate.dtype.names or (), row, strict=True))


def weather_of(sheet: HazardSheet) -> WeatherSheet:
    """A sheet as it was recorded; calm where the wind of the area was not."""
    north_mps, east_mps = sheet.wind_north_mps, sheet.wind_east_mps
    if north_mps is None or east_mps is None:
        north_mps = east_mps = np.zeros(sheet.hazard.shape, np.float32)
    return WeatherSheet(
        sheet.layer,
        sheet.stage,
        sheet.time_s,
        sheet.hazard,
        north_mps,
        east_mps,
        closed=sheet.closed,
        altitude_m=sheet.altitude_m,
    )
