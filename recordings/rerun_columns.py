"""Every sample of a flight as typed columns in the Rerun file, the same fields as in the MCAP file."""

from __future__ import annotations

import numpy as np
import pyarrow as pa  # what rerun keeps its columns in
import rerun as rr
from numpy.typing import NDArray

from aircraft.state import FlightState
from recordings.recorder import GuidanceSample
from recordings.rerun_times import FlightTimes
from recordings.samples import Samples
from recordings.schema import GUIDANCE, GUIDANCE_COLUMNS, STATE, STATE_COLUMNS, Column, Kind, Topic

SAMPLES_PER_CHUNK = 600
"""A minute at 10 Hz: what a killed flight loses at most."""

_TYPES = {Kind.DOUBLE: np.float64, Kind.FLOAT: np.float32, Kind.SMALL: np.uint32}


class SampleColumns:
    """Collects samples and writes them to the entities named like the topics, a chunk at a time."""

    def __init__(self, times: FlightTimes) -> None:
        self._times = times
        self._samples = Samples()

    def add(self, state: FlightState, guidance: GuidanceSample) -> bool:
        """Take one sample; True if a chunk is full and has to be written."""
        return self._samples.add(state, guidance) >= SAMPLES_PER_CHUNK

    def write(self, stream: rr.RecordingStream) -> None:
        """Write what was collected."""
        if not len(self._samples):
            return  # the viewer fails on an empty chunk
        state, guidance = self._samples.take()
        self._send(stream, STATE, STATE_COLUMNS, state)
        self._send(stream, GUIDANCE, GUIDANCE_COLUMNS, guidance)

    def _send(
        self,
        stream: rr.RecordingStream,
        topic: Topic,
        columns: tuple[Column, ...],
        table: NDArray[np.float64],
    ) -> None:
        offsets = np.arange(len(table) + 1, dtype=np.int32)  # one value a row
        stream.send_columns(
            topic.name,
            self._times.since_departure(table[:, 0]),
            [
                rr.ComponentColumn(
                    rr.ComponentDescriptor(column.name).with_builtin_archetype(topic.message),
                    _Values(values, column.kind),
                    offsets=offsets,
                )
                for column, values in zip(columns, table.T, strict=True)
            ],
        )


class _Values:
    """Numbers of one kind, in the form that Rerun asks for."""

    def __init__(self, values: NDArray[np.float64], kind: Kind) -> None:
        self._array = pa.array(np.ascontiguousarray(values, dtype=_TYPES[kind]))

    def as_arrow_array(self) -> pa.Array:
        """The values in Arrow's form."""
        return self._array
