"""What is in a recording: every topic, field, unit, frame and rate, once.

From it follow the protobuf messages (`galeway.proto`, by `make proto`), the columns of writers and readers,
and docs/recording.md (by `make pages`).

Units are the suffixes of field names, as everywhere in galeway (`_m _s _mps _rad _radps _kg`). Log times are
Unix nanoseconds: departure plus `time_s`.

Frames: `map` is the local plane of `planner.grid.LocalFrame`, x east and y north in its Mercator metres, z
the altitude above the ellipsoid; `base_link` is the aircraft, x forward, y left, z up.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from aircraft.state import ESTIMATED_FIELDS, Command, FlightState
from recordings.meanings import MEANINGS, unit_of
from recordings.recorder import GuidanceSample

SCHEMA_VERSION = 3
"""Raised whenever a reader of the old schema would misread the new one."""

SCHEMA_VERSIONS = {
    1: "one reference for each flight",
    2: "references that are laid anew in flight, each with the time from which on it was followed",
    3: "plans that change in flight, each with the time from which on it was in force",
}
"""All that can be read, with what came new."""

MAP_FRAME = "map"
BODY_FRAME = "base_link"

HEADER_METADATA = "galeway"
VERSIONS_METADATA = "versions"
PLAN_ATTACHMENT = "plan.json"
SCENARIO_ATTACHMENT = "scenario.toml"

SAMPLES_PER_CHUNK = 600
"""A minute at 10 Hz."""


class Rate(StrEnum):
    """How often a topic is written."""

    ONCE = "before take-off"
    STAGE = "once a stage"
    SAMPLE = "every sample, 10 Hz unless the scenario says otherwise"
    GUIDED = "every round of guidance, 5 Hz unless the scenario says otherwise"
    SECOND = "1 Hz"
    ISSUE = "before take-off, and whenever it is laid anew"
    FORECAST = "at every forecast that is issued in flight, where it replans"
    EVENT = "when it happens"


class Kind(StrEnum):
    """Type of a field. What tracking measures distances and times with is double."""

    DOUBLE = "double"
    FLOAT = "float"
    SMALL = "small"  # at most 127, so that it takes one byte
    WHOLE = "whole"
    TEXT = "string"
    BYTES = "bytes"

    @property
    def protobuf(self) -> str:
        """Its name in protobuf."""
        return "uint32" if self in (Kind.SMALL, Kind.WHOLE) else self.value


class Column(NamedTuple):
    """A field of a message of ours; its number is its place, counted from one.

    `step`: what is recorded is rounded to a multiple of it; zero for exact. `repeated`: a list of values.
    `optional`: it may be absent, as it is in recordings from before it came.
    """

    name: str
    kind: Kind
    step: float = 0.0
    repeated: bool = False
    optional: bool = False

    @property
    def unit(self) -> str:
        """The unit, empty where there is none."""
        return unit_of(self.name)

    @property
    def meaning(self) -> str:
        """What it says."""
        return MEANINGS[self.name]


_EXACT = {"time_s", "phase"}
_WIDE_STEPS = {
    "lat_rad": 2.0**-40,  # six micrometres
    "lon_rad": 2.0**-40,
    "altitude_m": 2.0**-16,
    "path_m": 2.0**-16,
}
_STEPS = {
    "m": 2.0**-10,  # a millimetre
    "s": 2.0**-10,
    "mps": 2.0**-10,
    "rad": 2.0**-18,  # 0.0002 degrees
    "radps": 2.0**-18,
    "kg": 2.0**-20,
}
"""By unit. Powers of two: what no instrument would tell is zero bits then, a third of a compressed file."""

_STEP_OF_TRAVEL = 2.0**-14


def _sampled(*names: str) -> tuple[Column, ...]:
    """Fields of what is written every sample."""
    return tuple(
        Column(name, Kind.SMALL)
        if name == "phase"
        else Column(name, Kind.DOUBLE, _WIDE_STEPS.get(name, 0.0))
        if name in _WIDE_STEPS or name in _EXACT
        else Column(name, Kind.FLOAT, _STEPS.get(name.rpartition("_")[2], _STEP_OF_TRAVEL))
        for name in names
    )


def _numbers(*names: str, repeated: bool = False) -> tuple[Column, ...]:
    return tuple(Column(name, Kind.DOUBLE, repeated=repeated) for name in names)


STATE_COLUMNS = _sampled(*FlightState._fields)
GUIDANCE_COLUMNS = _sampled(
    "time_s", *GuidanceSample._fields[:-1], *(f"command_{name}" for name in Command._fields)
)
ESTIMATE_COLUMNS = _sampled("time_s", *ESTIMATED_FIELDS)

_SEGMENT_ARRAYS = (
    "north_m",
    "east_m",
    "course_rad",
    "curvature",
    "length_m",
    "start_m",
    "start_time_s",
    "end_time_s",
    "start_altitude_m",
    "end_altitude_m",
    "scale",
)


class Message(NamedTuple):
    """A type of message of our own, for what Foxglove's schemas have no type for."""

    name: str
    content: str
    columns: tuple[Column, ...]


