"""The one loop: plan → reference → guidance → aircraft ← wind, → recorder."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import count

from aircraft.guidance import Guidance, Progress
from aircraft.instruments import Instruments
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.path import Phase
from aircraft.state import FlightState
from aircraft.watch import Path, Watch
from planner.errors import OutsideFieldError
from planner.windfield import WindField
from recordings.recorder import FlightHeader, GuidanceSample, Outcome, Recorder, WeatherSheet
from sim.faults import disturbed, missed, strike
from sim.glide import Glide
from sim.holding import Holding, story
from sim.interruption import put_off
from sim.level_sheets import LevelWatch
from sim.replanning import Replanner
from sim.scenario import Fault
from sim.wind_ahead import WindAhead

_NEARLY_M = 0.1  # before the last waypoint, from where on a flight may be at its end
_new_tuple = tuple.__new__  # makes a named tuple of a tuple in a third of the time of its constructor


@dataclass(frozen=True, slots=True)
class FlightSetup:
    """All that one flight needs, the aircraft trimmed at the start of the reference's lead-in.

    `sheets`: the weather to record, rising in time. `sample_hz`: states recorded a second, a multiple of
    `guidance_hz`, the rounds of guidance; between two of these its commands hold. `lead_in_s`: from the start
    to the first waypoint. `off_path_limit_m`: distance from the reference at which the flight is given up,
    unless a wind above the airspeed blew it there; `late_limit_s`: how long after the reference's end it is
    given up wherever it is. `holding`: decides what is done where it is too early,
    `replanner` what a new forecast does to the plan, None where it never changes. `levels`: says what weather
    to record instead of `sheets`, where the flight changes level.
    """

    header: FlightHeader
    aircraft: JsbsimAircraft
    guidance: Guidance
    instruments: Instruments
    holding: Holding
    replanner: Replanner | None
    truth: WindField
    sheets: tuple[WeatherSheet, ...]
    sample_hz: int
    guidance_hz: int
    lead_in_s: float
    off_path_limit_m: float
    late_limit_s: float
    faults: tuple[Fault, ...] = ()
    levels: LevelWatch | None = None


@dataclass(frozen=True, slots=True)
class End:
    """How a flight ended, and when, in seconds since departure."""

    time_s: float
    outcome: Outcome
    detail: str


def fly(setup: FlightSetup, recorder: Recorder, on_time: Callable[[float], object]) -> End:
    """Fly until something ends it, and record it; what was recorded before an error stays readable.

    Ctrl-C is let in after whole rounds of guidance, so that it leaves whole samples.

    Args:
        setup: the flight.
        recorder: takes it all.
        on_time: told the time since departure [s] at every round of guidance, for a progress bar.
    """
    with put_off() as let_in:
        try:
            recorder.begin(setup.header)
            end = _loop(setup, recorder, on_time, let_in)
            for text in missed(setup.faults, end.time_s):
                recorder.event(end.time_s, text)
            recorder.finish(end.time_s, end.outcome, end.detail)
        except BaseException:
            recorder.abandon()
            raise
    return end


def _loop(
    setup: FlightSetup, recorder: Recorder, on_time: Callable[[float], object], let_in: Callable[[], None]
) -> End:
    aircraft, guide, record = setup.aircraft, setup.guidance.update, recorder.sample
    see, shift = setup.instruments.see, setup.instruments.shift
    plane_point, departure_s = setup.header.grid.frame.plane_point, setup.header.plan.departure_s
    wind = WindAhead(disturbed(setup.truth.probe(), setup.faults, departure_s), departure_s, setup.lead_in_s)
    faults, glide = deque(sorted(setup.faults, key=lambda fault: fault.time_s)), Glide(aircraft)
    sample_hz, lead_in_s, watch = setup.sample_hz, setup.lead_in_s, setup.guidance.watch
    steps, every = round(aircraft.rate_hz / sample_hz), sample_hz // setup.guidance_hz
    round_s, too_early_s = 1.0 / setup.guidance_hz, setup.holding.early_s
    sheets, phase, forecast_s, levels = deque(setup.sheets), Phase.LEAD_IN, math.inf, setup.levels
    if setup.replanner:
        forecast_s = setup.replanner.next_s
    progress = Progress(0.0, 0.0, 0.0, 0.0, Phase.LEAD_IN)
    for tick in count():
        time_s = tick / sample_hz - lead_in_s
        if time_s >= forecast_s and not glide.cause:
            forecast_s = _replan(setup, recorder, time_s, progress)
        while sheets and sheets[0].time_s <= time_s:
            recorder.weather(sheets.popleft())
        while faults and faults[0].time_s <= time_s:
            recorder.event(time_s, strike(faults.popleft(), aircraft))
        state = aircraft.state()
        if not math.isfinite(sum(state)):
            return _not_finite(time_s, state)
        guiding = tick % every == 0
        if levels and guiding:
            _at_level(levels, recorder, time_s, state.altitude_m)
        if guiding:
            seen = see(state)
            north_m, east_m, scale = plane_point(seen.lat_rad, seen.lon_rad)
            command, progress = guide(seen, north_m, east_m, scale, seen.wind_north_mps, seen.wind_east_mps)
            aircraft.command(shift(command, state, seen))
            guided = _new_tuple(GuidanceSample, (*progress, command))
        record(state, guided)
        if guiding:
            if seen is not state:
                recorder.estimate(seen)
            path_m, across_m, _, late_s, phase_now = progress
            begins = glide.begins(state)
            if begins or watch.news or phase_now is not phase:
                for text in _news(watch, glide if begins else None, phase, phase_now):
                    recorder.event(time_s, text)
                phase = phase_now
            let_in()
            on_time(time_s)
            if end := _end(setup, time_s, state, path_m, across_m, glide):
                return end
            if late_s < too_early_s and not glide.cause:
                _hold(setup, recorder, time_s, progress, seen)
            try:
                wind.look(aircraft, state, steps * every, round_s)
            except OutsideFieldError as error:
                return End(time_s, Outcome.LEFT_WEATHER, str(error))
        wind.fly(aircraft, steps)
    raise AssertionError("unreachable: counting does not end")


def _at_level(levels: LevelWatch, recorder: Recorder, time_s: float, altitude_m: float) -> None:
    """Record the weather of another stage or level, if the flight has come to one."""
    for sheet in levels.due(time_s, altitude_m):
        recorder.weather(sheet)
    for text in levels.news:
        recorder.event(time_s, text)


def _hold(
    setup: FlightSetup, recorder: Recorder, time_s: float, progress: Progress, seen: FlightState
) -> None:
    """Go over to a reference with a hold in it, if there is one to be flown from here."""
    hold = setup.holding.decide(setup.guidance, progress, seen)
    if hold:
        setup.guidance.follow(hold.reference, 0.0)
        recorder.reference(time_s, hold.reference)
        recorder.event(time_s, story(hold, -progress.time_error_s))


def _replan(setup: FlightSetup, recorder: Recorder, time_s: float, progress: Progress) -> float:
    """Take a new forecast, and go over to the reference of a new plan if it asks for one.

    Returns:
        When the next one is issued, since departure.
    """
    assert setup.replanner is not None
    decision = setup.replanner.decide(time_s, setup.guidance, progress)
    setup.holding.places = replace(setup.holding.places, hazard=decision.hazard)
    recorder.weather(decision.sheet)
    recorder.event(time_s, decision.issue.reason)
    recorder.plan(decision.issue)
    if decision.reference:
        setup.guidance.follow(decision.reference, 0.0)
        recorder.reference(time_s, decision.reference)
    return setup.replanner.next_s


def _end(
    setup: FlightSetup, time_s: float, state: FlightState, path_m: float, across_m: float, glide: Glide
) -> End | None:
    """What ends the flight at this moment, if anything does. Without an engine it glides to the ground."""
    guidance = setup.guidance
    if setup.aircraft.has_crashed():
        if glide.cause:
            return End(time_s, glide.cause, glide.story(state))
        return End(time_s, Outcome.CRASHED, f"hit the ground at {state.airspeed_mps:.0f} m/s")
    end_m = guidance.end_m - _NEARLY_M
    if path_m >= end_m and _is_at_end(setup, state, end_m):
        if setup.replanner:
            return End(time_s, *setup.replanner.ending)
        return End(time_s, Outcome.ARRIVED, f"passed {setup.header.plan.goal}")
    if abs(across_m) > setup.off_path_limit_m and not (glide.cause or _is_blown_off(guidance)):
        detail = f"{abs(across_m):.0f} m off the reference, limit {setup.off_path_limit_m:g} m"
        return End(time_s, Outcome.CANNOT_FOLLOW, detail)
    late_s = time_s - guidance.end_s
    if late_s > setup.late_limit_s and not glide.cause:  # a glide ends by itself
        detail = f"still under way {late_s:.0f} s after the plan's end, limit {setup.late_limit_s:g} s"
        return End(time_s, Outcome.CANNOT_FOLLOW, detail)
    return None


def _is_blown_off(guidance: Guidance) -> bool:
    """Whether a wind above its airspeed took the aircraft from its path; it will come back by itself."""
    return guidance.watch.path is not Path.FOLLOWED


def _is_at_end(setup: FlightSetup, state: FlightState, end_m: float) -> bool:
    """Whether the last waypoint is truly passed; guidance may believe so a little earlier."""
    north_m, east_m, _ = setup.header.grid.frame.plane_point(state.lat_rad, state.lon_rad)
    path_m, _ = setup.guidance.reference.project(north_m, east_m, end_m)
    return path_m >= end_m


def _not_finite(time_s: float, state: FlightState) -> End:
    bad = [name for name, value in state._asdict().items() if not math.isfinite(value)]
    return End(time_s, Outcome.NOT_FINITE, f"no longer finite: {', '.join(bad)}")


def _news(watch: Watch, begun: Glide | None, before: Phase, after: Phase) -> Iterator[str]:
    """What there is to tell of this moment."""
    yield from watch.take()
    if begun:
        yield begun.beginning()
    if after is not before:
        yield from _news_of_phase(before, after)


def _news_of_phase(before: Phase, after: Phase) -> Iterator[str]:
    if before is Phase.LEAD_IN:
        yield "departure: end of the lead-in"
    if after is Phase.LOITER:
        yield "loiter begins"
    elif before is Phase.LOITER:
        yield "loiter ends"
