"""Records a flight to MCAP, the source of truth: the same flight gives the same bytes."""

from __future__ import annotations

import math
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from aircraft.state import FlightState
from recordings import messages
from recordings.errors import RecordingError
from recordings.fixed_layout import FixedLayout
from recordings.mcap_file import MESSAGE_HEAD, McapFile, fill_heads
from recordings.poses import PoseMessages
from recordings.protobuf_types import descriptor_set
from recordings.recorder import FlightHeader, GuidanceSample, Layer, Outcome, WeatherSheet
from recordings.samples import Samples, rounded
from recordings.schema import (
    ESTIMATE,
    ESTIMATE_COLUMNS,
    EVENTS,
    FORECAST_HAZARD,
    GUIDANCE,
    GUIDANCE_COLUMNS,
    HEADER_METADATA,
    OUTCOME,
    PLAN,
    PLAN_ATTACHMENT,
    PLAN_PATH,
    POSE,
    POSITION,
    REFERENCE,
    SAMPLES_PER_CHUNK,
    SCENARIO_ATTACHMENT,
    STATE,
    STATE_COLUMNS,
    TOPICS,
    TRANSFORM,
    TRUTH_GRID,
    TRUTH_HAZARD,
    VERSIONS_METADATA,
    Topic,
)

_LAYOUTS = {STATE: FixedLayout(STATE_COLUMNS), GUIDANCE: FixedLayout(GUIDANCE_COLUMNS)}
_SAMPLE = np.dtype(
    [
        (topic.name, [("head", MESSAGE_HEAD), ("payload", layout.message)])
        for topic, layout in _LAYOUTS.items()
    ]
)
_ESTIMATE_LAYOUT = FixedLayout(ESTIMATE_COLUMNS)
_ESTIMATE_RECORD = np.dtype([("head", MESSAGE_HEAD), ("payload", _ESTIMATE_LAYOUT.message)])
_ESTIMATE_PLACES = [STATE_COLUMNS.index(column) for column in ESTIMATE_COLUMNS]
_SECOND_SLACK_S = 1e-6  # times that should be whole seconds may be off by rounding


