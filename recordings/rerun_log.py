"""The log of a flight in the Rerun file: all that the MCAP file tells of it, on entities that no view shows.

Samples are columns, see `rerun_columns`; every other message of ours is the same protobuf bytes as in the
MCAP file, in a component `message` of an entity named like its topic, under `/log`. What is known before
take-off is static. The Rerun file has no checksums of its own, so the last row holds counts and checksums of
all that came before.
"""

from __future__ import annotations

import json
import zlib

import numpy as np
import pyarrow as pa
import rerun as rr
from numpy.typing import NDArray

from aircraft.reference import Reference
from aircraft.state import FlightState
from recordings import messages
from recordings.recorder import FlightHeader, Layer, Outcome, PlanIssue, WeatherSheet
from recordings.rerun_columns import SampleColumns
from recordings.rerun_entities import HEADER_ENTITY, MESSAGE, METADATA, SUMS, entity_of
from recordings.rerun_times import FlightTimes
from recordings.schema import (
    EVENTS,
    FORECAST_HAZARD,
    HEADER_METADATA,
    OUTCOME,
    PLAN_ATTACHMENT,
    PLAN_ISSUE,
    REFERENCE,
    SCENARIO_ATTACHMENT,
    TRUTH_HAZARD,
    VERSIONS_METADATA,
    Topic,
)

Floats = NDArray[np.float64]


class RerunLog:
    """Writes the log to a stream, from the header that it is made with to `finish`."""

    def __init__(self, stream: rr.RecordingStream, header: FlightHeader, times: FlightTimes) -> None:
        self._stream, self._header, self._times = stream, header, times
        self._columns = SampleColumns(times)
        self._sums: dict[str, list[int]] = {}
        metadata = {
            HEADER_METADATA: messages.header_metadata(header),
            VERSIONS_METADATA: dict(sorted(header.versions.items())),
        }
        parts = {
            METADATA: json.dumps(metadata).encode(),
            SCENARIO_ATTACHMENT: header.scenario_toml.encode(),
            PLAN_ATTACHMENT: header.plan.to_json(),
        }
        columns = [_column("galeway.Header", name, part) for name, part in parts.items()]
        self._stream.send_columns(HEADER_ENTITY, [], columns)
        self._sums[HEADER_ENTITY] = [1, zlib.crc32(b"".join(parts.values()))]
        self.reference(float(header.reference.start_time_s[0]), header.reference)

    def samples(self, state: Floats, guidance: Floats) -> None:
        """Write samples, columns as in `schema.STATE_COLUMNS` and `schema.GUIDANCE_COLUMNS`."""
        self._columns.write(self._stream, state, guidance)

    def estimate(self, seen: FlightState) -> None:
        """Take what was made of the last moment."""
        self._columns.add_estimate(seen)

    def weather(self, sheet: WeatherSheet) -> None:
        """Write the hazards of a stage."""
        topic = TRUTH_HAZARD if sheet.layer is Layer.TRUTH else FORECAST_HAZARD
        message = messages.hazard_message(sheet, self._header.grid, self._header.threshold_mps)
        self._add(topic, sheet.time_s, message)

    def reference(self, time_s: float, reference: Reference) -> None:
        """Write a reference, followed from a time on."""
        message = messages.reference_message(reference, self._header.grid.frame, time_s)
        self._add(REFERENCE, time_s, message)

    def plan(self, issue: PlanIssue) -> None:
        """Write what a forecast did to the plan."""
        self._add(PLAN_ISSUE, issue.time_s, messages.plan_issue_message(issue))

    def event(self, time_s: float, text: str) -> None:
        """Write an event."""
        log_time = round(self._header.plan.departure_s * 1e9) + round(time_s * 1e9)
        self._add(EVENTS, time_s, messages.event_message(log_time, text))

    def finish(self, time_s: float, outcome: Outcome, detail: str) -> None:
        """Write how the flight ended, and what of it there is; all samples have to be written."""
        message = messages.outcome_message(time_s, outcome, detail)
        ended = {OUTCOME.name: [1, zlib.crc32(message)]}
        sums = json.dumps(self._sums | self._columns.sums | ended).encode()
        columns = [_column(OUTCOME.message, MESSAGE, message), _column(OUTCOME.message, SUMS, sums)]
        self._stream.send_columns(
            entity_of(OUTCOME), self._times.since_departure(np.array([time_s])), columns
        )

    def _add(self, topic: Topic, time_s: float, message: bytes) -> None:
        count, checksum = self._sums.get(topic.name, (0, 0))
        self._sums[topic.name] = [count + 1, zlib.crc32(message, checksum)]
        column = _column(topic.message, MESSAGE, message)
        self._stream.send_columns(entity_of(topic), self._times.since_departure(np.array([time_s])), [column])


def _column(archetype: str, name: str, value: bytes) -> rr.ComponentColumn:
    """A component of one row."""
    descriptor = rr.ComponentDescriptor(name).with_builtin_archetype(archetype)
    return rr.ComponentColumn(descriptor, _Blob(value))


class _Blob:
    """Bytes, in the form that Rerun asks for."""

    def __init__(self, value: bytes) -> None:
        self._value = value

    def as_arrow_array(self) -> pa.Array:
        """The bytes in Arrow's form."""
        return pa.array([self._value], pa.large_binary())
