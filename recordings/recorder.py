"""What a recording is made of, what a recorder does, and the fan-out to several recorders."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from aircraft.reference import Reference
from aircraft.state import Command, FlightState
from planner.grid import Grid
from planner.plans import Plan


class Outcome(StrEnum):
    """How a flight ended."""

    ARRIVED = "arrived"
    CRASHED = "crashed"
    LEFT_WEATHER = "left_weather"
    CANNOT_FOLLOW = "cannot_follow"
    FUEL_OUT = "fuel_out"
    ENGINE_FAILED = "engine_failed"
    NOT_FINITE = "not_finite"
    DIVERTED = "diverted"  # at another of the mission's goals
    RETURNED = "returned"  # at the start
    NO_ROUTE = "no_route"  # it waited for a way to the goal to the end
    INCOMPLETE = "incomplete"  # what a reader says of a recording that just stops, and what repair writes


class Layer(StrEnum):
    """Whose weather a sheet shows: what the planner saw, or what the aircraft flies through."""

    FORECAST = "forecast"
    TRUTH = "truth"


@dataclass(frozen=True, slots=True)
class WeatherSheet:
    """The weather of one stage: arrays are [north, east] on the flight's grid.

    `hazard`: bool, hazardous at any time of the stage, by the wind or for another reason; `closed`: bool, for
    another reason than the mean wind, None where there is none. `wind_north_mps`, `wind_east_mps`: float32,
    toward, at the start of the stage and at the flight's altitude: when that changes, there comes another
    sheet of the same stage. `peak_mps`: float32, the strongest wind at any time of the stage, which makes the
    wind's hazard; None where only that is known. `altitude_m`: that of the wind, above the ellipsoid; None in
    old recordings.
    """

    layer: Layer
    stage: int
    time_s: float
    hazard: NDArray[np.bool_]
    wind_north_mps: NDArray[np.float32]
    wind_east_mps: NDArray[np.float32]
    peak_mps: NDArray[np.float32] | None = None
    closed: NDArray[np.bool_] | None = None
    altitude_m: float | None = None


@dataclass(frozen=True, slots=True)
class FlightHeader:
    """All that is known before take-off; it makes the recording explain itself.

    `reference`: the first one; in flight others may follow. `threshold_mps`: wind speed above which a cell is
    hazardous. `limits`: the scenario's own, one expression each. `also`: what is hazardous besides that wind,
    in words. `versions`: package to version, with "galeway" and "git" among them.
    """

    scenario: str
    scenario_toml: str
    seed: int
    grid: Grid
    plan: Plan
    reference: Reference
    threshold_mps: float
    stage_s: float
    airspeed_min_mps: float
    airspeed_max_mps: float
    limits: tuple[str, ...] = ()
    also: tuple[str, ...] = ()
    versions: dict[str, str] = field(default_factory=dict)


class GuidanceSample(NamedTuple):
    """What guidance saw and asked for at one moment; errors as guidance knew them, for the eyes.

    `path_m`: progress along the reference, in plane metres. `cross_track_m`: right of the reference
    positive. `altitude_error_m`: above positive. `time_error_s`: late positive. `phase`: of the reference.
    """

    path_m: float
    cross_track_m: float
    altitude_error_m: float
    time_error_s: float
    phase: int
    command: Command


class PlanIssue(NamedTuple):
    """What a forecast did to the plan: `plan` is the one in force from then on, since departure.

    `changed`: whether it is another one than before. `reason`: why, or why not, for people.
    """

    time_s: float
    reason: str
    plan: Plan
    changed: bool


class Recorder(Protocol):
    """Takes one flight. Times are seconds since departure, and never run backwards."""

    def begin(self, header: FlightHeader) -> None:
        """Open the file and write what is known before take-off."""

    def weather(self, sheet: WeatherSheet) -> None:
        """Write the weather of one stage, before its first sample."""

    def sample(self, state: FlightState, guidance: GuidanceSample) -> None:
        """Write one moment."""

    def estimate(self, seen: FlightState) -> None:
        """Write what sensors and estimators made of the last sample, where they are not perfect."""

    def reference(self, time_s: float, reference: Reference) -> None:
        """Write a reference that was laid anew in flight, and is followed after the last sample."""

    def plan(self, issue: PlanIssue) -> None:
        """Write what a new forecast did to the plan, before the reference that leads along a new one."""

    def event(self, time_s: float, text: str) -> None:
        """Write one event: a stage begins, a loiter, a warning."""

    def finish(self, time_s: float, outcome: Outcome, detail: str) -> None:
        """Write how the flight ended and give the file its finished name."""

    def abandon(self) -> None:
        """Close the file under its unfinished name; what was recorded stays readable."""


class Recorders:
    """Passes one flight on to several recorders."""

    def __init__(self, recorders: Sequence[Recorder]) -> None:
        self._recorders = tuple(recorders)

    def begin(self, header: FlightHeader) -> None:
        """See `Recorder.begin`."""
        for recorder in self._recorders:
            recorder.begin(header)

    def weather(self, sheet: WeatherSheet) -> None:
        """See `Recorder.weather`."""
        for recorder in self._recorders:
            recorder.weather(sheet)

    def sample(self, state: FlightState, guidance: GuidanceSample) -> None:
        """See `Recorder.sample`."""
        for recorder in self._recorders:
            recorder.sample(state, guidance)

    def estimate(self, seen: FlightState) -> None:
        """See `Recorder.estimate`."""
        for recorder in self._recorders:
            recorder.estimate(seen)

    def reference(self, time_s: float, reference: Reference) -> None:
        """See `Recorder.reference`."""
        for recorder in self._recorders:
            recorder.reference(time_s, reference)

    def plan(self, issue: PlanIssue) -> None:
        """See `Recorder.plan`."""
        for recorder in self._recorders:
            recorder.plan(issue)

    def event(self, time_s: float, text: str) -> None:
        """See `Recorder.event`."""
        for recorder in self._recorders:
            recorder.event(time_s, text)

    def finish(self, time_s: float, outcome: Outcome, detail: str) -> None:
        """See `Recorder.finish`."""
        for recorder in self._recorders:
            recorder.finish(time_s, outcome, detail)

    def abandon(self) -> None:
        """See `Recorder.abandon`; all are told, also where one of them fails."""
        with ExitStack() as stack:
            for recorder in reversed(self._recorders):
                stack.callback(recorder.abandon)
