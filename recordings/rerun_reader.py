"""Reads a recording back from a Rerun file, by the log in it (see `rerun_log`)."""

from __future__ import annotations

import json
import mmap
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from recordings.content import Content
from recordings.decoding import decode, remedy
from recordings.errors import BadRecordingError
from recordings.fixed_layout import FixedLayout
from recordings.recording import Recording
from recordings.rerun_entities import HEADER_ENTITY, MESSAGE, MESSAGE_TOPICS, METADATA, SUMS, entity_of
from recordings.rerun_frames import MAGIC, DamagedError, tables
from recordings.schema import OUTCOME, PLAN_ATTACHMENT, SAMPLED, SCENARIO_ATTACHMENT, Column
from recordings.unreadable import unreadable

Tables = dict[str, list[pa.RecordBatch]]

_ENTITY = b"rerun:entity_path"
_ROW_ID = "rerun.controls.RowId"
_MISSHAPEN = (ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError, pa.ArrowException)


def read(path: Path) -> Recording:
    """Read all of a recording that is intact.

    Raises:
        BadRecordingError: see `take_apart` and `decoding.decode`.
    """
    return decode(take_apart(path), path)


def take_apart(path: Path) -> Content:
    """Find the log in a Rerun file, and compare it with its counts and checksums.

    Raises:
        BadRecordingError: if the file cannot be read, or its log makes no sense.
    """
    try:
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise BadRecordingError(f"{path} is not a Rerun file; give the recording of a flight, *.rrd")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                return _content(path, *_collect(content))
    except OSError as error:
        raise unreadable(path, error) from error


def _collect(content: mmap.mmap) -> tuple[Tables, str]:
    """The tables of the log by entity, and what ended them early."""
    found: Tables = {HEADER_ENTITY: []} | {entity_of(topic): [] for topic in (*SAMPLED, *MESSAGE_TOPICS)}
    try:
        for table in tables(content):
            entity = (table.schema.metadata or {}).get(_ENTITY, b"").decode(errors="replace")
            if entity in found:
                found[entity].append(table)
    except DamagedError as error:
        return found, str(error)
    return found, ""


def _content(path: Path, found: Tables, damage: str) -> Content:
    try:
        ordered = {entity: sorted(parts, key=_first_row) for entity, parts in found.items()}
        header = _header(ordered[HEADER_ENTITY])
        messages = {topic.name: _blobs(ordered[entity_of(topic)], MESSAGE) for topic in MESSAGE_TOPICS}
        columns = {topic.name: _columns(ordered[topic.name], fields) for topic, fields in SAMPLED.items()}
        sums = _blobs(ordered[entity_of(OUTCOME)], SUMS)
        metadata = json.loads(header.get(METADATA, b"{}"))
        difference = _difference(json.loads(sums[-1]), header, messages, columns) if sums else ""
    except _MISSHAPEN as error:
        raise BadRecordingError(
            f"the log in {path} makes no sense ({error!r:.100}); {remedy(path)}"
        ) from error
    return Content(
        messages={topic: found for topic, found in messages.items() if found},
        types={topic.name: topic.message for topic in (*SAMPLED, *MESSAGE_TOPICS)},
        metadata=metadata,
        attachments={name: part for name, part in header.items() if name != METADATA},
        damage="; ".join(filter(None, (damage, difference))),
        columns=columns,
    )


def _difference(
    sums: Mapping[str, list[int]],
    header: Mapping[str, bytes],
    messages: Mapping[str, list[bytes]],
    columns: Mapping[str, NDArray[np.void]],
) -> str:
    """What is not as the writer counted it, empty if nothing."""
    found = {
        HEADER_ENTITY: [1, zlib.crc32(b"".join(header.values()))],
        **{topic: [len(parts), zlib.crc32(b"".join(parts))] for topic, parts in messages.items() if parts},
        **{topic: [len(rows), zlib.crc32(rows.tobytes())] for topic, rows in columns.items() if len(rows)},
    }
    for topic in sorted({*sums, *found}):
        count, checksum = found.get(topic, [0, 0])
        expected, expected_checksum = sums.get(topic, [0, 0])
        if count != expected:
            return f"{count} messages of {topic}, where {expected} were written"
        if checksum != expected_checksum:
            return f"the checksum of {topic} is wrong"
    return ""


def _first_row(table: pa.RecordBatch) -> bytes:
    """Row ids rise in the order of writing."""
    first: bytes = table.column(_ROW_ID)[0].as_py()
    return first


def _header(tables: list[pa.RecordBatch]) -> dict[str, bytes]:
    parts = {name: _blobs(tables, name) for name in (METADATA, SCENARIO_ATTACHMENT, PLAN_ATTACHMENT)}
    return {name: found[0] for name, found in parts.items() if found}


def _blobs(tables: list[pa.RecordBatch], component: str) -> list[bytes]:
    """The values of a component, in the order of their rows."""
    found: list[bytes] = []
    for table in tables:
        for name in table.schema.names:
            if name.endswith(f":{component}"):
                found.extend(table.column(name).flatten().to_pylist())
    return found


def _columns(tables: list[pa.RecordBatch], fields: tuple[Column, ...]) -> NDArray[np.void]:
    """A sampled topic as a structured array."""
    rows = np.empty(sum(table.num_rows for table in tables), FixedLayout(fields).values)
    for field in fields:
        begin = 0
        for table in tables:
            (name,) = (name for name in table.schema.names if name.endswith(f":{field.name}"))
            values = table.column(name).flatten().to_numpy()
            if len(values) != table.num_rows:
                raise ValueError(f"{len(values)} values of {field.name} in {table.num_rows} rows")
            rows[field.name][begin : begin + len(values)] = values
            begin += len(values)
    return rows