MESSAGES = (
    Message("galeway.State", "The aircraft at one moment: aircraft.state.FlightState.", STATE_COLUMNS),
    Message(
        "galeway.Guidance",
        "What guidance saw and asked for at one moment: recordings.recorder.GuidanceSample.",
        GUIDANCE_COLUMNS,
    ),
    Message(
        "galeway.Estimate",
        "What sensors and estimators made of a State: the fields of it that guidance does not see perfectly.",
        ESTIMATE_COLUMNS,
    ),
    Message(
        "galeway.Reference",
        "The flyable curve, an entry for each segment: aircraft.reference.Reference, in the plane whose "
        "origin is given. The first is of the whole plan; those laid anew begin where the aircraft is.",
        (
            *_numbers("origin_lat_rad", "origin_lon_rad"),
            *_numbers(*_SEGMENT_ARRAYS, repeated=True),
            Column("phase", Kind.WHOLE, repeated=True),
            *_numbers("waypoint_path_m", repeated=True),
            *_numbers("issued_s"),
        ),
    ),
    Message(
        "galeway.Plan",
        "What a forecast in flight did to the plan: recordings.recorder.PlanIssue. The first plan is an "
        "attachment.",
        (*_numbers("issued_s"), Column("reason", Kind.TEXT), Column("plan", Kind.BYTES)),
    ),
    Message(
        "galeway.Hazard",
        "The hazardous cells of one stage, and the wind at its start, at the altitude flown; between two "
        "levels the cells of all from one to the other, and the wind half-way.",
        (
            *_numbers("time_s"),
            Column("stage", Kind.WHOLE),
            *_numbers("threshold_mps", "south_rad", "west_rad", "north_step_rad", "east_step_rad"),
            Column("rows", Kind.WHOLE),
            Column("columns", Kind.WHOLE),
            Column("cells", Kind.BYTES),
            Column("wind_every", Kind.WHOLE),
            Column("wind", Kind.BYTES),
            Column("closed", Kind.BYTES),
            Column("altitude_m", Kind.DOUBLE, optional=True),
        ),
    ),
    Message(
        "galeway.Outcome",
        "How the flight ended.",
        (*_numbers("time_s"), Column("outcome", Kind.TEXT), Column("detail", Kind.TEXT)),
    ),
)


class Topic(NamedTuple):
    """One stream of messages. `message`: full name of its protobuf type; `frame`: of its positions."""

    name: str
    message: str
    rate: Rate
    frame: str
    content: str


_GEODETIC = "WGS84, north-east-down"
STATE = Topic("/state", "galeway.State", Rate.SAMPLE, _GEODETIC, "the aircraft, as simulated")
GUIDANCE = Topic("/guidance", "galeway.Guidance", Rate.SAMPLE, MAP_FRAME, "what guidance saw and asked for")
ESTIMATE = Topic(
    "/estimate", "galeway.Estimate", Rate.GUIDED, _GEODETIC, "what its sensors made of that, unless perfect"
)
REFERENCE = Topic("/reference", "galeway.Reference", Rate.ISSUE, MAP_FRAME, "the flyable curve, by segments")
PLAN = Topic("/plan", "foxglove.GeoJSON", Rate.ISSUE, "WGS84", "the planned route and all goals")
PLAN_PATH = Topic("/plan/path", "foxglove.PosesInFrame", Rate.ISSUE, MAP_FRAME, "the plan's waypoints")
PLAN_ISSUE = Topic(
    "/plan/issue", "galeway.Plan", Rate.FORECAST, "WGS84", "the plan after a forecast, and why it changed"
)
FORECAST_HAZARD = Topic(
    "/weather/forecast/hazard", "galeway.Hazard", Rate.STAGE, "WGS84", "hazardous cells as planned on"
)
TRUTH_HAZARD = Topic(
    "/weather/truth/hazard", "galeway.Hazard", Rate.STAGE, "WGS84", "hazardous cells as flown through"
)
TRUTH_GRID = Topic(
    "/weather/truth/grid",
    "foxglove.Grid",
    Rate.STAGE,
    MAP_FRAME,
    "true hazard (`hazard`, 0 or 1) and wind speed (`wind_speed_mps`, whole m/s) a cell, for the eyes",
)
POSITION = Topic("/position", "foxglove.LocationFix", Rate.SECOND, "WGS84", "where the aircraft is, degrees")
POSE = Topic("/pose", "foxglove.PoseInFrame", Rate.SECOND, MAP_FRAME, "position and attitude of the aircraft")
TRANSFORM = Topic("/tf", "foxglove.FrameTransform", Rate.SECOND, MAP_FRAME, "from map to base_link")
EVENTS = Topic(
    "/events", "foxglove.Log", Rate.EVENT, "", "departure, loiters, holds, forecasts, faults, warnings"
)
OUTCOME = Topic("/outcome", "galeway.Outcome", Rate.EVENT, "", "how the flight ended; the last message")

TOPICS = (
    STATE,
    GUIDANCE,
    ESTIMATE,
    REFERENCE,
    PLAN,
    PLAN_PATH,
    PLAN_ISSUE,
    FORECAST_HAZARD,
    TRUTH_HAZARD,
    TRUTH_GRID,
    POSITION,
    POSE,
    TRANSFORM,
    EVENTS,
    OUTCOME,
)

SAMPLED = {STATE: STATE_COLUMNS, GUIDANCE: GUIDANCE_COLUMNS, ESTIMATE: ESTIMATE_COLUMNS}
"""The topics that are read into columns."""
