"""The one loop: plan → reference → guidance → aircraft ← wind, → recorder."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count

from aircraft.guidance import Guidance, Progress
from aircraft.instruments import Instruments
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.path import Phase
from aircraft.state import FlightState
from aircraft.watch import Path
from planner.errors import OutsideFieldError
from planner.windfield import WindField
from recordings.recorder import FlightHeader, GuidanceSample, Outcome, Recorder, WeatherSheet
from sim.faults import AircraftFaults, disturbed
from sim.glide import Glide
from sim.scenario import Fault
from sim.wind_ahead import WindAhead

_new_tuple = tuple.__new__  # makes a named tuple of a tuple in a third of the time of its constructor


@dataclass(frozen=True, slots=True)
class FlightSetup:
    """All that one flight needs, the aircraft trimmed at the start of the reference's lead-in.

    `sheets`: the weather to record, rising in time. `lead_in_s`: from the start to the first waypoint.
    `off_path_limit_m`: distance from the reference at which the flight is given up, unless a wind above the
    airspeed blew it there.
    """

    header: FlightHeader
    aircraft: JsbsimAircraft
    guidance: Guidance
    instruments: Instruments
    truth: WindField
    sheets: tuple[WeatherSheet, ...]
    guidance_hz: int
    lead_in_s: float
    off_path_limit_m: float
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True, slots=True)
class End:
    """How a flight ended, and when, in seconds since departure."""

    time_s: float
    outcome: Outcome
    detail: str


def fly(setup: FlightSetup, recorder: Recorder, on_time: Callable[[float], object]) -> End:
    """Fly until something ends it, and record it; what was recorded before an error stays readable.

    Args:
        setup: the flight.
        recorder: takes it all.
        on_time: told the time since departure [s] at every round of guidance, for a progress bar.
    """
    try:
        recorder.begin(setup.header)
        end = _loop(setup, recorder, on_time)
        recorder.finish(end.time_s, end.outcome, end.detail)
    except BaseException:
        recorder.abandon()
        raise
    return end


def _loop(setup: FlightSetup, recorder: Recorder, on_time: Callable[[float], object]) -> End:
    aircraft, guide, record = setup.aircraft, setup.guidance.update, recorder.sample
    see, shift, watch = setup.instruments.see, setup.instruments.shift, setup.guidance.watch
    plane_point, departure_s = setup.header.grid.frame.plane_point, setup.header.plan.departure_s
    wind = WindAhead(disturbed(setup.truth.probe(), setup.faults, departure_s), departure_s, setup.lead_in_s)
    faults, glide = AircraftFaults(setup.faults), Glide(aircraft)
    steps, round_s = round(aircraft.rate_hz / setup.guidance_hz), 1.0 / setup.guidance_hz
    end_m = float(setup.header.reference.waypoint_path_m[-1]) - 0.1
    sheets, phase = deque(setup.sheets), Phase.LEAD_IN
    for tick in count():
        time_s = tick / setup.guidance_hz - setup.lead_in_s
        while sheets and sheets[0].time_s <= time_s:
            recorder.weather(sheets.popleft())
        state = aircraft.state()
        if not math.isfinite(sum(state)):
            return _not_finite(time_s, state)
        for text in (*faults.strike(aircraft, time_s), *glide.watch(state)):
            recorder.event(time_s, text)
        seen = see(state)
        north_m, east_m, scale = plane_point(seen.lat_rad, seen.lon_rad)
        command, progress = guide(seen, north_m, east_m, scale, seen.wind_north_mps, seen.wind_east_mps)
        aircraft.command(shift(command, state, seen))
        record(state, _new_tuple(GuidanceSample, (*progress, command)))
        if seen is not state:
            recorder.estimate(seen)
        if watch.news:
            for news in watch.take():
                recorder.event(time_s, news)
        if progress.phase is not phase:
            _tell(recorder, time_s, phase, progress.phase)
            phase = progress.phase
        on_time(time_s)
        if end := _end(setup, end_m, time_s, state, progress, glide):
            return end
        try:
            wind.fly(aircraft, state, steps, round_s)
        except OutsideFieldError as error:
            if not aircraft.is_finite():
                return _not_finite(time_s, aircraft.state())
            return End(time_s, Outcome.LEFT_WEATHER, str(error))
    raise AssertionError("unreachable: counting does not end")


def _end(
    setup: FlightSetup, end_m: float, time_s: float, state: FlightState, progress: Progress, glide: Glide
) -> End | None:
    """What ends the flight at this moment, if anything does. Without an engine it glides to the ground."""
    if setup.aircraft.has_crashed():
        if glide.cause:
            return End(time_s, glide.cause, glide.story(state))
        return End(time_s, Outcome.CRASHED, f"hit the ground at {state.airspeed_mps:.0f} m/s")
    if progress.path_m >= end_m and _is_at_end(setup, state, end_m):
        return End(time_s, Outcome.ARRIVED, f"passed {setup.header.plan.goal}")
    blown_off = setup.guidance.watch.path is not Path.FOLLOWED  # by wind above its airspeed: it comes back
    if abs(progress.cross_track_m) > setup.off_path_limit_m and not blown_off and not glide.cause:
        detail = f"{abs(progress.cross_track_m):.0f} m off the reference, limit {setup.off_path_limit_m:g} m"
        return End(time_s, Outcome.CANNOT_FOLLOW, detail)
    return None


def _is_at_end(setup: FlightSetup, state: FlightState, end_m: float) -> bool:
    """Whether the last waypoint is truly passed; guidance may believe so a little earlier."""
    north_m, east_m, _ = setup.header.grid.frame.plane_point(state.lat_rad, state.lon_rad)
    path_m, _ = setup.header.reference.project(north_m, east_m, end_m)
    return path_m >= end_m


def _not_finite(time_s: float, state: FlightState) -> End:
    bad = [name for name, value in state._asdict().items() if not math.isfinite(value)]
    return End(time_s, Outcome.NOT_FINITE, f"no longer finite: {', '.join(bad)}")


def _tell(recorder: Recorder, time_s: float, before: Phase, after: Phase) -> None:
    if before is Phase.LEAD_IN:
        recorder.event(time_s, "departure: end of the lead-in")
    if after is Phase.LOITER:
        recorder.event(time_s, "loiter begins")
    elif before is Phase.LOITER:
        recorder.event(time_s, "loiter ends")
