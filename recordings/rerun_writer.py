"""Records a flight to Rerun, for the eyes: chart, oblique view, phases and plots.

Every sample is kept as columns (see `rerun_columns`); what is drawn of them is one a second, as many as a
screen can show.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from aircraft.path import Phase
from aircraft.state import FlightState
from recordings.errors import RecordingError
from recordings.recorder import FlightHeader, GuidanceSample, Layer, Outcome, WeatherSheet
from recordings.rerun_blueprint import flight_blueprint
from recordings.rerun_card import run_card
from recordings.rerun_chart import Chart
from recordings.rerun_columns import SampleColumns
from recordings.rerun_plots import PHASES, draw_plots, plot_values, scalars
from recordings.rerun_scene import Scene, south
from recordings.rerun_times import FlightTimes
from recordings.rerun_weather import WeatherLayer

Floats = NDArray[np.float64]

ROW_S = 1.0
"""A sample is drawn when this much time has passed since the last one drawn."""

ROWS_PER_CHUNK = 120
"""Rows written at once: two minutes of flight, which is what a killed flight loses at most."""

POSE_STRIDE = 5
"""Rows from one pose of the aircraft's mark to the next."""

_SLACK_S = 1e-6  # times that should be whole seconds may be off by rounding


class RerunRecorder:
    """A `Recorder` that writes `<name>.partial.rrd`, which gets its final name when the flight has ended."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.partial_path = path.with_suffix(f".partial{path.suffix}")
        self._stream: rr.RecordingStream | None = None
        self._kept: list[tuple[FlightState, GuidanceSample]] = []
        self._skipped: tuple[FlightState, GuidanceSample] | None = None
        self._next_s = -math.inf
        self._track_end: Floats = np.empty((0, 3))
        self._hazard: NDArray[np.bool_] | None = None
        self._forecast: WeatherSheet | None = None
        self._lanes: dict[str, str] = {}

    def begin(self, header: FlightHeader) -> None:
        """See `Recorder.begin`.

        Raises:
            RecordingError: if the file cannot be created.
        """
        self._header = header
        self._times = FlightTimes(header.plan.departure_s)
        chart = Chart(header.grid)
        self._columns = SampleColumns(self._times)
        self._scene = Scene(header, chart)
        self._weather = WeatherLayer(chart, self._times, header.stage_s)
        blueprint = flight_blueprint(
            chart.extent,
            heights_by=self._scene.heights_by,
            begin_s=float(header.reference.start_time_s[0]),
            end_s=float(header.reference.end_time_s[-1]),
        )
        stream = rr.RecordingStream("galeway", recording_id=_recording_id(header), send_properties=False)
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        try:
            stream.save(self.partial_path, blueprint)
        except (OSError, RuntimeError) as error:
            raise RecordingError(
                f"cannot write {self.partial_path}: {error}; record to another folder"
            ) from error
        self._stream = stream
        stream.send_recording_name(f"{header.scenario}, seed {header.seed}")
        self._scene.draw(stream)
        draw_plots(stream, header, self._times)
        stream.log("card", _card(header, "in flight"), static=True)

    def weather(self, sheet: WeatherSheet) -> None:
        """See `Recorder.weather`; the forecast's edge is drawn into the truth of the same stage."""
        if sheet.layer is Layer.FORECAST:
            self._forecast = sheet
            return
        self._write_rows()
        self._hazard = sheet.hazard
        forecast = self._forecast if self._forecast and self._forecast.stage == sheet.stage else sheet
        stream = self._at(sheet.time_s)
        for entity, archetype in self._weather.draw(sheet, forecast.hazard):
            stream.log(entity, archetype)

    def sample(self, state: FlightState, guidance: GuidanceSample) -> None:
        """See `Recorder.sample`; draws one a second, and the last."""
        if self._columns.add(state, guidance):
            self._columns.write(self._started)
        if state.time_s < self._next_s:
            self._skipped = (state, guidance)
            return
        self._skipped = None
        self._next_s = state.time_s + ROW_S - _SLACK_S
        self._kept.append((state, guidance))
        if len(self._kept) >= ROWS_PER_CHUNK:
            self._write_rows()

    def estimate(self, seen: FlightState) -> None:
        """See `Recorder.estimate`; not drawn: the eyes see the flight as it was."""

    def event(self, time_s: float, text: str) -> None:
        """See `Recorder.event`."""
        self._at(time_s).log("events", rr.TextLog(text, level=rr.TextLogLevel.INFO))

    def finish(self, time_s: float, outcome: Outcome, detail: str) -> None:
        """See `Recorder.finish`."""
        ended = f"{outcome.value.replace('_', ' ')}: {detail}"
        self.event(time_s, ended)
        self._started.log("card", _card(self._header, ended), static=True)
        self._close()
        self.partial_path.replace(self.path)

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

    def _close(self) -> None:
        """Write what is left, the last sample too, and close the file."""
        if self._skipped is not None:
            self._kept.append(self._skipped)
        self._write_rows()
        self._columns.write(self._started)
        stream, self._stream = self._started, None
        try:
            stream.flush()
        except RuntimeError as error:  # what Rerun's own writer says of a full disk
            raise RecordingError(
                f"cannot write all of {self.partial_path}: {error}; make room for it"
            ) from error
        finally:
            stream.disconnect()

    def _write_rows(self) -> None:
        """Write the samples kept since the last time."""
        if not self._kept:
            return
        states = np.array([state for state, _ in self._kept])
        guidance = np.array([sample[:-1] for _, sample in self._kept])
        self._kept.clear()
        state = dict(zip(FlightState._fields, states.T, strict=True))
        _, across_m, above_m, late_s, phase = guidance.T
        times = self._times.columns(state["time_s"])
        for entity, lines in plot_values(state, late_s, above_m, across_m).items():
            self._started.send_columns(entity, times, scalars(lines))
        self._write_track(state)
        self._write_lanes(state, phase)

    def _write_track(self, state: Mapping[str, Floats]) -> None:
        """The flown line since the last rows, and the aircraft's place and heading."""
        north_m, east_m = self._header.grid.frame.to_plane(state["lat_rad"], state["lon_rad"])
        up_km = state["altitude_m"] / 1000.0 * self._scene.heights_by
        track = np.column_stack([east_m / 1000.0, north_m / 1000.0, up_km])
        strip = np.concatenate([self._track_end, track])
        self._track_end = track[-1:]
        stream, now = self._started, self._times.columns(state["time_s"][-1:])
        stream.send_columns("chart/flown", now, rr.LineStrips2D.columns(strips=[south(strip[:, :2])]))
        stream.send_columns("scene/flown", now, rr.LineStrips3D.columns(strips=[strip]))
        # The last row and every fifth before it, so never none: the viewer fails on an empty chunk.
        posed = slice((len(track) - 1) % POSE_STRIDE, None, POSE_STRIDE)
        times, half_rad = self._times.columns(state["time_s"][posed]), state["heading_rad"][posed] / 2.0
        turn = np.column_stack([np.zeros((len(half_rad), 2)), np.sin(half_rad), np.cos(half_rad)])
        for entity, position, quaternion in (
            ("chart/aircraft", track[posed] * (1.0, -1.0, 0.0), turn),
            ("scene/aircraft", track[posed], turn * (1.0, 1.0, -1.0, 1.0)),
        ):
            columns = rr.Transform3D.columns(translation=position, quaternion=quaternion)
            stream.send_columns(entity, times, columns)

    def _write_lanes(self, state: Mapping[str, Floats], phase: Floats) -> None:
        """Changes of phase, and of hazard at the aircraft."""
        grid, hazard = self._header.grid, np.zeros(len(phase), np.bool_)
        if self._hazard is not None:
            rows, columns = np.rint(grid.indices(state["lat_rad"], state["lon_rad"])).astype(np.int64)
            hazard = self._hazard[rows.clip(0, grid.rows - 1), columns.clip(0, grid.columns - 1)]
        lanes = {
            "lanes/phase": [PHASES[Phase(value)] for value in phase],
            "lanes/hazard": ["in hazard" if inside else "clear" for inside in hazard],
        }
        for entity, names in lanes.items():
            for time_s, name in zip(state["time_s"], names, strict=True):
                if name != self._lanes.get(entity):
                    self._at(float(time_s)).log(entity, rr.StateChange(state=name))
                    self._lanes[entity] = name


def _recording_id(header: FlightHeader) -> str:
    """The same for the same scenario and seed; two that differ in any value do not meet in one viewer."""
    return f"{header.scenario}-{header.seed}-{zlib.crc32(header.scenario_toml.encode()):08x}"


def _card(header: FlightHeader, ended: str) -> rr.TextDocument:
    return rr.TextDocument(run_card(header, ended), media_type=rr.MediaType.MARKDOWN)
