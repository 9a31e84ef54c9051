"""Draws several flights through the same weather as one Rerun file: their tracks on one chart, their errors.

What moves is drawn on common times, a row for all flights of a moment.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from recordings.overlay import Overlaid, truth_met
from recordings.playback import weather_of
from recordings.rerun_blueprint import overlay_blueprint
from recordings.rerun_card import flights_card
from recordings.rerun_chart import Chart
from recordings.rerun_legend import Legend, Stroke
from recordings.rerun_plots import LEVELS, Series, level_range_m, line_style, room_for, scalars
from recordings.rerun_scene import Scene, south
from recordings.rerun_text import drawable
from recordings.rerun_times import FlightTimes
from recordings.rerun_weather import WeatherLayers

Floats = NDArray[np.float64]
Drawn = Iterator[tuple[str, rr.AsComponents]]
Moving = Iterator[tuple[float, str, rr.AsComponents]]

COLOURS = (
    (255, 209, 64),
    (64, 224, 240),
    (255, 110, 220),
    (140, 240, 110),
    (170, 150, 255),
    (255, 255, 255),
    (255, 160, 90),
    (60, 160, 140),
)
"""Of the flights, in their order; none like hazard or plain weather."""

_ERRORS = {
    "cross_track_m": "Across, right positive [m]",
    "altitude_error_m": "Above the reference [m]",
    "time_error_s": "Late [s]",
}
_STEP_S = 1.0
_WIDEST_PX, _FINEST_PX = 4.0, 1.3  # of tracks; the first is widest, so that it shows under others on its way
_STRIP_STEPS = 60
_MARK_STEPS = 10
_EDGE = 1.1  # times the number at the side of a plot, which is not drawn on the very edge
_SLACK_S = 1e-6  # times that should be whole seconds may be off by rounding
_DARK = (11, 14, 20)
_DIM = 120  # opacity of plans, of 255


@dataclass(frozen=True)
class _Track:
    """A flight at the overlay's steps: before it begins and after it ends it stands where it was.

    `km`: (east, north, up), up exaggerated. `errors`: columns of `_ERRORS`, and `altitude_m`: the one flown,
    NaN where it does not fly.
    """

    km: Floats
    heading_rad: Floats
    flies: NDArray[np.bool_]
    errors: dict[str, Floats]
    altitude_m: Floats


def record_overlay(flights: Sequence[Overlaid], path: Path) -> None:
    """Write the Rerun file.

    Args:
        flights: as `overlaid` makes them, so that they go together.
        path: the file to write.
    """
    _Overlay(flights).write(path)


class _Overlay:
    """Flights on the chart of the first of them; they all have the same."""

    def __init__(self, flights: Sequence[Overlaid]) -> None:
        header = flights[0].recording.header
        states = [flight.recording.state["time_s"] for flight in flights]
        self._flights = flights
        self._colours = COLOURS[: len(flights)]
        self._radii = -np.linspace(_WIDEST_PX, _FINEST_PX, len(flights)) / 2.0
        self._times = FlightTimes(header.plan.departure_s)
        self._chart = Chart(header.grid)
        self._scene = Scene(header, self._chart)
        self._layers = WeatherLayers(self._chart, self._times, header.stage_s, header.threshold_mps)
        self._steps_s = np.arange(
            min(time_s[0] for time_s in states), max(time_s[-1] for time_s in states) + 1.0
        )
        self._tracks = [self._track(flight) for flight in flights]
        self._levels_m = level_range_m([flight.recording.header.plan for flight in flights])

    def write(self, path: Path) -> None:
        """Write all of it."""
        blueprint = overlay_blueprint(
            self._scene,
            {f"errors/{name}": title for name, title in _ERRORS.items()},
            {f"errors/{name}": _EDGE * room_for(self._largest(name)) for name in _ERRORS},
            above="errors/altitude_error_m",
            levels_m=self._levels_m,
            begin_s=float(self._steps_s[0]),
            end_s=float(self._steps_s[-1]),
        )
        stream = rr.RecordingStream("galeway", recording_id=path.stem, send_properties=False)
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        stream.save(path, blueprint)
        stream.send_recording_name(f"{len(self._flights)} flights")
        for entity, archetype in self._still():
            stream.log(entity, archetype, static=True)
        for time_s, entity, archetype in (*self._weather(), *self._flown(), *self._marks()):
            self._times.set(stream, time_s)
            stream.log(entity, archetype)
        for entity, lines in self._plotted().items():
            stream.send_columns(entity, self._times.columns(self._steps_s), scalars(lines))
        stream.flush()
        stream.disconnect()

    def _largest(self, error: str) -> float:
        """The largest size that an error has in any of the flights."""
        return max(float(np.nanmax(np.abs(track.errors[error]))) for track in self._tracks)

    def _plotted(self) -> dict[str, list[Floats]]:
        """Entity to the lines of its plot, one for each flight."""
        plots = {f"errors/{name}": [track.errors[name] for track in self._tracks] for name in _ERRORS}
        if self._levels_m:
            plots[LEVELS] = [track.altitude_m for track in self._tracks]
        return plots

    def _track(self, flight: Overlaid) -> _Track:
        state, guidance, steps_s = flight.recording.state, flight.recording.guidance, self._steps_s
        flies = (state["time_s"][0] <= steps_s) & (steps_s < state["time_s"][-1] + _STEP_S)
        at = _last_before(state["time_s"], steps_s)
        north_m, east_m = self._chart.grid.frame.to_plane(state["lat_rad"][at], state["lon_rad"][at])
        altitude_m = state["altitude_m"][at]
        guided = _last_before(guidance["time_s"], steps_s)
        errors = {name: np.where(flies, guidance[name][guided], np.nan) for name in _ERRORS}
        km = np.column_stack([east_m, north_m, altitude_m * self._scene.heights_by]) / 1000.0
        return _Track(km, state["heading_rad"][at], flies, errors, np.where(flies, altitude_m, np.nan))

    def _still(self) -> Drawn:
        """What is the same at all times."""
        yield from self._scene.places()
        yield from self._scene.graticule()
        yield from self._layers.place()
        yield from self._legend()
        faint = [(*colour, _DIM) for colour in self._colours]
        plans = [self._plan_km(flight) for flight in self._flights]
        yield "chart/plan", rr.LineStrips2D([south(plan[:, :2]) for plan in plans], colors=faint, radii=-2.5)
        yield "scene/plan", rr.LineStrips3D(plans, colors=faint, radii=-2.5)
        lines = [
            Series(flight.label, colour) for flight, colour in zip(self._flights, self._colours, strict=True)
        ]
        for entity in self._plotted():
            yield entity, line_style(lines)
        yield "card", rr.TextDocument(drawable(flights_card(self._flights)), media_type=rr.MediaType.MARKDOWN)

    def _legend(self) -> Drawn:
        header = self._flights[0].recording.header
        return Legend(self._chart, header.threshold_mps, bool(header.also)).draw(
            [
                Stroke(flight.label, colour, -radius)
                for flight, colour, radius in zip(self._flights, self._colours, self._radii, strict=True)
            ],
            forecast=False,
        )

    def _plan_km(self, flight: Overlaid) -> Floats:
        """The plan as (east, north, up), up exaggerated."""
        points = flight.recording.header.plan.waypoints
        up_km = [point.altitude_m / 1000.0 * self._scene.heights_by for point in points]
        return np.column_stack([[self._chart.km(point.lat_deg, point.lon_deg) for point in points], up_km])

    def _weather(self) -> Moving:
        """The stages that any of the flights met; where they change level, at that of the first."""
        whose = ", where the first flies" if self._levels_m else ""
        for sheet in map(weather_of, truth_met(self._flights)):
            for entity, archetype in self._layers.layer(sheet):
                yield sheet.time_s, entity, archetype
            yield sheet.time_s, "chart/stage", self._layers.stage_name(sheet, whose)

    def _flown(self) -> Moving:
        """The tracks, a minute at a time, each piece at the time of its end."""
        for begin in range(0, len(self._steps_s) - 1, _STRIP_STEPS):
            piece = slice(begin, begin + _STRIP_STEPS + 1)
            strips = [track.km[piece][track.flies[piece]] for track in self._tracks]
            drawn = [index for index, strip in enumerate(strips) if len(strip) > 1]
            if not drawn:
                continue
            time_s, colours = float(self._steps_s[piece][-1]), [self._colours[index] for index in drawn]
            flat, raised = (
                [south(strips[index][:, :2]) for index in drawn],
                [strips[index] for index in drawn],
            )
            look: dict[str, Any] = {"colors": colours, "radii": self._radii[drawn]}
            yield time_s, "chart/flown", rr.LineStrips2D(flat, **look, draw_order=35.0)
            yield time_s, "scene/flown", rr.LineStrips3D(raised, **look)

    def _marks(self) -> Moving:
        """Where the aircraft are and head."""
        last = len(self._steps_s) - 1
        for step in sorted({*range(0, last, _MARK_STEPS), last}):
            time_s = float(self._steps_s[step])
            for index, track in enumerate(self._tracks):
                lines = [_turned(line, track.heading_rad[step]) for line in self._scene.glyph_km]
                placed = [south(line + track.km[step, :2]) for line in lines]
                for layer, colour, radius_px, order in (
                    ("halo", _DARK, 3.4, 49.0),
                    ("glyph", self._colours[index], 1.7, 50.0),
                ):
                    glyph = rr.LineStrips2D(placed, colors=colour, radii=-radius_px, draw_order=order)
                    yield time_s, f"chart/aircraft/{index}/{layer}", glyph
            at = [track.km[step] for track in self._tracks]
            yield time_s, "scene/aircraft", rr.Points3D(at, colors=self._colours, radii=-5.0)


def _last_before(times_s: Floats, steps_s: Floats) -> NDArray[np.int64]:
    """For each step the last of the times that is not after it; the first where there is none."""
    found: NDArray[np.int64] = np.searchsorted(times_s, steps_s + _SLACK_S, side="right") - 1
    return found.clip(0)


def _turned(points: Floats, heading_rad: float) -> Floats:
    """Points (east, north) that point north, turned to a heading."""
    cos, sin = np.cos(heading_rad), np.sin(heading_rad)
    turned: Floats = points @ np.array([[cos, -sin], [sin, cos]])
    return turned
