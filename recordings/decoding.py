"""Makes a `Recording` of what was found in a file, or says what is wrong with it."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from google.protobuf.message import DecodeError
from numpy.typing import NDArray

from aircraft.path import Phase
from aircraft.reference import Reference
from planner.errors import PlannerError
from planner.grid import Grid, LocalFrame
from planner.plans import Plan
from recordings.content import Content
from recordings.errors import BadRecordingError
from recordings.fixed_layout import FixedLayout
from recordings.gaps import before_gap
from recordings.protobuf_types import message_type
from recordings.recorder import FlightHeader, Layer, Outcome, PlanIssue
from recordings.recording import Event, HazardSheet, Issue, Recording
from recordings.schema import (
    ESTIMATE,
    ESTIMATE_COLUMNS,
    EVENTS,
    FORECAST_HAZARD,
    GUIDANCE,
    GUIDANCE_COLUMNS,
    HEADER_METADATA,
    OUTCOME,
    PLAN_ATTACHMENT,
    PLAN_ISSUE,
    REFERENCE,
    SCENARIO_ATTACHMENT,
    SCHEMA_VERSIONS,
    STATE,
    STATE_COLUMNS,
    TRUTH_HAZARD,
    VERSIONS_METADATA,
    Column,
    Topic,
)
from recordings.wind_field import Thinned, filled

_Read = TypeVar("_Read")

_LONGEST_SHOWN = 60


def decode(content: Content, path: Path) -> Recording:
    """All of a recording that is intact.

    Args:
        content: what was found.
        path: where, for what is said of it.

    Raises:
        BadRecordingError: if it is no recording of ours, or too little of it is left: what was known before
            take-off and a sample of the flight are the least.
    """
    try:
        return before_gap(_recording(content), content.samples_before_damage)
    except BadRecordingError as error:
        damage = f"; {content.damage}" if content.damage else ""
        raise BadRecordingError(f"{path} cannot be checked: {error}{damage}; {remedy(path)}") from error


def remedy(path: Path) -> str:
    """What to do without a recording: take the one in the other format beside it, or fly again."""
    other = path.with_suffix({".mcap": ".rrd"}.get(path.suffix, ".mcap"))
    return f"take {other}, which lies beside it" if other != path and other.is_file() else "fly again"


def _recording(content: Content) -> Recording:
    if content.samples_before_damage == 0:
        raise BadRecordingError("how the flight began is lost")
    header = _header(content)
    state = _columns(content, STATE, STATE_COLUMNS)
    if not len(state):
        raise BadRecordingError("it has no sample of the flight")
    guidance = _columns(content, GUIDANCE, GUIDANCE_COLUMNS)
    hazards = [
        _hazard(message, layer)
        for topic, layer in ((FORECAST_HAZARD, Layer.FORECAST), (TRUTH_HAZARD, Layer.TRUTH))
        for message in _messages(content, topic)
    ]
    outcomes = _messages(content, OUTCOME)
    last_s = float(state["time_s"][-1])
    outcome = _parsed("outcome", Outcome, outcomes[-1].outcome) if outcomes else Outcome.INCOMPLETE
    detail = outcomes[-1].detail if outcomes else "the recording just stops"
    missing = [content.damage] if content.damage else []
    if not outcomes:
        missing.append(f"how the flight ended; the last sample is at {last_s:.1f} s")
    elif outcome is Outcome.INCOMPLETE:
        missing.append(f"{detail}; the last sample is at {last_s:.1f} s")
    return Recording(
        header=header,
        state=state,
        guidance=guidance,
        references=_references(content, header),
        plans=_plans(content, header),
        estimate=_columns(content, ESTIMATE, ESTIMATE_COLUMNS),
        hazards=tuple(hazards),
        events=tuple(_event(message, header.plan.departure_s) for message in _messages(content, EVENTS)),
        outcome=outcome,
        outcome_detail=detail,
        end_time_s=outcomes[-1].time_s if outcomes else last_s,
        missing="; ".join(missing),
    )


def _header(content: Content) -> FlightHeader:
    metadata = content.metadata.get(HEADER_METADATA)
    if metadata is None:
        raise BadRecordingError("it is not a recording of galeway")
    schema = metadata.get("schema", "")
    if schema not in map(str, SCHEMA_VERSIONS):
        readable = " and ".join(map(str, SCHEMA_VERSIONS))
        found = _shown(schema) if schema else "unknown"
        raise BadRecordingError(f"it has schema {found}, and this galeway reads {readable}")

    def number(name: str) -> float:
        return _parsed(name, float, metadata.get(name, "missing"))

    def whole(name: str) -> int:
        return _parsed(name, int, metadata.get(name, "missing"))

    try:
        grid = Grid(
            number("grid_south_rad"),
            number("grid_west_rad"),
            number("grid_north_step_rad"),
            number("grid_east_step_rad"),
            whole("grid_rows"),
            whole("grid_columns"),
        )
        plan = Plan.from_json(_attachment(content, PLAN_ATTACHMENT))
    except PlannerError as error:
        raise BadRecordingError(f"its grid or plan makes no sense: {error}") from error
    return FlightHeader(
        scenario=metadata.get("scenario", ""),
        scenario_toml=_attachment(content, SCENARIO_ATTACHMENT).decode(errors="replace"),
        seed=whole("seed"),
        grid=grid,
        plan=plan,
        reference=_first_reference(content, grid.frame),
        threshold_mps=number("threshold_mps"),
        stage_s=number("stage_s"),
        airspeed_min_mps=number("airspeed_min_mps"),
        airspeed_max_mps=number("airspeed_max_mps"),
        limits=_parsed("limits", _texts, metadata.get("limits", "missing")),
        also=_parsed("also", _texts, metadata.get("also", "[]")),
        versions=content.metadata.get(VERSIONS_METADATA, {}),
    )


def _parsed(name: str, parse: Callable[[str], _Read], text: str) -> _Read:
    try:
        return parse(text)
    except ValueError as error:
        raise BadRecordingError(f"its {name} is {_shown(text)}") from error


def _shown(text: str) -> str:
    """What stands in a file, in one line and not too long."""
    return repr(text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}…")


def _texts(text: str) -> tuple[str, ...]:
    texts = json.loads(text)
    if not isinstance(texts, list) or not all(isinstance(item, str) for item in texts):
        raise ValueError(text)
    return tuple(texts)


def _attachment(content: Content, name: str) -> bytes:
    if name not in content.attachments:
        raise BadRecordingError(f"{name} is missing from it")
    return content.attachments[name]


def _first_reference(content: Content, frame: LocalFrame) -> Reference:
    found = _messages(content, REFERENCE)
    if not found:
        raise BadRecordingError("the reference is missing from it")
    return _reference(found[0], frame)


def _references(content: Content, header: FlightHeader) -> tuple[Issue, ...]:
    """The first, which has no time of issue in old recordings, and those laid anew."""
    first = Issue(float(header.reference.start_time_s[0]), header.reference)
    later = _messages(content, REFERENCE)[1:]
    return (first, *(Issue(message.issued_s, _reference(message, header.grid.frame)) for message in later))


def _plans(content: Content, header: FlightHeader) -> tuple[PlanIssue, ...]:
    """The first, which old recordings have alone, and what forecasts made of it.

    A file may end between a plan and its reference; such a plan was never followed.
    """
    plans = [PlanIssue(float(header.reference.start_time_s[0]), "before take-off", header.plan, True)]
    followed_s = {message.issued_s for message in _messages(content, REFERENCE)}
    for message in _messages(content, PLAN_ISSUE):
        if message.plan and message.issued_s not in followed_s:
            break
        try:
            plan = Plan.from_json(message.plan) if message.plan else plans[-1].plan
        except PlannerError as error:
            raise BadRecordingError(f"a plan made in flight makes no sense: {error}") from error
        plans.append(PlanIssue(message.issued_s, message.reason, plan, bool(message.plan)))
    return tuple(plans)


def _reference(message: Any, frame: LocalFrame) -> Reference:
    if (message.origin_lat_rad, message.origin_lon_rad) != (frame.origin_lat_rad, frame.origin_lon_rad):
        raise BadRecordingError("its reference lies in another plane than its grid")
    arrays = {field.name: np.array(getattr(message, field.name)) for field in fields(Reference)}
    lengths = {len(array) for name, array in arrays.items() if name != "waypoint_path_m"}
    if len(lengths) != 1 or 0 in lengths:
        raise BadRecordingError(f"its reference has columns of {sorted(lengths)} segments")
    unknown = set(message.phase) - set(map(int, Phase))
    if unknown:
        raise BadRecordingError(f"its reference has a segment of phase {min(unknown)}, which there is not")
    return Reference(**arrays | {"phase": arrays["phase"].astype(np.int64)})


def _hazard(message: Any, layer: Layer) -> HazardSheet:
    try:
        grid = Grid(
            message.south_rad,
            message.west_rad,
            message.north_step_rad,
            message.east_step_rad,
            message.rows,
            message.columns,
        )
    except PlannerError as error:
        raise BadRecordingError(f"the grid of a hazard makes no sense: {error}") from error
    hazard = _cells(message.cells, grid)
    sheet = HazardSheet(layer, message.stage, message.time_s, message.threshold_mps, grid, hazard)
    if message.closed:
        sheet = replace(sheet, closed=_cells(message.closed, grid))
    if message.HasField("altitude_m"):
        sheet = replace(sheet, altitude_m=message.altitude_m)
    if not message.wind_every:
        return sheet
    north_mps, east_mps = filled(Thinned(message.wind_every, message.wind), grid.shape)
    return replace(sheet, wind_north_mps=north_mps, wind_east_mps=east_mps)


def _cells(packed: bytes, grid: Grid) -> NDArray[np.bool_]:
    cells, count = np.frombuffer(packed, np.uint8), grid.rows * grid.columns
    if len(cells) != (count + 7) // 8:
        raise BadRecordingError(f"a hazard of {grid.shape} cells has {len(cells)} bytes of them")
    return np.unpackbits(cells, count=count).astype(np.bool_).reshape(grid.shape)


def _event(message: Any, departure_s: float) -> Event:
    time_ns = message.timestamp.seconds * 1_000_000_000 + message.timestamp.nanos
    return Event((time_ns - round(departure_s * 1e9)) / 1e9, message.message)


def _columns(content: Content, topic: Topic, columns: Sequence[Column]) -> NDArray[np.void]:
    """The messages of a topic as a structured array: at once if they are laid out as galeway writes them."""
    if topic.name in content.columns:
        return content.columns[topic.name]
    layout = FixedLayout(columns)
    rows = layout.parse(_payloads(content, topic))
    if rows is not None:
        return rows
    names = [column.name for column in columns]
    messages = _messages(content, topic)
    return np.array([tuple(getattr(message, name) for name in names) for message in messages], layout.values)


def _messages(content: Content, topic: Topic) -> list[Any]:
    parse = message_type(topic.message).FromString
    try:
        return [parse(payload) for payload in _payloads(content, topic)]
    except DecodeError as error:
        raise BadRecordingError(f"a message on {topic.name} is not a {topic.message}: {error}") from error


def _payloads(content: Content, topic: Topic) -> list[bytes]:
    found = content.types.get(topic.name, topic.message)
    if found != topic.message:
        raise BadRecordingError(f"{topic.name} holds {_shown(found)}, not {topic.message}")
    return content.messages.get(topic.name, [])
