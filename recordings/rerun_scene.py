"""What does not change during a flight: plan, places, graticule, legend, and how the moving things look.

Entities under `chart` lie in kilometres east and south, because the second axis of a two-dimensional view
points down; those under `scene` in kilometres east, north and up, heights exaggerated.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from aircraft.reference import Reference
from recordings.recorder import FlightHeader
from recordings.rerun_chart import Chart
from recordings.rerun_weather import WIND_COLOUR, arrow_km

Floats = NDArray[np.float64]
Colour = tuple[int, ...]
Drawn = Iterator[tuple[str, rr.AsComponents]]

PLAN_COLOUR: Colour = (58, 134, 255)
FLOWN_COLOUR: Colour = (255, 209, 64)
HAZARD_COLOUR: Colour = (168, 46, 32)
_FORECAST_COLOUR: Colour = (244, 132, 95)
_REFERENCE_COLOUR: Colour = (160, 205, 255)
_POST_COLOUR: Colour = (58, 134, 255, 110)
_WHITE: Colour = (255, 255, 255)
_GOAL_COLOUR: Colour = (120, 230, 140)
_REACHABLE_COLOUR: Colour = (190, 198, 210)
_UNREACHABLE_COLOUR: Colour = (255, 120, 120)
_LINE_COLOUR: Colour = (120, 135, 160, 70)
_TEXT_COLOUR: Colour = (150, 162, 182)

_HIGHEST_SHARE = 0.07  # height of the highest waypoint in the oblique view, of the chart's width
_GLYPH_SHARE = 0.018
_POST_S = 1800.0
_ARC_STEP_RAD = 0.15


class Place(NamedTuple):
    """A point with a name. `end`: where the flight begins or is to end."""

    east_km: float
    north_km: float
    label: str
    colour: Colour
    end: bool


class Stroke(NamedTuple):
    """An entry of the legend; the radius is in points on the screen."""

    label: str
    colour: Colour
    length_km: float
    radius: float


@dataclass(frozen=True)
class Scene:
    """Draws what is known before take-off."""

    header: FlightHeader
    chart: Chart

    @cached_property
    def heights_by(self) -> float:
        """How many times heights are exaggerated in the oblique view: one digit and zeros."""
        highest_km = max(0.1, *(point.altitude_m / 1000.0 for point in self.header.plan.waypoints))
        wanted = max(1.0, _HIGHEST_SHARE * self._size_km / highest_km)
        unit = 10.0 ** math.floor(math.log10(wanted))
        return unit * round(wanted / unit)

    def draw(self, stream: rr.RecordingStream) -> None:
        """Log all of it, valid at every time."""
        for part in (self._plan(), self._places(), self._graticule(), self._legend(), self._moving()):
            for entity, archetype in part:
                stream.log(entity, archetype, static=True)

    @cached_property
    def _size_km(self) -> float:
        extent = self.chart.extent
        return max(extent.east - extent.west, extent.north - extent.south)

    def _plan(self) -> Drawn:
        points = self.header.plan.waypoints
        route = np.array([self.chart.km(point.lat_deg, point.lon_deg) for point in points])
        up_km = np.array([point.altitude_m for point in points]) / 1000.0 * self.heights_by
        raised = np.column_stack([route, up_km])
        posts = _posts(np.array([point.time_s for point in points]), raised)
        flyable = curve(self.header.reference)
        yield "chart/plan", rr.LineStrips2D([south(route)], colors=PLAN_COLOUR, radii=-3.0)
        yield "chart/reference", rr.LineStrips2D([south(flyable)], colors=_REFERENCE_COLOUR, radii=-0.6)
        yield "scene/plan", rr.LineStrips3D([raised], colors=PLAN_COLOUR, radii=-3.0)
        yield "scene/posts", rr.LineStrips3D(posts, colors=_POST_COLOUR, radii=-0.6)

    def _places(self) -> Drawn:
        places = list(self._named_places())
        ends = [place for place in places if place.end]
        ground = np.array([place[:2] for place in places])
        yield (
            "chart/places",
            rr.Points2D(
                south(ground),
                labels=[place.label for place in places],
                colors=[place.colour for place in places],
                radii=-4.0,
                show_labels=True,
                draw_order=40.0,
            ),
        )
        yield (
            "scene/places",
            rr.Points3D(
                [(place.east_km, place.north_km, 0.0) for place in ends],
                labels=[place.label for place in ends],
                colors=[place.colour for place in ends],
                radii=-4.0,
                show_labels=True,
            ),
        )

    def _named_places(self) -> Iterable[Place]:
        plan = self.header.plan
        for goal in plan.goals:
            at_km = self.chart.km(goal.lat_deg, goal.lon_deg)
            if goal.name == plan.goal:
                yield Place(*at_km, f"goal: {goal.name}", _GOAL_COLOUR, True)
            elif goal.reachable:
                yield Place(*at_km, goal.name, _REACHABLE_COLOUR, False)
            else:
                yield Place(*at_km, f"× {goal.name}", _UNREACHABLE_COLOUR, False)
        first = plan.waypoints[0]
        yield Place(*self.chart.km(first.lat_deg, first.lon_deg), "start", _WHITE, True)

    def _graticule(self) -> Drawn:
        lines = self.chart.graticule()
        flat = [np.column_stack([line.east_km, line.north_km]) for line in lines]
        raised = [np.column_stack([line, [0.5, 0.5]]) for line in flat]
        yield (
            "chart/graticule",
            rr.LineStrips2D([south(line) for line in flat], colors=_LINE_COLOUR, radii=-0.5, draw_order=1.0),
        )
        yield "scene/graticule", rr.LineStrips3D(raised, colors=_LINE_COLOUR, radii=-0.5)
        # A label hangs centred under its point: so left of the west edge and raised, or under the south edge.
        beside, under = self._size_km * np.array([-0.028, 0.011]), self._size_km * np.array([0.0, -0.004])
        at = [line[0] + (beside if line[0, 1] == line[1, 1] else under) for line in flat]
        names = [line.name for line in lines]
        yield "chart/graticule/names", _labels(np.array(at), names, _TEXT_COLOUR)

    def _legend(self) -> Drawn:
        """A column left of the chart: strokes, and under each its meaning."""
        extent, size_km = self.chart.extent, self._size_km
        bar_km = self.chart.scale_bar_km()
        strokes = (
            Stroke("plan", PLAN_COLOUR, 0.05 * size_km, 3.0),
            Stroke("flown", FLOWN_COLOUR, 0.05 * size_km, 1.6),
            Stroke(f"wind over {self.header.threshold_mps:g} m/s", HAZARD_COLOUR, 0.05 * size_km, 6.0),
            Stroke("as forecast", _FORECAST_COLOUR, 0.05 * size_km, 1.0),
            Stroke("wind of 20 m/s", WIND_COLOUR, float(arrow_km(self.chart, np.array(20.0))), 0.9),
            Stroke("× no route", _UNREACHABLE_COLOUR, 1e-3 * size_km, 4.0),
            Stroke(f"{bar_km:g} km", _TEXT_COLOUR, bar_km, 1.5),
        )
        at = np.array([[extent.west - 0.17 * size_km, extent.north - 0.1 * size_km]] * len(strokes))
        at[:, 1] -= 0.09 * size_km * np.arange(len(strokes))
        halves = [np.array([stroke.length_km / 2.0, 0.0]) for stroke in strokes]
        yield (
            "chart/legend",
            rr.LineStrips2D(
                [
                    south(np.array([place - half, place + half]))
                    for place, half in zip(at, halves, strict=True)
                ],
                colors=[stroke.colour for stroke in strokes],
                radii=[-stroke.radius for stroke in strokes],
            ),
        )
        yield "chart/legend/names", _labels(at, [stroke.label for stroke in strokes], _REACHABLE_COLOUR)

    def _moving(self) -> Drawn:
        """How the flown line looks, and a dart that points north for transforms to turn and move."""
        dart = _GLYPH_SHARE * self._size_km
        outline = dart * np.array([[0.0, 1.0], [0.75, -0.9], [0.0, -0.45], [-0.75, -0.9], [0.0, 1.0]])
        yield "chart/flown", rr.LineStrips2D.from_fields(colors=FLOWN_COLOUR, radii=-1.6, draw_order=35.0)
        yield "scene/flown", rr.LineStrips3D.from_fields(colors=FLOWN_COLOUR, radii=-1.6)
        yield (
            "chart/aircraft",
            rr.LineStrips2D([south(outline)], colors=_WHITE, radii=-1.5, draw_order=50.0),
        )
        yield (
            "scene/aircraft",
            rr.Mesh3D(
                vertex_positions=1.5 * np.column_stack([outline[:4], np.zeros(4)]),
                triangle_indices=[[0, 1, 2], [0, 2, 3]],
                vertex_colors=[_WHITE] * 4,
            ),
        )


def south(points_km: Floats) -> Floats:
    """East and north, shape (n, 2), as east and south."""
    turned: Floats = points_km * np.array([1.0, -1.0])
    return turned


def curve(reference: Reference) -> Floats:
    """The reference as chart positions (east_km, north_km), close enough on its arcs to look round."""
    arc_rad = np.abs(reference.curvature * reference.length_m)
    pieces = 1 + (arc_rad / _ARC_STEP_RAD).astype(np.int64)
    segment = np.repeat(np.arange(len(pieces)), pieces)
    piece = np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    path_m = reference.start_m[segment] + piece / pieces[segment] * reference.length_m[segment]
    points = reference.at_many(np.append(path_m, reference.end_m))
    return np.column_stack([points.east_m, points.north_m]) / 1000.0


def _posts(time_s: Floats, raised_km: Floats) -> list[Floats]:
    """Vertical lines from the ground to the route, every half hour."""
    at_s = np.arange(time_s[0], time_s[-1] + _POST_S / 2.0, _POST_S)
    tops = np.column_stack([np.interp(at_s, time_s, column) for column in raised_km.T])
    return [np.array([top * (1.0, 1.0, 0.0), top]) for top in tops]


def _labels(at_km: Floats, names: list[str], colour: Colour) -> rr.Points2D:
    return rr.Points2D(south(at_km), labels=names, colors=colour, radii=0.0, show_labels=True)
