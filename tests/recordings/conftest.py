"""Flights made of arithmetic: exactly along a real reference, or off it by a known amount."""

import math
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aircraft.holding import HoldLimits, lay_hold
from aircraft.joining import joined, joints
from aircraft.reference import PathPoint, Reference, ReferencePoints
from aircraft.state import Command, FlightState
from planner.grid import Grid
from planner.plans import GoalOutcome, Plan, Waypoint
from recordings import rerun_writer
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import (
    FlightHeader,
    GuidanceSample,
    Layer,
    Outcome,
    PlanIssue,
    Recorder,
    WeatherSheet,
)
from recordings.recording import Issue, Recording
from recordings.samples import rounded
from recordings.schema import GUIDANCE_COLUMNS, STATE_COLUMNS

DEPARTURE_S = 1664409600.0
STAGE_S = 600.0
LEAD_IN_S = 30.0
FLIGHTS_KEPT = 6
ALTITUDE_M = 1000.0
GRID = Grid.covering(
    math.radians(29.0), math.radians(31.0), math.radians(-91.0), math.radians(-88.0), rows=60, columns=80
)
STRAIGHT = ((0.0, 0.0), (0.0, 3000.0), (0.0, 6000.0), (0.0, 9000.0))
CORNERS = ((0.0, 0.0), (0.0, 3600.0), (3600.0, 3600.0), (3600.0, 7200.0), (0.0, 7200.0))


@dataclass(frozen=True)
class Flight:
    """All that a recorder is told, in order."""

    header: FlightHeader
    states: list[FlightState]
    guidance: list[GuidanceSample]
    sheets: list[WeatherSheet]
    seen: list[FlightState]
    outcome: Outcome = Outcome.ARRIVED
    relaid: tuple[Issue, ...] = ()
    plans: tuple[PlanIssue, ...] = ()

    def record(self, recorder: Recorder, *, finish: bool = True) -> None:
        sheets, relaid, plans = list(self.sheets), list(self.relaid), list(self.plans)
        recorder.begin(self.header)
        seen = {state.time_s: state for state in self.seen}
        for state, guidance in zip(self.states, self.guidance, strict=True):
            while sheets and sheets[0].time_s <= state.time_s:
                recorder.weather(sheets.pop(0))
            recorder.sample(state, guidance)
            while plans and plans[0].time_s <= state.time_s:
                recorder.plan(plans.pop(0))
            while relaid and relaid[0].time_s <= state.time_s:
                recorder.reference(*relaid.pop(0))
            if state.time_s in seen:
                recorder.estimate(seen[state.time_s])
            if state.time_s == 60.0:
                recorder.event(60.0, "a minute has passed")
        if finish:
            recorder.finish(self.states[-1].time_s, self.outcome, "as it was told")

    def changed(self, index: int, **fields: float) -> "Flight":
        """With some fields of one sample changed."""
        states = list(self.states)
        states[index] = states[index]._replace(**fields)
        return replace(self, states=states)


def make_points(corners_m: Sequence[tuple[float, float]], leg_s: float = 120.0) -> list[PathPoint]:
    """Plane positions (north, east), a leg of `leg_s` between each."""
    frame = GRID.frame
    return [
        PathPoint(*place, ALTITUDE_M, leg_s * index, frame.scale(frame.to_geodetic(*place)[0]))
        for index, place in enumerate(corners_m)
    ]


