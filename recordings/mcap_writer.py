"""Records a flight to MCAP, the source of truth: the same flight gives the same bytes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from copy import copy
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from aircraft.reference import Reference
from aircraft.state import FlightState
from planner.plans import Plan
from recordings import messages
from recordings.errors import RecordingError
from recordings.fixed_layout import FixedLayout
from recordings.mcap_chunk import MESSAGE_HEAD, McapChunk, fill_heads
from recordings.mcap_file import McapFile
from recordings.mcap_tail import Tail
from recordings.poses import PoseMessages
from recordings.protobuf_types import descriptor_set
from recordings.recorder import FlightHeader, GuidanceSample, Layer, Outcome, PlanIssue, WeatherSheet
from recordings.samples import ESTIMATE_PLACES, Samples, firsts, rounded
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
    PLAN_ISSUE,
    PLAN_PATH,
    REFERENCE,
    SAMPLES_PER_CHUNK,
    SCENARIO_ATTACHMENT,
    STATE,
    STATE_COLUMNS,
    TOPICS,
    TRUTH_GRID,
    TRUTH_HAZARD,
    VERSIONS_METADATA,
    Topic,
)

_LAYOUTS = {STATE: FixedLayout(STATE_COLUMNS), GUIDANCE: FixedLayout(GUIDANCE_COLUMNS)}


def _record(payloads: Mapping[Topic, Any]) -> np.dtype[np.void]:
    """Messages of several topics one behind the other; `payloads` are NumPy's types of them."""
    return np.dtype(
        [(topic.name, [("head", MESSAGE_HEAD), ("payload", payload)]) for topic, payload in payloads.items()]
    )


_SIZES = {topic: layout.message.itemsize for topic, layout in _LAYOUTS.items()}
_SAMPLE = _record({topic: layout.message for topic, layout in _LAYOUTS.items()})
_ESTIMATE_LAYOUT = FixedLayout(ESTIMATE_COLUMNS)
_ESTIMATE_RECORD = _record({ESTIMATE: _ESTIMATE_LAYOUT.message})