class McapRecorder:
    """A `Recorder` that writes `<name>.partial.mcap`, which gets its final name when the flight has ended."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.partial_path = path.with_suffix(f".partial{path.suffix}")
        self._stream: BinaryIO | None = None
        self._room = SAMPLES_PER_CHUNK  # samples left to write to the chunk in progress
        self._samples = Samples()
        self._estimates: list[FlightState] = []

    def begin(self, header: FlightHeader) -> None:
        """See `Recorder.begin`.

        Raises:
            RecordingError: if the file cannot be created, or the flight begins before 1970. As all methods
                that write do if the file cannot be written any more.
        """
        lead_in_s = float(header.reference.start_time_s[0])
        self._departure_ns = round(header.plan.departure_s * 1e9)
        if self._departure_ns + round(lead_in_s * 1e9) < 0:
            raise RecordingError(
                f"the flight begins {header.plan.departure_s + lead_in_s:.0f} s after 1970-01-01; MCAP knows "
                "no earlier time, so depart later"
            )
        try:
            self._stream = self.partial_path.open("wb")
        except OSError as error:
            raise RecordingError(
                f"cannot write {self.partial_path}: {error.strerror}; record to another folder"
            ) from error
        self._header = header
        self._file = McapFile(self._stream)
        self._poses = PoseMessages(header.grid.frame)
        self._last_second = -math.inf
        self._file.add_metadata(HEADER_METADATA, messages.header_metadata(header))
        self._file.add_metadata(VERSIONS_METADATA, header.versions)
        log_time = self._log_time(lead_in_s)
        scenario, plan = header.scenario_toml.encode(), header.plan
        self._file.add_attachment(log_time, SCENARIO_ATTACHMENT, "application/toml", scenario)
        self._file.add_attachment(log_time, PLAN_ATTACHMENT, "application/json", plan.to_json())
        types: dict[str, int] = {}
        for topic in TOPICS:
            if topic.message not in types:
                types[topic.message] = self._file.add_schema(topic.message, descriptor_set(topic.message))
        self._channels = {topic: self._file.add_channel(topic.name, types[topic.message]) for topic in TOPICS}
        frame = header.grid.frame
        self._add(REFERENCE, log_time, messages.reference_message(header.reference, frame))
        self._add(PLAN, log_time, messages.plan_message(plan))
        self._add(PLAN_PATH, log_time, messages.plan_path_message(plan, frame, log_time))
        self._file.finish_chunk()

    def weather(self, sheet: WeatherSheet) -> None:
        """See `Recorder.weather`.

        Raises:
            RecordingError: if the sheet is not of the flight's grid.
        """
        grid = self._header.grid
        if not sheet.hazard.shape == sheet.wind_north_mps.shape == sheet.wind_east_mps.shape == grid.shape:
            raise RecordingError(
                f"the weather of stage {sheet.stage} has {sheet.hazard.shape} cells, the flight's grid "
                f"{grid.shape}; record it on the flight's grid"
            )
        self._write_samples()
        log_time = self._log_time(sheet.time_s)
        topic = TRUTH_HAZARD if sheet.layer == Layer.TRUTH else FORECAST_HAZARD
        self._add(topic, log_time, messages.hazard_message(sheet, grid, self._header.threshold_mps))
        if sheet.layer == Layer.TRUTH:
            self._add(TRUTH_GRID, log_time, messages.weather_grid_message(sheet, grid, log_time))

    def sample(self, state: FlightState, guidance: GuidanceSample) -> None:
        """See `Recorder.sample`."""
        if self._samples.add(state, guidance) == self._room:
            self._write_samples()
            self._file.finish_chunk()
            self._room = SAMPLES_PER_CHUNK

    def estimate(self, seen: FlightState) -> None:
        """See `Recorder.estimate`."""
        self._estimates.append(seen)

    def event(self, time_s: float, text: str) -> None:
        """See `Recorder.event`."""
        self._write_samples()
        log_time = self._log_time(time_s)
        self._add(EVENTS, log_time, messages.event_message(log_time, text))

    def finish(self, time_s: float, outcome: Outcome, detail: str) -> None:
        """See `Recorder.finish`."""
        self._write_samples()
        self._add(OUTCOME, self._log_time(time_s), messages.outcome_message(time_s, outcome, detail))
        self._close()
        self.partial_path.replace(self.path)

    def abandon(self) -> None:
        """See `Recorder.abandon`. Does nothing before `begin` or after `finish`.

        Raises nothing: something has gone wrong already, and what cannot be written any more is lost.
        """
        if self._stream is not None:
            with suppress(RecordingError):
                self._write_samples()
            with suppress(RecordingError, OSError):
                self._close()

    def _close(self) -> None:
        stream, self._stream = self._stream, None
        if stream is not None:
            with stream:
                self._file.finish()

    def _add(self, topic: Topic, log_time: int, payload: bytes) -> None:
        self._file.add_message(self._channels[topic], log_time, payload)

    def _log_time(self, time_s: float) -> int:
        return self._departure_ns + round(time_s * 1e9)

    def _write_samples(self) -> None:
        """Turn the samples that wait into messages, all at once."""
        self._write_estimates()
        count = len(self._samples)
        if not count:
            return
        self._room -= count
        tables = dict(zip(_LAYOUTS, self._samples.take(), strict=True))
        times_s = tables[STATE][:, 0]
        if not np.all(np.isfinite(times_s)):
            raise RecordingError("a sample has no finite time and cannot be recorded; look at the aircraft")
        log_times = self._log_times(times_s)
        records, offset = np.empty(count, _SAMPLE), 0
        places: dict[int, tuple[NDArray[np.uint64], NDArray[np.uint64]]] = {}
        begins = np.arange(count, dtype=np.uint64) * np.uint64(_SAMPLE.itemsize)
        for topic, layout in _LAYOUTS.items():
            channel, part = self._channels[topic], records[topic.name]
            fill_heads(part["head"], channel, layout.message.itemsize, log_times)
            layout.fill(part["payload"], tables[topic])
            places[channel] = log_times, begins + np.uint64(offset)
            offset += part.itemsize
        self._file.add_records(records.tobytes(), places)
        self._write_poses(tables[STATE], log_times)

    def _write_estimates(self) -> None:
        """The same for estimates; that of the last sample is still to come, and waits for the next ones."""
        if not self._estimates:
            return
        table = rounded(np.array(self._estimates)[:, _ESTIMATE_PLACES], ESTIMATE_COLUMNS)
        self._estimates = []
        records, channel = np.empty(len(table), _ESTIMATE_RECORD), self._channels[ESTIMATE]
        log_times = self._log_times(table[:, 0])
        fill_heads(records["head"], channel, _ESTIMATE_LAYOUT.message.itemsize, log_times)
        _ESTIMATE_LAYOUT.fill(records["payload"], table)
        begins = np.arange(len(table), dtype=np.uint64) * np.uint64(_ESTIMATE_RECORD.itemsize)
        self._file.add_records(records.tobytes(), {channel: (log_times, begins)})

    def _log_times(self, times_s: NDArray[np.float64]) -> NDArray[np.uint64]:
        return (np.rint(times_s * 1e9).astype(np.int64) + self._departure_ns).astype(np.uint64)

    def _write_poses(self, table: NDArray[np.float64], log_times: NDArray[np.uint64]) -> None:
        """The messages of once a second: the first sample of each."""
        seconds = np.floor(table[:, 0] + _SECOND_SLACK_S)
        first = np.flatnonzero(np.diff(seconds, prepend=self._last_second) > 0.0)
        self._last_second = float(seconds[-1])
        if not len(first):
            return
        times = log_times[first].tolist()
        made = [
            self._poses.of(FlightState._make(row), log_time)
            for row, log_time in zip(table[first].tolist(), times, strict=True)
        ]
        for topic, payloads in zip((POSITION, POSE, TRANSFORM), zip(*made, strict=True), strict=True):
            self._file.add_messages(self._channels[topic], times, payloads)
