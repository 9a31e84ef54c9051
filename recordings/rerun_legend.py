"""The legend of the chart, a column at its left: what each line means, the colours of the wind, the scale."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from recordings.contours import dashed
from recordings.recorder import Layer
from recordings.rerun_chart import Chart
from recordings.rerun_labels import Colour, labels, width_px
from recordings.rerun_palette import Band, difference_scale, wind_scale
from recordings.rerun_weather import (
    ARROW_RADIUS_PX,
    DASH_PX,
    EDGE_COLOURS,
    EDGE_RADIUS_PX,
    WIND_COLOURS,
    arrow_km,
)

Floats = NDArray[np.float64]
Drawn = Iterator[tuple[str, rr.AsComponents]]

_TEXT_COLOUR: Colour = (190, 198, 210)
_LEFT_PX, _TOP_PX, _ROW_PX = -226.0, -14.0, 25.0  # from the picture's north-west corner
_SWATCH_PX = 34.0
_DOT_PX = 1e-3  # a line of no length is not drawn
_GAP_PX = 4.0
_SCALE_ROW_PX = 23.0
_DIFFERENCE_PX = 95.0  # right of the scale of wind speeds


class Stroke(NamedTuple):
    """A line of the legend, or a dot; the radius is in points of the screen."""

    label: str
    colour: Colour
    radius_px: float
    dashed: bool = False
    length_km: float | None = None
    dot: bool = False


@dataclass(frozen=True)
class Legend:
    """Draws the legend of a chart; `also`: whether hazard is more than wind over the threshold."""

    chart: Chart
    threshold_mps: float
    also: bool = False

    def draw(self, lines: Sequence[Stroke], *, forecast: bool = True) -> Drawn:
        """The legend of `lines`, of the weather, of the forecast where it is drawn, and of the scale."""
        bar_km, wind_km = self.chart.scale_bar_km(), float(arrow_km(self.chart, np.array(20.0)))
        limit = "hazard" if self.also else f"{self.threshold_mps:.4g} m/s"
        strokes = [
            *lines,
            Stroke(f"{limit}, true", EDGE_COLOURS[Layer.TRUTH], EDGE_RADIUS_PX),
        ]
        if forecast:
            colour = EDGE_COLOURS[Layer.FORECAST]
            strokes.append(Stroke(f"{limit}, forecast", colour, EDGE_RADIUS_PX, dashed=True))
        strokes.append(Stroke(f"{bar_km:g} km", _TEXT_COLOUR, 1.5, length_km=bar_km))
        yield from self._strokes(strokes)
        row = len(strokes)
        yield (
            "chart/legend/arrow",
            rr.Arrows2D(
                origins=[self._at(0.0, row) * (1.0, -1.0)],
                vectors=[(wind_km, 0.0)],
                colors=WIND_COLOURS[Layer.TRUTH],
                radii=-ARROW_RADIUS_PX,
            ),
        )
        yield (
            "chart/legend/arrow/name",
            self._names([self._at(wind_km / self.chart.px_km, row)], ["wind of 20 m/s"]),
        )
        top = self._at(0.0, row + 1)
        yield from self._scale("chart/legend/scale", "wind [m/s]", wind_scale(self.threshold_mps), top)
        if not forecast:
            return
        top = top + np.array([_DIFFERENCE_PX * self.chart.px_km, 0.0])
        yield from self._scale("chart/weather/difference/scale", "diff. [m/s]", difference_scale(), top)

    def _strokes(self, strokes: Sequence[Stroke]) -> Drawn:
        px_km, drawn, ends = self.chart.px_km, [], []
        for row, stroke in enumerate(strokes):
            length_km = _SWATCH_PX * px_km if stroke.length_km is None else stroke.length_km
            line = np.array([self._at(0.0, row), self._at(length_km / px_km, row)])
            ends.append(line[1])
            if stroke.dot:
                middle_px = _SWATCH_PX / 2.0
                line = np.array([self._at(middle_px, row), self._at(middle_px + _DOT_PX, row)])
            drawn.append(dashed([line], DASH_PX * px_km) if stroke.dashed else [line])
        yield (
            "chart/legend",
            rr.LineStrips2D(
                [piece * (1.0, -1.0) for pieces in drawn for piece in pieces],
                colors=[stroke.colour for stroke, pieces in zip(strokes, drawn, strict=True) for _ in pieces],
                radii=[
                    -stroke.radius_px for stroke, pieces in zip(strokes, drawn, strict=True) for _ in pieces
                ],
            ),
        )
        yield "chart/legend/names", self._names(ends, [stroke.label for stroke in strokes])

    def _scale(self, entity: str, title: str, bands: Sequence[Band], top: Floats) -> Drawn:
        """A column of colours, the highest on top, each with the value that it begins at."""
        across = np.array([_SWATCH_PX * self.chart.px_km, 0.0])
        down = np.array([0.0, -_SCALE_ROW_PX * self.chart.px_km])
        corner, falling = top + 0.6 * down, bands[::-1]
        yield entity, rr.Image(np.array([[band.colour] for band in falling], np.uint8), draw_order=10.0)
        yield (
            entity,
            rr.Transform3D(translation=[corner[0], -corner[1], 0.0], scale=[across[0], -down[1], 1.0]),
        )
        named = [
            (
                corner + across + down * (row + 1),
                f"{band.from_mps:{'+' if bands[0].from_mps is None else ''}g}",
            )
            for row, band in enumerate(falling)
            if band.from_mps is not None
        ]
        texts = [title, *(text for _, text in named)]
        yield f"{entity}_names", self._names([top - 0.12 * across, *(place for place, _ in named)], texts)

    def _names(self, left_km: Sequence[Floats], texts: Sequence[str]) -> rr.Points2D:
        """Labels that begin right of places."""
        right = np.array([[_GAP_PX + width_px(text) / 2.0, 0.0] for text in texts]) * self.chart.px_km
        return labels(self.chart, np.array(left_km) + right, texts, [_TEXT_COLOUR] * len(texts))

    def _at(self, right_px: float, row: float) -> Floats:
        """A place in the legend, east and north."""
        extent, px_km = self.chart.extent, self.chart.px_km
        return np.array(
            [extent.west + (_LEFT_PX + right_px) * px_km, extent.north + (_TOP_PX - _ROW_PX * row) * px_km]
        )
