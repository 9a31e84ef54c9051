"""What moves: the flown line, the aircraft in its attitude, the plots and the lanes, some rows at a time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from aircraft.path import Phase
from aircraft.state import Command, FlightState
from recordings.poses import east_north_up_quaternion
from recordings.recorder import FlightHeader
from recordings.rerun_plots import LEVELS, PHASES, level_range_m, plot_values, scalars
from recordings.rerun_scene import south
from recordings.rerun_times import FlightTimes

Floats = NDArray[np.float64]

ROWS_PER_STRIP = 120
"""Rows to a piece of the flown line: how it grows when a recording is played."""

POSE_STRIDE = 5
"""Rows from one pose of the aircraft to the next."""


class FlownRows:
    """Draws rows of samples as they come. `hazard`: of the stage that is flown, None before the first."""

    hazard: NDArray[np.bool_] | None = None

    def __init__(self, header: FlightHeader, times: FlightTimes, heights_by: float) -> None:
        self._header = header
        self._times = times
        self._heights_by = heights_by
        self._changes_level = level_range_m([header.plan]) is not None
        self._track_end: Floats = np.empty((0, 3))
        self._lanes: dict[str, str] = {}

    def write(self, stream: rr.RecordingStream, states: Floats, guidance: Floats) -> None:
        """Draw one or more rows.

        Args:
            stream: where to.
            states: columns as the fields of `FlightState`.
            guidance: columns as the fields of `GuidanceSample`, the command's own at the end.
        """
        state = dict(zip(FlightState._fields, states.T, strict=True))
        _, across_m, above_m, late_s, phase, *command = guidance.T
        times = self._times.columns(state["time_s"])
        for entity, lines in plot_values(state, late_s, above_m, across_m).items():
            stream.send_columns(entity, times, scalars(lines))
        if self._changes_level:
            commanded_m = dict(zip(Command._fields, command, strict=True))["altitude_m"]
            stream.send_columns(LEVELS, times, scalars([commanded_m, state["altitude_m"]]))
        track = self._track(state)
        self._write_line(stream, track, state["time_s"])
        self._write_poses(stream, track, state)
        self._write_lanes(stream, state, phase)

    def _track(self, state: Mapping[str, Floats]) -> Floats:
        """Positions in the oblique view, (east, north, up), shape (rows, 3)."""
        north_m, east_m = self._header.grid.frame.to_plane(state["lat_rad"], state["lon_rad"])
        return np.column_stack([east_m, north_m, state["altitude_m"] * self._heights_by]) / 1000.0

    def _write_line(self, stream: rr.RecordingStream, track: Floats, time_s: Floats) -> None:
        """The flown line since the last rows, in pieces, each at the time of its last point."""
        line = np.concatenate([self._track_end, track])
        begin, before = 0, len(self._track_end)
        self._track_end = track[-1:]
        ends = [*range(ROWS_PER_STRIP - 1, len(track) - 1, ROWS_PER_STRIP), len(track) - 1]
        strips = []
        for end in ends:
            strips.append(line[begin : end + before + 1])
            begin = end + before  # a piece begins where the last one ends
        now = self._times.columns(time_s[ends])
        flat = [south(strip[:, :2]) for strip in strips]
        stream.send_columns("chart/flown", now, rr.LineStrips2D.columns(strips=flat))
        stream.send_columns("scene/flown", now, rr.LineStrips3D.columns(strips=strips))

    def _write_poses(self, stream: rr.RecordingStream, track: Floats, state: Mapping[str, Floats]) -> None:
        """The aircraft's place and heading on the chart, its place and attitude in the oblique view."""
        # The last row and every fifth before it, so never none: the viewer fails on an empty chunk.
        posed = slice((len(track) - 1) % POSE_STRIDE, None, POSE_STRIDE)
        angles_rad = [state[name][posed] for name in ("roll_rad", "pitch_rad", "heading_rad")]
        half_rad, still = angles_rad[-1] / 2.0, np.zeros(len(angles_rad[-1]))
        turn = np.column_stack([still, still, np.sin(half_rad), np.cos(half_rad)])
        attitude = east_north_up_quaternion(*angles_rad)
        times = self._times.columns(state["time_s"][posed])
        for entity, position, quaternion in (
            ("chart/aircraft", track[posed] * (1.0, -1.0, 0.0), turn),
            ("scene/aircraft", track[posed], attitude),
        ):
            columns = rr.Transform3D.columns(translation=position, quaternion=quaternion)
            stream.send_columns(entity, times, columns)

    def _write_lanes(self, stream: rr.RecordingStream, state: Mapping[str, Floats], phase: Floats) -> None:
        """Changes of phase, and of hazard at the aircraft."""
        grid, hazard = self._header.grid, np.zeros(len(phase), np.bool_)
        if self.hazard is not None:
            rows, columns = np.rint(grid.indices(state["lat_rad"], state["lon_rad"])).astype(np.int64)
            hazard = self.hazard[rows.clip(0, grid.rows - 1), columns.clip(0, grid.columns - 1)]
        lanes = {
            "lanes/phase": [PHASES[Phase(value)] for value in phase],
            "lanes/hazard": ["hazard" if inside else "clear" for inside in hazard],
        }
        for entity, names in lanes.items():
            for time_s, name in zip(state["time_s"], names, strict=True):
                if name != self._lanes.get(entity):
                    self._times.set(stream, float(time_s))
                    stream.log(entity, rr.StateChange(state=name))
                    self._lanes[entity] = name
