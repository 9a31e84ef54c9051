"""What does not change during a flight: plan, places, graticule, and how the moving things look.

Entities under `chart` lie in kilometres east and south, because the second axis of a two-dimensional view
points down; those under `scene` in kilometres east, north and up, heights exaggerated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from aircraft.reference import Reference
from planner.plans import Plan
from recordings.aircraft_mesh import aircraft_mesh
from recordings.oblique_eye import Eye, nearest_eye
from recordings.recorder import FlightHeader
from recordings.rerun_chart import Chart
from recordings.rerun_labels import Colour, arrange, labels
from recordings.rerun_legend import Legend, Stroke
from recordings.rerun_text import drawable

Floats = NDArray[np.float64]
Drawn = Iterator[tuple[str, rr.AsComponents]]

PLAN_COLOUR: Colour = (58, 134, 255)
FLOWN_COLOUR: Colour = (255, 209, 64)
_REFERENCE_COLOUR: Colour = (160, 205, 255)
_POST_COLOUR: Colour = (58, 134, 255, 110)
_WHITE: Colour = (255, 255, 255)
_DARK: Colour = (11, 14, 20)
_GOAL_COLOUR: Colour = (120, 230, 140)
_REACHABLE_COLOUR: Colour = (190, 198, 210)
_UNREACHABLE_COLOUR: Colour = (255, 120, 120)
_LINE_COLOUR: Colour = (120, 135, 160, 70)
_TEXT_COLOUR: Colour = (150, 162, 182)

_HIGHEST_SHARE = 0.07  # height of the highest waypoint in the oblique view, of the chart's width
_SPAN_SHARE = 0.3  # of the aircraft in the oblique view, of the distance from there
_GLYPH_PX = 30.0
_BESIDE_PX = 7.0  # from a place to its label; where the aircraft comes, the aircraft lies between
_GLYPH = (
    ((0.0, 0.45), (0.0, -0.45)),
    ((-0.5, 0.02), (0.0, 0.12), (0.5, 0.02)),
    ((-0.17, -0.47), (0.0, -0.43), (0.17, -0.47)),
)
"""Fuselage, wing and tail of the aircraft on the chart; the span is one."""
_POSTS = 37
_BELOW_PX = 1.5  # of the plan in the oblique view, so that it does not fight with the flown line for pixels
_ARC_STEP_RAD = 0.15


class Place(NamedTuple):
    """A point with a name. `end`: where the flight begins or is to end."""

    east_km: float
    north_km: float
    label: str
    colour: Colour
    end: bool


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

    @cached_property
    def eye(self) -> Eye:
        """An eye in the south, as near as it sees the whole route from."""
        raised = self._raised(self.header.plan)
        route = np.concatenate([raised, raised * (1.0, 1.0, 0.0)])
        return nearest_eye(route, 0.15 * self._size_km)

    def draw(self, stream: rr.RecordingStream) -> None:
        """Log all of it, valid at every time."""
        for part in (self.places(), self.graticule(), self._legend(), self._moving()):
            for entity, archetype in part:
                stream.log(entity, archetype, static=True)

    @cached_property
    def _size_km(self) -> float:
        extent = self.chart.extent
        return max(extent.east - extent.west, extent.north - extent.south)

    def route(self, plan: Plan) -> Drawn:
        """A plan, which may change in flight."""
        raised, times_s = self._raised(plan), np.array([point.time_s for point in plan.waypoints])
        below = raised - np.array([0.0, 0.0, _BELOW_PX * self.chart.px_km])
        route = south(raised[:, :2])
        yield "chart/plan", rr.LineStrips2D([route], colors=PLAN_COLOUR, radii=-2.6, draw_order=30.0)
        yield "scene/plan", rr.LineStrips3D([below], colors=PLAN_COLOUR, radii=-2.0)
        yield "scene/posts", rr.LineStrips3D(_posts(times_s, below), colors=_POST_COLOUR, radii=-0.6)

    def _raised(self, plan: Plan) -> Floats:
        """The waypoints in the oblique view: east, north, up."""
        points = plan.waypoints
        up_km = np.array([point.altitude_m for point in points]) / 1000.0 * self.heights_by
        return np.column_stack([[self.chart.km(point.lat_deg, point.lon_deg) for point in points], up_km])

    def places(self) -> Drawn:
        """Start and goals."""
        places = list(self._named_places())
        ends = [place for place in places if place.end]
        ground = np.array([place[:2] for place in places])
        yield (
            "chart/places",
            rr.Points2D(
                south(ground), colors=[place.colour for place in places], radii=-4.0, draw_order=40.0
            ),
        )
        line = _close_points(self._raised(self.header.plan)[:, :2], self.chart.px_km)
        beside_px = [_GLYPH_PX / 2.0 if place.end else _BESIDE_PX for place in places]
        middles = arrange(self.chart, ground, [place.label for place in places], line, beside_px)
        shown = [(place, at) for place, at in zip(places, middles, strict=True) if at is not None]
        yield (
            "chart/places/names",
            labels(
                self.chart,
                np.array([at for _, at in shown]),
                [place.label for place, _ in shown],
                [place.colour for place, _ in shown],
            ),
        )
        yield (
            "scene/places",
            rr.Points3D(
                [(place.east_km, place.north_km, 0.0) for place in ends],
                labels=[drawable(place.label) for place in ends],
                colors=[place.colour for place in ends],
                radii=-4.0,
                show_labels=True,
            ),
        )

    def _named_places(self) -> Iterator[Place]:
        """Start and goal first: they get their labels before others."""
        plan = self.header.plan
        first = plan.waypoints[0]
        yield Place(*self.chart.km(first.lat_deg, first.lon_deg), "start", _WHITE, True)
        for goal in sorted(plan.goals, key=lambda goal: goal.name != plan.goal):
            at_km = self.chart.km(goal.lat_deg, goal.lon_deg)
            if goal.name == plan.goal:
                yield Place(*at_km, f"goal: {goal.name}", _GOAL_COLOUR, True)
            elif goal.reachable:
                yield Place(*at_km, goal.name, _REACHABLE_COLOUR, False)
            else:
                yield Place(*at_km, f"× {goal.name}", _UNREACHABLE_COLOUR, False)

    def graticule(self) -> Drawn:
        """Meridians and parallels with their degrees."""
        lines = self.chart.graticule()
        flat = [np.column_stack([line.east_km, line.north_km]) for line in lines]
        raised = [np.column_stack([line, [0.5, 0.5] * np.array(self.chart.px_km)]) for line in flat]
        yield (
            "chart/graticule",
            rr.LineStrips2D([south(line) for line in flat], colors=_LINE_COLOUR, radii=-0.5, draw_order=1.0),
        )
        yield "scene/graticule", rr.LineStrips3D(raised, colors=_LINE_COLOUR, radii=-0.5)
        beside, under = self.chart.px_km * np.array([-25.0, 0.0]), self.chart.px_km * np.array([0.0, -17.0])
        at = [line[0] + (beside if line[0, 1] == line[1, 1] else under) for line in flat]
        names = [line.name for line in lines]
        yield "chart/graticule/names", labels(self.chart, np.array(at), names, [_TEXT_COLOUR] * len(names))

    def _legend(self) -> Drawn:
        strokes = [
            Stroke("plan", PLAN_COLOUR, 2.6),
            Stroke("reference", _REFERENCE_COLOUR, 0.6),
            Stroke("flown", FLOWN_COLOUR, 1.6),
        ]
        if not all(goal.reachable for goal in self.header.plan.goals):
            strokes.append(Stroke("× no route", _UNREACHABLE_COLOUR, 4.0, dot=True))
        return Legend(self.chart, self.header.threshold_mps, bool(self.header.also)).draw(strokes)

    @property
    def glyph_km(self) -> list[Floats]:
        """The lines of the aircraft on the chart, pointing north: (east, north)."""
        return [_GLYPH_PX * self.chart.px_km * np.array(stroke) for stroke in _GLYPH]

    def _moving(self) -> Drawn:
        """How the flown line looks, and an aircraft that points north for transforms to turn and move."""
        yield "chart/flown", rr.LineStrips2D.from_fields(colors=FLOWN_COLOUR, radii=-1.6, draw_order=35.0)
        yield "scene/flown", rr.LineStrips3D.from_fields(colors=FLOWN_COLOUR, radii=-1.6)
        strokes = [south(stroke) for stroke in self.glyph_km]
        for entity, colour, radius_px, order in (
            ("chart/aircraft/halo", _DARK, 3.4, 49.0),
            ("chart/aircraft/glyph", _WHITE, 1.7, 50.0),
        ):
            yield entity, rr.LineStrips2D(strokes, colors=colour, radii=-radius_px, draw_order=order)
        mesh = aircraft_mesh()
        yield (
            "scene/aircraft/mesh",
            rr.Mesh3D(
                vertex_positions=_SPAN_SHARE * self.eye.distance_km * mesh.corners.reshape(-1, 3),
                vertex_normals=np.repeat(mesh.normals, 3, axis=0),
                vertex_colors=np.repeat(mesh.colours, 3, axis=0),
            ),
        )


def south(points_km: Floats) -> Floats:
    """East and north, shape (n, 2), as east and south."""
    turned: Floats = points_km * np.array([1.0, -1.0])
    return turned


def flyable(reference: Reference) -> Drawn:
    """The reference, which may be laid anew in flight."""
    line = south(curve(reference))
    yield "chart/reference", rr.LineStrips2D([line], colors=_REFERENCE_COLOUR, radii=-0.6, draw_order=31.0)


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
    """Vertical lines from the ground to the route, as far apart in time each from the next."""
    at_s = np.linspace(time_s[0], time_s[-1], _POSTS)
    tops = np.column_stack([np.interp(at_s, time_s, column) for column in raised_km.T])
    return [np.array([top * (1.0, 1.0, 0.0), top]) for top in tops]


def _close_points(line_km: Floats, step_km: float) -> Floats:
    """Points on a line, hardly farther from each other than a step."""
    along_km = np.append(0.0, np.cumsum(np.hypot(*np.diff(line_km, axis=0).T)))
    at_km = np.linspace(0.0, along_km[-1], 2 + int(along_km[-1] / step_km))
    return np.column_stack([np.interp(at_km, along_km, axis) for axis in line_km.T])
