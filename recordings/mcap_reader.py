"""Reads a recording back from MCAP, also one that was cut off."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from google.protobuf.message import DecodeError
from numpy.typing import NDArray

from aircraft.reference import Reference
from planner.errors import PlannerError
from planner.grid import Grid, LocalFrame
from planner.plans import Plan
from recordings.errors import BadRecordingError
from recordings.fixed_layout import FixedLayout
from recordings.mcap_stream import McapContent, take_apart
from recordings.protobuf_types import message_type
from recordings.recorder import FlightHeader, Layer, Outcome
from recordings.recording import Event, HazardSheet, Recording
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
    REFERENCE,
    SCENARIO_ATTACHMENT,
    SCHEMA_VERSION,
    STATE,
    STATE_COLUMNS,
    TRUTH_HAZARD,
    VERSIONS_METADATA,
    Column,
    Topic,
)

_Read = TypeVar("_Read")


def read(path: Path) -> Recording:
    """Read all of a recording that is intact.

    Raises:
        BadRecordingError: if the file is no recording of ours, or too little of it is left: what was known
            before take-off and a sample of the flight are the least.
    """
    if path.suffix == ".rrd":
        raise BadRecordingError(
            f"{path} is a Rerun recording, which is for the eyes; what is checked is the MCAP recording "
            f"beside it, such as {path.with_suffix('.mcap')}"
        )
    content = take_apart(path)
    try:
        return _recording(content)
    except BadRecordingError as error:
        damage = f"; {content.damage}" if content.damage else ""
        raise BadRecordingError(f"{path} cannot be checked: {error}{damage}; fly again") from error


def _recording(content: McapContent) -> Recording:
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
    missing = [content.damage] if content.damage else []
    if not outcomes:
        missing.append(f"how the flight ended; the last sample is at {last_s:.1f} s")
    return Recording(
        header=header,
        state=state,
        guidance=guidance,
        estimate=_columns(content, ESTIMATE, ESTIMATE_COLUMNS),
        hazards=tuple(hazards),
        events=tuple(_event(message, header.plan.departure_s) for message in _messages(content, EVENTS)),
        outcome=_parsed("outcome", Outcome, outcomes[-1].outcome) if outcomes else Outcome.INCOMPLETE,
        outcome_detail=outcomes[-1].detail if outcomes else "the recording just stops",
        end_time_s=outcomes[-1].time_s if outcomes else last_s,
        missing="; ".join(missing),
    )


def _header(content: McapContent) -> FlightHeader:
    metadata = content.metadata.get(HEADER_METADATA)
    if metadata is None:
        raise BadRecordingError("it is not a recording of galeway")
    schema = metadata.get("schema", "")
    if schema != str(SCHEMA_VERSION):
        raise BadRecordingError(
            f"it has schema {schema or 'unknown'}, and this galeway reads {SCHEMA_VERSION}"
        )

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
        reference=_reference(content, grid.frame),
        threshold_mps=number("threshold_mps"),
        stage_s=number("stage_s"),
        airspeed_min_mps=number("airspeed_min_mps"),
        airspeed_max_mps=number("airspeed_max_mps"),
        limits=_parsed("limits", _texts, metadata.get("limits", "missing")),
        versions=content.metadata.get(VERSIONS_METADATA, {}),
    )


def _parsed(name: str, parse: Callable[[str], _Read], text: str) -> _Read:
    try:
        return parse(text)
    except ValueError as error:
        raise BadRecordingError(f"its {name} is {text!r}") from error


def _texts(text: str) -> tuple[str, ...]:
    texts = json.loads(text)
    if not isinstance(texts, list) or not all(isinstance(item, str) for item in texts):
        raise ValueError(text)
    return tuple(texts)


def _attachment(content: McapContent, name: str) -> bytes:
    if name not in content.attachments:
        raise BadRecordingError(f"{name} is missing from it")
    return content.attachments[name]


def _reference(content: McapContent, frame: LocalFrame) -> Reference:
    found = _messages(content, REFERENCE)
    if not found:
        raise BadRecordingError("the reference is missing from it")
    message = found[0]
    if (message.origin_lat_rad, message.origin_lon_rad) != (frame.origin_lat_rad, frame.origin_lon_rad):
        raise BadRecordingError("its reference lies in another plane than its grid")
    arrays = {field.name: np.array(getattr(message, field.name)) for field in fields(Reference)}
    lengths = {len(array) for name, array in arrays.items() if name != "waypoint_path_m"}
    if len(lengths) != 1 or 0 in lengths:
        raise BadRecordingError(f"its reference has columns of {sorted(lengths)} segments")
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
    cells = np.frombuffer(message.cells, np.uint8)
    count = grid.rows * grid.columns
    if len(cells) != (count + 7) // 8:
        raise BadRecordingError(f"a hazard of {grid.shape} cells has {len(cells)} bytes of them")
    hazard = np.unpackbits(cells, count=count).astype(np.bool_).reshape(grid.shape)
    return HazardSheet(layer, message.stage, message.time_s, message.threshold_mps, grid, hazard)


def _event(message: Any, departure_s: float) -> Event:
    time_ns = message.timestamp.seconds * 1_000_000_000 + message.timestamp.nanos
    return Event((time_ns - round(departure_s * 1e9)) / 1e9, message.message)


def _columns(content: McapContent, topic: Topic, columns: Sequence[Column]) -> NDArray[np.void]:
    """The messages of a topic as a structured array: at once if they are laid out as galeway writes them."""
    layout = FixedLayout(columns)
    rows = layout.parse(_payloads(content, topic))
    if rows is not None:
        return rows
    names = [column.name for column in columns]
    messages = _messages(content, topic)
    return np.array([tuple(getattr(message, name) for name in names) for message in messages], layout.values)


def _messages(content: McapContent, topic: Topic) -> list[Any]:
    parse = message_type(topic.message).FromString
    try:
        return [parse(payload) for payload in _payloads(content, topic)]
    except DecodeError as error:
        raise BadRecordingError(f"a message on {topic.name} is not a {topic.message}: {error}") from error


def _payloads(content: McapContent, topic: Topic) -> list[bytes]:
    found = content.types.get(topic.name, topic.message)
    if found != topic.message:
        raise BadRecordingError(f"{topic.name} holds {found}, not {topic.message}")
    return content.messages.get(topic.name, [])
