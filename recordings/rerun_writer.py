"""Records a flight to Rerun, for the eyes: chart, oblique view, phases and plots.

Every sample is kept as columns (see `rerun_columns`); what is drawn of them is one a second, as many as a
screen can show.
"""

from __future__ import annotations

import math
import time
import zlib
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from aircraft.reference import Reference
from aircraft.state import FlightState
from planner.plans import Plan
from recordings.errors import RecordingError
from recordings.limits import Verdict
from recordings.recorder import FlightHeader, GuidanceSample, Layer, Outcome, PlanIssue, WeatherSheet
from recordings.rerun_blueprint import flight_blueprint
from recordings.rerun_card import limits_card, run_card, verdicts_card
from recordings.rerun_chart import Chart
from recordings.rerun_flight import FlownRows
from recordings.rerun_log import RerunLog
from recordings.rerun_plots import draw_limits, draw_plots, draw_stages
from recordings.rerun_scene import Scene, flyable
from recordings.rerun_text import drawable
from recordings.rerun_times import FlightTimes
from recordings.rerun_weather import WeatherLayers
from recordings.samples import MOST, Samples, firsts

Floats = NDArray[np.float64]

ROWS_PER_CHUNK = 120
"""Rows that are worth drawing: two minutes of flight; five, where `samples.MOST` come at once."""

_LONGEST_WAIT_S = 5.0
"""On the wall, in a flight that is paced by a clock: what a killed process loses of it at most."""


