"""The weather of a stage as the viewer shows it: truth, forecast and their difference, a layer each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from recordings.contours import dashed, hazard_edges
from recordings.recorder import Layer, WeatherSheet
from recordings.rerun_chart import Bytes, Chart
from recordings.rerun_labels import labels
from recordings.rerun_palette import difference_picture, wind_picture
from recordings.rerun_times import FlightTimes

Drawn = Iterator[tuple[str, rr.AsComponents]]

EDGE_COLOURS = {Layer.TRUTH: (255, 120, 84), Layer.FORECAST: (255, 205, 150)}
"""Where the wind reaches the threshold; a solid line in truth, dashes in the forecast."""

WIND_COLOURS = {Layer.TRUTH: (205, 212, 222, 110), Layer.FORECAST: (120, 215, 235, 130)}
DASH_PX = 5.0
EDGE_RADIUS_PX = 0.9
ARROW_RADIUS_PX = 0.9

_TEXT_COLOUR = (190, 198, 210)
_DRAW_ORDER = {"truth": -30.0, "forecast": -29.0, "difference": -28.0}
_ARROWS_ACROSS = 16
_FULL_ARROW_MPS = 25.0
_LONGEST_ARROW = 1.3
_LIFT_PX = 1.0  # of lines over the ground, so that they are not half in it


@dataclass(frozen=True)
class WeatherLayers:
    """Draws stages on the chart and in the oblique view.

    `stage_s`: length of a stage.
    """

    chart: Chart
    times: FlightTimes
    stage_s: float
    threshold_mps: float

    def place(self) -> Drawn:
        """Where the pictures of the layers lie, at every time: the second view has them as textures."""
        extent = self.chart.extent
        corners = np.array([(east, north) for north in extent[1::2] for east in extent[0::2]])
        for order, layer in enumerate(_DRAW_ORDER):
            yield (
                f"chart/weather/{layer}/picture",
                rr.Transform3D(translation=[extent.west, -extent.north, 0.0], scale=self.chart.cell_km),
            )
            lift_km = (order - len(_DRAW_ORDER)) * 0.2 * self.chart.px_km
            yield (
                f"scene/weather/{layer}/picture",
                rr.Mesh3D(
                    vertex_positions=np.column_stack([corners, np.full(4, lift_km)]),
                    vertex_texcoords=[(0.0, 1.0), (1.0, 1.0), (0.0, 0.0), (1.0, 0.0)],
                    triangle_indices=[(0, 1, 3), (0, 3, 2)],
                ),
            )

    def layer(self, sheet: WeatherSheet) -> Drawn:
        """The forecast or the truth of a stage: entities and what to log to them at the time of the sheet."""
        colours = wind_picture(sheet.hazard, speed_mps(sheet), self.threshold_mps)
        yield from self._picture(sheet.layer.value, self.chart.upright(colours))
        yield f"chart/weather/{sheet.layer}/arrows", self._arrows(sheet)
        yield from self._edges(sheet)

    def difference(self, truth: WeatherSheet, forecast: WeatherSheet) -> Drawn:
        """How much stronger the wind is than forecast, and the name of the stage."""
        truth_mps, forecast_mps = speed_mps(truth), speed_mps(forecast)
        picture = self.chart.upright(difference_picture(truth_mps, forecast_mps))
        yield from self._picture("difference", picture)
        off_mps = float(np.abs(truth_mps - forecast_mps).max())
        off = f"up to {off_mps:.1f} m/s off the forecast" if off_mps >= 0.1 else "as forecast"
        yield "chart/stage", self.stage_name(truth, f" {off}")
        yield "lanes/stage", rr.StateChange(state=str(truth.stage))

    def _picture(self, layer: str, picture: Bytes) -> Drawn:
        """The same picture in both views."""
        yield f"chart/weather/{layer}/picture", rr.Image(picture, draw_order=_DRAW_ORDER[layer])
        height, width = self.chart.shape
        yield (
            f"scene/weather/{layer}/picture",
            rr.Mesh3D.from_fields(
                albedo_texture_buffer=picture.tobytes(),
                albedo_texture_format=rr.components.ImageFormat(
                    width=width, height=height, color_model="RGB", channel_datatype="U8"
                ),
            ),
        )

    def _edges(self, sheet: WeatherSheet) -> Drawn:
        """The contour of the threshold in both views; where there is none, an empty line clears the last."""
        lines = hazard_edges(sheet, self.threshold_mps, *self.chart.cells_km)
        if sheet.layer is Layer.FORECAST:
            lines = dashed(lines, DASH_PX * self.chart.px_km)
        colour, lift_km = EDGE_COLOURS[sheet.layer], _LIFT_PX * self.chart.px_km
        flat = [line * (1.0, -1.0) for line in lines]
        raised = [np.column_stack([line, np.full(len(line), lift_km)]) for line in lines]
        yield (
            f"chart/weather/{sheet.layer}/edge",
            rr.LineStrips2D(flat, colors=colour, radii=-EDGE_RADIUS_PX, draw_order=4.0),
        )
        yield (
            f"scene/weather/{sheet.layer}/edge",
            rr.LineStrips3D(raised, colors=colour, radii=-EDGE_RADIUS_PX),
        )

    def _arrows(self, sheet: WeatherSheet) -> rr.Arrows2D:
        """The wind at every so many cells, each arrow's middle at its cell."""
        stride, shape = arrow_stride(self.chart), self.chart.grid.shape
        thin = tuple(slice((count - 1) % stride // 2, None, stride) for count in shape)
        north_km, east_km = (
            axis_km[cut] for axis_km, cut in zip(self.chart.cells_km[::-1], thin, strict=True)
        )
        middle = np.stack(np.meshgrid(east_km, -north_km), axis=-1).reshape(-1, 2)
        wind = np.column_stack([sheet.wind_east_mps[thin].ravel(), -sheet.wind_north_mps[thin].ravel()])
        speeds_mps = np.maximum(np.hypot(*wind.T), 1e-3)
        vectors = wind * (arrow_km(self.chart, speeds_mps) / speeds_mps)[:, None]
        return rr.Arrows2D(
            origins=middle - vectors / 2.0,
            vectors=vectors,
            colors=WIND_COLOURS[sheet.layer],
            radii=-ARROW_RADIUS_PX,
            draw_order=5.0,
        )

    def stage_name(self, sheet: WeatherSheet, more: str = "") -> rr.Points2D:
        """The stage and the altitude of its wind, and more of that, such as how true it was forecast."""
        stage, at = sheet.stage, "" if sheet.altitude_m is None else f" at {sheet.altitude_m:.0f} m"
        begin, end = (
            str(self.times.utc(self.stage_s * number).astype("datetime64[m]"))
            for number in (stage, stage + 1)
        )
        extent = self.chart.extent
        text = f"stage {stage}: {begin.replace('T', ' ')} to {end[-5:]} UTC, wind{at}{more}"
        middle = [(extent.west + extent.east) / 2.0, extent.north + 18.0 * self.chart.px_km]
        return labels(self.chart, np.array([middle]), [text], [_TEXT_COLOUR])


def speed_mps(sheet: WeatherSheet) -> NDArray[np.float32]:
    """The wind speed of a sheet, [north, east]."""
    return np.hypot(sheet.wind_north_mps, sheet.wind_east_mps)


def arrow_stride(chart: Chart) -> int:
    """Cells from one wind arrow to the next."""
    return max(1, round(max(chart.grid.shape) / _ARROWS_ACROSS))


def arrow_km(chart: Chart, speed_mps: NDArray[np.floating]) -> NDArray[np.float64]:
    """Length of the arrow for a wind speed: the space between arrows for 25 m/s, and hardly more."""
    space_km = arrow_stride(chart) * chart.cell_km
    return space_km * np.minimum(np.asarray(speed_mps, np.float64) / _FULL_ARROW_MPS, _LONGEST_ARROW)
