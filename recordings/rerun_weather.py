"""The weather of a stage as the viewer shows it: picture, wind arrows and the stage's name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from recordings.recorder import WeatherSheet
from recordings.rerun_chart import Chart
from recordings.rerun_times import FlightTimes

WIND_COLOUR = (205, 212, 222, 110)
_TEXT_COLOUR = (190, 198, 210)
_ARROWS_ACROSS = 16
_FULL_ARROW_MPS = 25.0
_LONGEST_ARROW = 1.3


@dataclass(frozen=True)
class WeatherLayer:
    """Draws stages on the chart. `stage_s`: length of a stage."""

    chart: Chart
    times: FlightTimes
    stage_s: float

    def draw(
        self, truth: WeatherSheet, forecast_hazard: NDArray[np.bool_]
    ) -> Iterator[tuple[str, rr.AsComponents]]:
        """Entities and what to log to them, all at the time of the sheet."""
        chart, extent = self.chart, self.chart.extent
        height, width = chart.shape
        speed_mps = np.hypot(truth.wind_north_mps, truth.wind_east_mps)
        picture = chart.picture(truth.hazard, forecast_hazard, speed_mps)
        yield "chart/weather", rr.Image(picture, draw_order=-10.0)
        yield (
            "chart/weather",
            rr.Transform3D(translation=[extent.west, -extent.north, 0.0], scale=chart.cell_km),
        )
        yield (
            "scene/weather",
            rr.GridMap(
                data=picture.tobytes(),
                format=rr.components.ImageFormat(
                    width=width, height=height, color_model="RGB", channel_datatype="U8"
                ),
                cell_size=chart.cell_km,
                translation=[extent.west, extent.south, 0.0],
            ),
        )
        yield "chart/wind", self._arrows(truth)
        yield "chart/stage", self._stage(truth.stage)
        yield "lanes/stage", rr.StateChange(state=str(truth.stage))

    def _arrows(self, sheet: WeatherSheet) -> rr.Arrows2D:
        """The wind at every so many cells, each arrow's middle at its cell."""
        grid, stride = self.chart.grid, arrow_stride(self.chart)
        thin = slice(stride // 2, None, stride)
        places = np.meshgrid(grid.lat_rad[thin], grid.lon_rad[thin], indexing="ij")
        north_m, east_m = grid.frame.to_plane(*places)
        middle = np.column_stack([east_m.ravel(), -north_m.ravel()]) / 1000.0
        wind = np.column_stack(
            [sheet.wind_east_mps[thin, thin].ravel(), -sheet.wind_north_mps[thin, thin].ravel()]
        )
        speed_mps = np.maximum(np.hypot(*wind.T), 1e-3)
        vectors = wind * (arrow_km(self.chart, speed_mps) / speed_mps)[:, None]
        return rr.Arrows2D(
            origins=middle - vectors / 2.0, vectors=vectors, colors=WIND_COLOUR, radii=-0.9, draw_order=5.0
        )

    def _stage(self, stage: int) -> rr.Points2D:
        """The stage's number and times, above the chart."""
        begin, end = (
            str(self.times.utc(self.stage_s * number).astype("datetime64[m]"))
            for number in (stage, stage + 1)
        )
        extent = self.chart.extent
        above_km = 0.045 * (extent.north - extent.south)
        return rr.Points2D(
            [[(extent.west + extent.east) / 2.0, -extent.north - above_km]],
            labels=[f"stage {stage}: {begin.replace('T', ' ')} to {end[-5:]} UTC"],
            colors=_TEXT_COLOUR,
            radii=0.0,
            show_labels=True,
        )


def arrow_stride(chart: Chart) -> int:
    """Cells from one wind arrow to the next."""
    return max(1, round(max(chart.grid.shape) / _ARROWS_ACROSS))


def arrow_km(chart: Chart, speed_mps: NDArray[np.floating]) -> NDArray[np.float64]:
    """Length of the arrow for a wind speed: the space between arrows for 25 m/s, and hardly more."""
    space_km = arrow_stride(chart) * chart.cell_km
    return space_km * np.minimum(np.asarray(speed_mps, np.float64) / _FULL_ARROW_MPS, _LONGEST_ARROW)