class RerunRecorder:
    """A `Recorder` that writes `<name>.partial.rrd`, which gets its final name when the flight has ended.

    `samples`: shared with the other recorders of the same flight, if there are any.
    `judged`: the flight will be judged; then the file is finished by `verdicts`, after `finish`.
    """

    def __init__(self, path: Path, samples: Samples | None = None, *, judged: bool = False) -> None:
        self.path = path
        self._judged = judged
        self.partial_path = path.with_suffix(f".partial{path.suffix}")
        self._stream: rr.RecordingStream | None = None
        self._samples = Samples() if samples is None else samples
        self._told = self._written = 0  # samples
        self._last_s = -math.inf  # time of the last sample that was written
        self._undrawn: list[tuple[Floats, Floats]] = []  # rows
        self._last: tuple[Floats, Floats] | None = None  # sample, where it is no row
        self._forecast: WeatherSheet | None = None
        self._end_s = 0.0

    def begin(self, header: FlightHeader) -> None:
        """See `Recorder.begin`.

        Raises:
            RecordingError: if the file cannot be created.
        """
        self._header = header
        self._times = FlightTimes(header.plan.departure_s)
        self._planned_end_s = float(header.reference.end_time_s[-1])
        chart = Chart(header.grid)
        self._scene = Scene(header, chart)
        self._rows = FlownRows(header, self._times, self._scene.heights_by)
        self._weather = WeatherLayers(chart, self._times, header.stage_s, header.threshold_mps)
        blueprint = flight_blueprint(header, self._scene, self._planned_end_s)
        stream = rr.RecordingStream("galeway", recording_id=_recording_id(header), send_properties=False)
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        try:
            stream.save(self.partial_path, blueprint)
        except (OSError, RuntimeError) as error:
            raise RecordingError(
                f"cannot write {self.partial_path}: {error}; record to another folder"
            ) from error
        self._stream, self._log = stream, RerunLog(stream, header, self._times)
        stream.send_recording_name(drawable(f"{header.scenario}, seed {header.seed}"))
        self._scene.draw(stream)
        for entity, archetype in self._weather.place():
            stream.log(entity, archetype, static=True)
        self._draw_plan(float(header.reference.start_time_s[0]), header.plan)
        self._draw_reference(float(header.reference.start_time_s[0]), header.reference)
        draw_plots(stream, header, self._times)
        self._due_s = time.monotonic() + _LONGEST_WAIT_S
        stream.log("card", _text(run_card(header, "in flight")), static=True)
        stream.log("verdicts", _text(limits_card(header.limits)), static=True)

    def weather(self, sheet: WeatherSheet) -> None:
        """See `Recorder.weather`; with the truth of a stage its difference from the forecast is drawn."""
        self._log.weather(sheet)
        stream = self._at(sheet.time_s)
        for entity, archetype in self._weather.layer(sheet):
            stream.log(entity, archetype)
        if sheet.layer is Layer.FORECAST:
            self._forecast = sheet
            return
        self._write_samples()
        self._draw()
        self._rows.hazard = sheet.hazard
        forecast = self._forecast if self._forecast and self._forecast.stage == sheet.stage else sheet
        stream = self._at(sheet.time_s)
        for entity, archetype in self._weather.difference(sheet, forecast):
            stream.log(entity, archetype)

    def sample(self, state: FlightState, guidance: GuidanceSample) -> None:
        """See `Recorder.sample`; draws one a second, and the last."""
        if self._samples.total == self._told:  # otherwise another recorder has kept it already
            self._samples.add(state, guidance)
        self._told += 1
        if self._told % MOST == 0 or time.monotonic() >= self._due_s:
            self._write_samples()

    def estimate(self, seen: FlightState) -> None:
        """See `Recorder.estimate`; not drawn: the eyes see the flight as it was."""
        self._log.estimate(seen)

    def reference(self, time_s: float, reference: Reference) -> None:
        """See `Recorder.reference`."""
        self._log.reference(time_s, reference)
        self._draw_reference(time_s, reference)

    def plan(self, issue: PlanIssue) -> None:
        """See `Recorder.plan`."""
        self._log.plan(issue)
        if issue.changed:
            self._draw_plan(issue.time_s, issue.plan)

    def _draw_plan(self, time_s: float, plan: Plan) -> None:
        stream = self._at(time_s)
        for entity, archetype in self._scene.route(plan):
            stream.log(entity, archetype)
        draw_stages(stream, plan)

    def _draw_reference(self, time_s: float, reference: Reference) -> None:
        stream = self._at(time_s)
        for entity, archetype in flyable(reference):
            stream.log(entity, archetype)

    def event(self, time_s: float, text: str) -> None:
        """See `Recorder.event`."""
        self._tell(time_s, text)
        self._log.event(time_s, text)

    def _tell(self, time_s: float, text: str) -> None:
        self._at(time_s).log("events", rr.TextLog(drawable(text), level=rr.TextLogLevel.INFO))

    def finish(self, time_s: float, outcome: Outcome, detail: str) -> None:
        """See `Recorder.finish`; of a flight that will be judged the file is finished by `verdicts`."""
        ended = f"{outcome.value.replace('_', ' ')}: {detail}"
        self._tell(time_s, ended)
        self._end_s = time_s
        self._started.log("card", _text(run_card(self._header, ended)), static=True)
        if time_s > self._planned_end_s:
            self._make_room(time_s)
        self._write_last()
        self._log.finish(time_s, outcome, detail)
        if not self._judged:
            self._finish()

    def verdicts(self, verdicts: Sequence[Verdict]) -> None:
        """Write what came of the limits of a flight that has ended, and give the file its finished name."""
        self._started.log("verdicts", _text(verdicts_card(verdicts)), static=True)
        for verdict in verdicts:
            level = rr.TextLogLevel.INFO if verdict.passed else rr.TextLogLevel.ERROR
            self._at(self._end_s).log("events", rr.TextLog(drawable(str(verdict)), level=level))
        self._finish()

    def abandon(self) -> None:
        """See `Recorder.abandon`."""
        if self._stream is not None:
            with suppress(RecordingError):  # that it cannot be written may be why it is abandoned
                self._close()

    @property
    def _started(self) -> rr.RecordingStream:
        if self._stream is None:
            raise RecordingError(f"{self.path} takes a flight from `begin` to `finish`; make a new recorder")
        return self._stream

    def _at(self, time_s: float) -> rr.RecordingStream:
        """The stream, set to a time."""
        stream = self._started
        self._times.set(stream, time_s)
        return stream

    def _make_room(self, end_s: float) -> None:
        """Let limits and time axes reach to the end of a flight that came late."""
        draw_limits(self._started, self._header, self._times, np.array([end_s]))
        rr.send_blueprint(flight_blueprint(self._header, self._scene, end_s), recording=self._started)

    def _finish(self) -> None:
        self._close()
        self.partial_path.replace(self.path)

    def _close(self) -> None:
        """Write what is left and close the file."""
        self._write_last()
        stream, self._stream = self._started, None
        try:
            stream.flush()
        except RuntimeError as error:  # what Rerun's own writer says of a full disk
            raise RecordingError(
                f"cannot write all of {self.partial_path}: {error}; make room for it"
            ) from error
        finally:
            stream.disconnect()

    def _write_samples(self) -> None:
        """Write the samples that wait; the first of every second becomes a row to be drawn."""
        self._due_s = time.monotonic() + _LONGEST_WAIT_S
        state, guidance = self._samples.between(self._written, self._told)
        self._written = self._told
        self._log.samples(state, guidance)
        if not len(state):
            return
        rows = firsts(state[:, 0], self._last_s)
        self._last_s = float(state[-1, 0])
        self._undrawn.append((state[rows], guidance[rows]))
        is_row = len(rows) and rows[-1] == len(state) - 1
        self._last = None if is_row else (state[-1:].copy(), guidance[-1:].copy())
        if sum(len(rows) for rows, _ in self._undrawn) >= ROWS_PER_CHUNK:
            self._draw()

    def _write_last(self) -> None:
        """Write and draw all samples, the last one too."""
        self._write_samples()
        if self._last is not None:
            self._undrawn.append(self._last)
            self._last = None
        self._draw()

    def _draw(self) -> None:
        """Draw the rows that wait."""
        if not self._undrawn:
            return
        state, guidance = (np.concatenate(tables) for tables in zip(*self._undrawn, strict=True))
        self._undrawn.clear()
        if len(state):
            self._rows.write(self._started, state, guidance[:, 1:])


def _recording_id(header: FlightHeader) -> str:
    """The same for the same scenario and seed; two that differ in any value do not meet in one viewer."""
    return f"{header.scenario}-{header.seed}-{zlib.crc32(header.scenario_toml.encode()):08x}"


def _text(markdown: str) -> rr.TextDocument:
    return rr.TextDocument(drawable(markdown), media_type=rr.MediaType.MARKDOWN)