class McapRecorder:
    """A `Recorder` that writes `<name>.partial.mcap`, which gets its final name when the flight has ended.

    `samples`: shared with the other recorders of the same flight, if there are any.
    """

    def __init__(self, path: Path, samples: Samples | None = None) -> None:
        self.path = path
        self.partial_path = path.with_suffix(f".partial{path.suffix}")
        self._stream: BinaryIO | None = None
        self._samples = Samples() if samples is None else samples
        self._told = self._written = 0  # samples
        self._chunk_end = SAMPLES_PER_CHUNK
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
        self._file, self._chunk, self._tail = McapFile(self._stream), McapChunk(), Tail(self.partial_path)
        self._poses = PoseMessages(header.grid.frame)
        sizes = {topic: template.size for topic, template in self._poses.templates.items()}
        self._pose_record = _record({topic: ("u1", size) for topic, size in sizes.items()})
        self._posed_s = -math.inf  # the last sample that was asked for a pose
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
        self._channels = {
            topic: self._file.add_channel(topic.name, types[topic.message], _about(topic)) for topic in TOPICS
        }
        frame = header.grid.frame
        self._add(REFERENCE, log_time, messages.reference_message(header.reference, frame, lead_in_s))
        self._show(plan, log_time)
        self._finish_chunk()

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
        if self._samples.total == self._told:  # otherwise another recorder has kept it already
            self._samples.add(state, guidance)
        self._told += 1
        if self._told == self._chunk_end:
            self._write_samples()
            self._finish_chunk()
            self._chunk_end += SAMPLES_PER_CHUNK
        elif self._tail.is_due:
            self._tail.keep(self._file.position, self._unfinished())

    def estimate(self, seen: FlightState) -> None:
        """See `Recorder.estimate`."""
        self._estimates.append(seen)

    def reference(self, time_s: float, reference: Reference) -> None:
        """See `Recorder.reference`."""
        self._write_samples()
        message = messages.reference_message(reference, self._header.grid.frame, time_s)
        self._add(REFERENCE, self._log_time(time_s), message)

    def plan(self, issue: PlanIssue) -> None:
        """See `Recorder.plan`."""
        self._write_samples()
        log_time = self._log_time(issue.time_s)
        self._add(PLAN_ISSUE, log_time, messages.plan_issue_message(issue))
        if issue.changed:
            self._show(issue.plan, log_time)

    def _show(self, plan: Plan, log_time: int) -> None:
        """Write a plan as viewers know it."""
        self._add(PLAN, log_time, messages.plan_message(plan))
        frame = self._header.grid.frame
        self._add(PLAN_PATH, log_time, messages.plan_path_message(plan, frame, log_time))

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
                self._finish_chunk()
                self._file.finish()
            self._tail.drop()

    def _finish_chunk(self) -> None:
        chunk, self._chunk = self._chunk, McapChunk()
        self._file.add_chunk(chunk)
        self._tail.put_off()

    def _unfinished(self) -> McapChunk:
        """The chunk in progress as it would be finished now; what is written later does not hang on it."""
        other = copy(self)
        other._chunk = self._chunk.copy()
        other._write_samples()
        return other._chunk

    def _add(self, topic: Topic, log_time: int, payload: bytes) -> None:
        self._chunk.add_message(self._channels[topic], log_time, payload)

    def _log_time(self, time_s: float) -> int:
        return self._departure_ns + round(time_s * 1e9)

    def _write_samples(self) -> None:
        """Turn the samples that wait into messages, all at once."""
        self._write_estimates()
        count = self._told - self._written
        if not count:
            return
        tables = dict(zip(_LAYOUTS, self._samples.between(self._written, self._told), strict=True))
        self._written = self._told
        times_s = tables[STATE][:, 0]
        if not np.all(np.isfinite(times_s)):
            raise RecordingError("a sample has no finite time and cannot be recorded; look at the aircraft")
        log_times = self._log_times(times_s)
        records = np.empty(count, _SAMPLE)
        for topic, layout in _LAYOUTS.items():
            layout.fill(records[topic.name]["payload"], tables[topic])
        self._add_records(records, _SIZES, log_times)
        self._write_poses(tables[STATE], log_times)

    def _write_estimates(self) -> None:
        """The same for estimates; that of the last sample is still to come, and waits for the next ones."""
        if not self._estimates:
            return
        table = rounded(np.array(self._estimates)[:, ESTIMATE_PLACES], ESTIMATE_COLUMNS)
        self._estimates = []
        records = np.empty(len(table), _ESTIMATE_RECORD)
        _ESTIMATE_LAYOUT.fill(records[ESTIMATE.name]["payload"], table)
        self._add_records(
            records, {ESTIMATE: _ESTIMATE_LAYOUT.message.itemsize}, self._log_times(table[:, 0])
        )

    def _log_times(self, times_s: NDArray[np.float64]) -> NDArray[np.uint64]:
        return (np.rint(times_s * 1e9).astype(np.int64) + self._departure_ns).astype(np.uint64)

    def _write_poses(self, table: NDArray[np.float64], log_times: NDArray[np.uint64]) -> None:
        """The messages of once a second: the first sample of each."""
        first = firsts(table[:, 0], self._posed_s)
        self._posed_s = float(table[-1, 0])
        if not len(first):
            return
        records, log_times = np.empty(len(first), self._pose_record), log_times[first]
        numbers, templates = self._poses.numbers(table[first]), self._poses.templates
        for topic, template in templates.items():
            template.fill(records[topic.name]["payload"], log_times, numbers[topic])
        self._add_records(records, {topic: template.size for topic, template in templates.items()}, log_times)

    def _add_records(
        self, records: NDArray[np.void], sizes: Mapping[Topic, int], log_times: NDArray[np.uint64]
    ) -> None:
        """Add messages of several topics, one of each at each time, of which the payloads are filled."""
        places, offset = {}, 0
        begins = np.arange(len(records), dtype=np.uint64) * np.uint64(records.itemsize)
        for topic, size in sizes.items():
            channel, part = self._channels[topic], records[topic.name]
            fill_heads(part["head"], channel, size, log_times)
            places[channel] = log_times, begins + np.uint64(offset)
            offset += part.itemsize
        self._chunk.add_records(records.tobytes(), places)


def _about(topic: Topic) -> dict[str, str]:
    """What the schema says of a topic, for people who have nothing but the file."""
    return {"content": topic.content, "rate": topic.rate.value, "frame": topic.frame}
