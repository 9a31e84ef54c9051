"""Every sample of a flight as typed columns in the Rerun file, the same fields as in the MCAP file."""

from __future__ import annotations

import zlib

import numpy as np
import pyarrow as pa  # what rerun keeps its columns in
import rerun as rr
from numpy.typing import NDArray

from aircraft.state import FlightState
from recordings.fixed_layout import FixedLayout
from recordings.rerun_times import FlightTimes
from recordings.samples import ESTIMATE_PLACES, rounded
from recordings.schema import (
    ESTIMATE,
    ESTIMATE_COLUMNS,
    GUIDANCE,
    GUIDANCE_COLUMNS,
    STATE,
    STATE_COLUMNS,
    Column,
    Kind,
    Topic,
)

Floats = NDArray[np.float64]

COLUMN_TYPES = {Kind.DOUBLE: np.float64, Kind.FLOAT: np.float32, Kind.SMALL: np.uint32}


class SampleColumns:
    """Writes samples to the entities named like the topics, a chunk at a time."""

    def __init__(self, times: FlightTimes) -> None:
        self._times = times
        self._estimates: list[FlightState] = []
        self.sums: dict[str, list[int]] = {}
        """Of each topic the number of rows written, and the checksum of their bytes, `FixedLayout.values`."""

    def add_estimate(self, seen: FlightState) -> None:
        """Take what was made of the last sample."""
        self._estimates.append(seen)

    def write(self, stream: rr.RecordingStream, state: Floats, guidance: Floats) -> None:
        """Write samples, columns as `STATE_COLUMNS` and `GUIDANCE_COLUMNS`, and what was made of them."""
        if len(state):  # the viewer fails on an empty chunk
            self._send(stream, STATE, STATE_COLUMNS, state)
            self._send(stream, GUIDANCE, GUIDANCE_COLUMNS, guidance)
        if self._estimates:
            estimates, self._estimates = np.array(self._estimates), []
            table = rounded(estimates[:, ESTIMATE_PLACES], ESTIMATE_COLUMNS)
            self._send(stream, ESTIMATE, ESTIMATE_COLUMNS, table)

    def _send(
        self,
        stream: rr.RecordingStream,
        topic: Topic,
        columns: tuple[Column, ...],
        table: Floats,
    ) -> None:
        rows = FixedLayout(columns).rows(table)
        count, checksum = self.sums.get(topic.name, (0, 0))
        self.sums[topic.name] = [count + len(rows), zlib.crc32(rows.tobytes(), checksum)]
        offsets = np.arange(len(table) + 1, dtype=np.int32)  # one value a row
        stream.send_columns(
            topic.name,
            self._times.since_departure(table[:, 0]),
            [
                rr.ComponentColumn(
                    rr.ComponentDescriptor(column.name).with_builtin_archetype(topic.message),
                    _Values(rows[column.name], column.kind),
                    offsets=offsets,
                )
                for column in columns
            ],
        )


class _Values:
    """Numbers of one kind, in the form that Rerun asks for."""

    def __init__(self, values: NDArray[np.generic], kind: Kind) -> None:
        self._array = pa.array(np.ascontiguousarray(values, dtype=COLUMN_TYPES[kind]))

    def as_arrow_array(self) -> pa.Array:
        """The values in Arrow's form."""
        return self._array
