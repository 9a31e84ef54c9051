"""What is in a recording: every topic, field, unit, frame and rate, once; the writer and the reader obey it.

Units are the suffixes of field names, as everywhere in galeway (`_m _s _mps _rad _radps _kg`); control
surfaces and throttle are shares of full travel. Log times are Unix nanoseconds: departure plus `time_s`.

Frames: `map` is the local plane of `planner.grid.LocalFrame`, x east and y north in its Mercator metres, z
the altitude above the ellipsoid; `base_link` is the aircraft, x forward, y left, z up.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from aircraft.state import ESTIMATED_FIELDS, Command, FlightState
from recordings.recorder import GuidanceSample

SCHEMA_VERSION = 1
"""Raised whenever a reader of the old schema would misread the new one."""

MAP_FRAME = "map"
BODY_FRAME = "base_link"

HEADER_METADATA = "galeway"
VERSIONS_METADATA = "versions"
PLAN_ATTACHMENT = "plan.json"
SCENARIO_ATTACHMENT = "scenario.toml"

SAMPLES_PER_CHUNK = 600
"""A minute at 10 Hz: what a killed flight loses at most."""


class Rate(StrEnum):
    """How often a topic is written."""

    ONCE = "before take-off"
    STAGE = "once a stage"
    SAMPLE = "every sample, 10 Hz unless the scenario says otherwise"
    SECOND = "1 Hz"
    EVENT = "when it happens"


class Topic(NamedTuple):
    """One stream of messages. `message`: full name of its protobuf type; `frame`: of its positions."""

    name: str
    message: str
    rate: Rate
    frame: str
    content: str


STATE = Topic("/state", "galeway.State", Rate.SAMPLE, "WGS84, north-east-down", "the aircraft, as simulated")
GUIDANCE = Topic("/guidance", "galeway.Guidance", Rate.SAMPLE, MAP_FRAME, "what guidance saw and asked for")
ESTIMATE = Topic(
    "/estimate",
    "galeway.Estimate",
    Rate.SAMPLE,
    "WGS84, north-east-down",
    "what its sensors made of that, unless perfect",
)
REFERENCE = Topic("/reference", "galeway.Reference", Rate.ONCE, MAP_FRAME, "the flyable curve, by segments")
PLAN = Topic("/plan", "foxglove.GeoJSON", Rate.ONCE, "WGS84", "the planned route and all goals")
PLAN_PATH = Topic("/plan/path", "foxglove.PosesInFrame", Rate.ONCE, MAP_FRAME, "the plan's waypoints")
FORECAST_HAZARD = Topic(
    "/weather/forecast/hazard", "galeway.Hazard", Rate.STAGE, "WGS84", "hazardous cells as planned on"
)
TRUTH_HAZARD = Topic(
    "/weather/truth/hazard", "galeway.Hazard", Rate.STAGE, "WGS84", "hazardous cells as flown through"
)
TRUTH_GRID = Topic(
    "/weather/truth/grid", "foxglove.Grid", Rate.STAGE, MAP_FRAME, "true hazard and wind speed, for the eyes"
)
POSITION = Topic("/position", "foxglove.LocationFix", Rate.SECOND, "WGS84", "where the aircraft is")
POSE = Topic("/pose", "foxglove.PoseInFrame", Rate.SECOND, MAP_FRAME, "position and attitude of the aircraft")
TRANSFORM = Topic("/tf", "foxglove.FrameTransform", Rate.SECOND, MAP_FRAME, "from map to base_link")
EVENTS = Topic("/events", "foxglove.Log", Rate.EVENT, "", "phases, stages, warnings")
OUTCOME = Topic("/outcome", "galeway.Outcome", Rate.EVENT, "", "how the flight ended; the last message")

TOPICS = (
    STATE,
    GUIDANCE,
    ESTIMATE,
    REFERENCE,
    PLAN,
    PLAN_PATH,
    FORECAST_HAZARD,
    TRUTH_HAZARD,
    TRUTH_GRID,
    POSITION,
    POSE,
    TRANSFORM,
    EVENTS,
    OUTCOME,
)


class Kind(StrEnum):
    """Protobuf type of a column. What tracking measures distances and times with is double."""

    DOUBLE = "double"
    FLOAT = "float"
    SMALL = "uint32"  # at most 127, so that it takes one byte


class Column(NamedTuple):
    """A field of a message that is written every sample; its number is its place, counted from one.

    `step`: what is recorded is rounded to a multiple of it; zero for exact.
    """

    name: str
    kind: Kind
    step: float


_WIDE_STEPS = {
    "time_s": 0.0,
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


def _column(name: str) -> Column:
    if name == "phase":
        return Column(name, Kind.SMALL, 0.0)
    if name in _WIDE_STEPS:
        return Column(name, Kind.DOUBLE, _WIDE_STEPS[name])
    return Column(name, Kind.FLOAT, _STEPS.get(name.rpartition("_")[2], _STEP_OF_TRAVEL))


def _columns(names: tuple[str, ...]) -> tuple[Column, ...]:
    return tuple(map(_column, names))


STATE_COLUMNS = _columns(FlightState._fields)
GUIDANCE_COLUMNS = _columns(
    ("time_s", *GuidanceSample._fields[:-1], *(f"command_{name}" for name in Command._fields))
)
ESTIMATE_COLUMNS = tuple(column for column in STATE_COLUMNS if column.name in {"time_s", *ESTIMATED_FIELDS})