@cache
def make_header(corners_m: tuple[tuple[float, float], ...], leg_s: float = 120.0) -> FlightHeader:
    """A plan through plane positions (north, east), a leg of `leg_s` between each."""
    points, waypoints = make_points(corners_m, leg_s), []
    for north_m, east_m, _, time_s, _ in points:
        lat_rad, lon_rad = GRID.frame.to_geodetic(north_m, east_m)
        lat_deg, lon_deg = math.degrees(lat_rad), math.degrees(lon_rad)
        waypoints.append(Waypoint(lat_deg, lon_deg, ALTITUDE_M, time_s, int(time_s // STAGE_S)))
    last = waypoints[-1]
    goals = (
        GoalOutcome(
            "Port",
            last.lat_deg,
            last.lon_deg,
            True,
            "",
            last.time_s,
            last.time_s,
            1e4,
            0.0,
            2.5,
            min_clearance_m=1e3,
        ),
        GoalOutcome("Isle", 30.9, -88.1, False, "surrounded by hazard"),
    )
    plan = Plan("staged", "score", DEPARTURE_S, "Port", tuple(waypoints), goals)
    reference = Reference.through(points, turn_radius_m=150.0, loiter_radius_m=200.0, lead_in_s=LEAD_IN_S)
    return FlightHeader(
        scenario="squall",
        scenario_toml='name = "squall"\n',
        seed=7,
        grid=GRID,
        plan=plan,
        reference=reference,
        threshold_mps=15.0,
        stage_s=STAGE_S,
        airspeed_min_mps=20.0,
        airspeed_max_mps=40.0,
        limits=("arrived == true", "cross_track_m.p95 <= 2"),
        also=("gusts over 20 m/s (gust.nc)", "no-fly zones (zones.geojson)"),
        versions={"galeway": "0.1.0", "git": ""},
    )


def make_sheets(hazard: np.ndarray | None = None, stages: int = 3) -> list[WeatherSheet]:
    """Forecast and truth of each stage; the same hazard in all, by default a block in the north-east."""
    if hazard is None:
        hazard = np.zeros(GRID.shape, bool)
        hazard[50:, 70:] = True
    north = np.linspace(-12.0, 18.0, GRID.rows * GRID.columns, dtype=np.float32).reshape(GRID.shape)
    return [
        WeatherSheet(
            layer,
            stage,
            stage * STAGE_S if stage else -LEAD_IN_S,
            hazard,
            north,
            0.5 * north,
            altitude_m=ALTITUDE_M,
        )
        for stage in range(stages)
        for layer in Layer
    ]


def fly_along(
    header: FlightHeader,
    *,
    right_m: float = 0.0,
    above_m: float = 0.0,
    late_s: float = 0.0,
    until_s: float | None = None,
    hz: int = 10,
    wind_mps: Callable[[float], float] = lambda _: 6.0,
    sheets: list[WeatherSheet] | None = None,
    relaid: tuple[Issue, ...] = (),
) -> Flight:
    """Follow the reference at a constant offset, as if the schedule were `late_s` later.

    References that are laid anew are followed at their own times.
    """
    reference, frame = header.reference, header.grid.frame
    end_s = header.plan.duration_s + (0.0 if relaid else late_s) if until_s is None else until_s
    times_s = np.arange(math.ceil((end_s + LEAD_IN_S) * hz - 1e-6) + 1) / hz - LEAD_IN_S
    points = reference.at_many(reference.path_at_times(times_s - late_s))
    for issue in relaid:
        anew = issue.reference.at_many(issue.reference.path_at_times(times_s))
        before = times_s < issue.time_s
        points = ReferencePoints(*(np.where(before, *both) for both in zip(points, anew, strict=True)))
        late_s = 0.0
    off_m = right_m * points.scale
    beyond_m = np.maximum(times_s - late_s - header.plan.duration_s, 0.0) * points.speed_mps * points.scale
    north, east = np.cos(points.course_rad), np.sin(points.course_rad)
    lat_rad, lon_rad = frame.to_geodetic(
        points.north_m - off_m * east + beyond_m * north, points.east_m + off_m * north + beyond_m * east
    )
    states = [
        FlightState(
            time_s=float(time_s),
            lat_rad=float(lat_rad[i]),
            lon_rad=float(lon_rad[i]),
            altitude_m=float(points.altitude_m[i] + above_m),
            north_mps=25.0 * math.cos(points.course_rad[i]),
            east_mps=25.0 * math.sin(points.course_rad[i]),
            down_mps=0.25,
            roll_rad=0.1 * math.sin(time_s),
            pitch_rad=0.05 * math.cos(time_s),
            heading_rad=float(points.course_rad[i]),
            roll_rate_radps=0.01,
            pitch_rate_radps=-0.02,
            yaw_rate_radps=0.03,
            airspeed_mps=28.0 + math.sin(0.01 * time_s),
            angle_of_attack_rad=0.06,
            sideslip_rad=-0.01,
            wind_north_mps=0.6 * wind_mps(float(time_s)),
            wind_east_mps=0.8 * wind_mps(float(time_s)),
            wind_down_mps=0.0,
            gust_north_mps=0.7,
            gust_east_mps=-0.7,
            gust_down_mps=0.1,
            aileron=0.02,
            elevator=-0.1,
            rudder=0.0,
            throttle=0.6,
            fuel_kg=4.0 - 1e-4 * time_s,
            height_above_ground_m=990.0,
        )
        for i, time_s in enumerate(times_s.tolist())
    ]
    guidance = [
        GuidanceSample(float(path_m), 0.25, -0.5, 1.5, 1, Command(0.1, 28.0, ALTITUDE_M, 0.0))
        for path_m in reference.path_at_times(times_s)
    ]
    states, guidance = as_recorded(states, guidance)
    seen = [
        state._replace(lat_rad=state.lat_rad + 2.0**-22, wind_north_mps=state.wind_north_mps + 0.5)
        for state in states[1:]
    ]
    plans = (PlanIssue(60.0, "forecast of 00:00 UTC, stage 1: unchanged", header.plan, False),)
    sheets = make_sheets() if sheets is None else sheets
    return Flight(header, states, guidance, sheets, seen, relaid=relaid, plans=plans)


def as_recorded(
    states: list[FlightState], guidance: list[GuidanceSample]
) -> tuple[list[FlightState], list[GuidanceSample]]:
    """Samples that lie on the steps of the schema, so that what is read can be compared exactly."""
    rows = [
        (state.time_s, *sample[:-1], *sample.command) for state, sample in zip(states, guidance, strict=True)
    ]
    state_table = rounded(np.array(states), STATE_COLUMNS)
    guidance_table = rounded(np.array(rows), GUIDANCE_COLUMNS)
    return [FlightState._make(row) for row in state_table.tolist()], [
        GuidanceSample(path_m, across_m, above_m, late_s, int(phase), Command(*command))
        for _, path_m, across_m, above_m, late_s, phase, *command in guidance_table.tolist()
    ]


def fly_and_hold(header: FlightHeader, early_s: float, hold_s: float, **how: float) -> Flight:
    """Come so early, and from a time on fly a reference with a hold in it that makes it good."""
    limits = HoldLimits(150.0, 300.0, 27.0, math.radians(45.0))
    path_m = header.reference.path_at_time(hold_s + early_s)
    hold = lay_hold(header.reference, path_m, early_s, limits, (0.0, 0.0), lambda *_: True)
    assert hold is not None
    return fly_along(header, late_s=-early_s, relaid=(Issue(hold_s, hold.reference),), **how)


def fly_and_replan(
    header: FlightHeader, corners_m: Sequence[tuple[float, float]], replan_s: float, goal: str = "Port"
) -> Flight:
    """Change on the first leg to a plan through other corners, of which the first two are the old ones."""
    path_m = header.reference.path_at_time(replan_s)
    points = make_points(corners_m)
    goals = tuple(replace(known, reachable=True) for known in header.plan.goals)
    plan = replace(make_header(corners_m).plan, goal=goal, goals=goals)
    onward = Reference.through(points, turn_radius_m=150.0, loiter_radius_m=200.0, lead_in_s=0.0)
    joint = next(joints(header.reference, make_points(CORNERS), path_m))
    reference = joined(header.reference, path_m, joint, onward)
    flight = fly_along(header, relaid=(Issue(replan_s, reference),), until_s=plan.duration_s)
    told = "forecast of 00:00 UTC, stage 1: a better one"
    return replace(flight, plans=(PlanIssue(replan_s, told, plan, True),))


_FLOWN: OrderedDict[Any, tuple[FlightHeader, Flight]] = OrderedDict()
"""The flights flown last, by header and numbers; nothing changes a header or a flight once it is made."""


def fly(header: FlightHeader, **how: Any) -> Flight:
    """As `fly_along`, but not once more what was flown a moment ago."""
    if not all(isinstance(value, float | int) for value in how.values()):
        return fly_along(header, **how)
    key = id(header), *sorted(how.items())
    if key not in _FLOWN:
        _FLOWN[key] = header, fly_along(header, **how)  # the header is kept, so that its id stays its own
        if len(_FLOWN) > FLIGHTS_KEPT:
            _FLOWN.popitem(last=False)
    return _FLOWN[key][1]


@dataclass(frozen=True)
class Workshop:
    """Makes flights and their recordings."""

    folder: Path

    header = staticmethod(make_header)
    fly = staticmethod(fly)
    fly_and_hold = staticmethod(fly_and_hold)
    fly_and_replan = staticmethod(fly_and_replan)
    sheets = staticmethod(make_sheets)
    straight = STRAIGHT
    corners = CORNERS
    grid = GRID

    def file(self, flight: Flight, name: str = "flight") -> Path:
        """The finished MCAP file of a flight."""
        path = self.folder / f"{name}.mcap"
        flight.record(McapRecorder(path))
        return path

    def recording(self, flight: Flight) -> Recording:
        """A flight, written and read back."""
        return read(self.file(flight))


@pytest.fixture(autouse=True, scope="session")
def unhurried():
    """On a busy machine, too, chunks end where samples fill them."""
    kept, rerun_writer._LONGEST_WAIT_S = rerun_writer._LONGEST_WAIT_S, math.inf
    yield
    rerun_writer._LONGEST_WAIT_S = kept


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    """One for all tests of a file, for what they only read."""
    return Workshop(tmp_path_factory.mktemp("kept"))


@pytest.fixture
def workshop(tmp_path: Path) -> Workshop:
    return Workshop(tmp_path)


@pytest.fixture(scope="session")
def assert_same() -> Callable[[Recording, Flight], None]:
    """Checks that a recording holds a flight, field by field and to the bit."""

    def check(recording: Recording, flight: Flight) -> None:
        for name in flight.states[0]._fields:
            written = np.array([getattr(state, name) for state in flight.states])
            column = recording.state[name]
            assert np.array_equal(column, written.astype(column.dtype)), name
        assert np.array_equal(recording.state["lat_rad"], [state.lat_rad for state in flight.states])
        assert np.array_equal(recording.guidance["path_m"], [sample.path_m for sample in flight.guidance])
        assert np.all(recording.guidance["command_altitude_m"] == 1000.0)
        header, found = flight.header, recording.header
        for field in fields(header):
            if field.name != "reference":
                assert getattr(found, field.name) == getattr(header, field.name), field.name
        for field in fields(header.reference):
            ours, theirs = getattr(found.reference, field.name), getattr(header.reference, field.name)
            assert ours.dtype == theirs.dtype
            assert np.array_equal(ours, theirs), field.name

    return check
