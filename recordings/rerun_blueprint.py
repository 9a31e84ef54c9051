"""How a recording opens in the Rerun viewer: chart, oblique view, phases, run card and plots."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import rerun as rr
import rerun.blueprint as rrb

from recordings.recorder import FlightHeader
from recordings.rerun_chart import Chart
from recordings.rerun_plots import ALTITUDE, LEVELS, LEVELS_TITLE, level_range_m, plot_titles
from recordings.rerun_scene import Scene
from recordings.rerun_times import TIMELINE

_BACKGROUND = (11, 14, 20)
_LANES = "Hazard at the aircraft, phase (lead-in grey, loiters amber), stage"
_PLAYBACK_SPEED = 600.0
_TWO_TITLES = 1.3  # times as wide as the other plots are two behind each other, for their titles
_TAIL_SHARE = 0.01  # of the time axis, free at its end


def flight_blueprint(header: FlightHeader, scene: Scene, end_s: float) -> rrb.Blueprint:
    """The arrangement of one flight's views.

    Args:
        header: the flight.
        scene: what is drawn of it.
        end_s: end of the time axes, since departure.
    """
    axis = _time_axis(float(header.reference.start_time_s[0]), end_s)
    right = rrb.Vertical(
        _oblique(scene),
        rrb.StateTimelineView(origin="lanes", name=_LANES, time_view=axis),
        rrb.Horizontal(
            rrb.Tabs(
                rrb.TextDocumentView(origin="card", name="Run card"),
                rrb.TextLogView(origin="events", name="Events"),
            ),
            rrb.TextDocumentView(origin="verdicts", name="Limits"),
            column_shares=[0.48, 0.52],
        ),
        row_shares=[0.3, 0.272, 0.428],
    )
    plots = _plots(plot_titles(header), {}, axis, ALTITUDE, level_range_m([header.plan]))
    return _opened(_chart(scene.chart), right, plots)


def overlay_blueprint(
    scene: Scene,
    errors: Mapping[str, str],
    room: Mapping[str, float],
    *,
    above: str,
    levels_m: tuple[float, float] | None,
    begin_s: float,
    end_s: float,
) -> rrb.Blueprint:
    """The arrangement for several flights.

    Args:
        scene: what is drawn under them.
        errors: entity under which the lines of a plot lie, to the plot's name.
        room: the same to how far up and down it shows.
        above: of these the one of altitude errors.
        levels_m: what a plot of their altitudes shows; None where they have but one.
        begin_s: start of the time axes, since departure.
        end_s: end of the time axes.
    """
    axis = _time_axis(begin_s, end_s)
    card = rrb.TextDocumentView(origin="card", name="Flights")
    right = rrb.Vertical(_oblique(scene), card, row_shares=[0.6, 0.4])
    return _opened(_chart(scene.chart), right, _plots(errors, room, axis, above, levels_m))


def _plots(
    titles: Mapping[str, str],
    room: Mapping[str, float],
    axis: rrb.TimeAxis,
    above: str,
    levels_m: tuple[float, float] | None,
) -> rrb.Horizontal:
    """Plots side by side; that of the altitude, if there is one, in front of that of altitude errors."""
    plots: dict[str, rrb.View | rrb.Container] = {
        entity: _plot(title, entity, axis, (-room[entity], room[entity]) if entity in room else None)
        for entity, title in titles.items()
    }
    if levels_m:
        plots[above] = rrb.Tabs(_plot(LEVELS_TITLE, LEVELS, axis, levels_m), plots[above])
    shares = [_TWO_TITLES if isinstance(plot, rrb.Tabs) else 1.0 for plot in plots.values()]
    return rrb.Horizontal(*plots.values(), column_shares=shares)


def _opened(chart: rrb.View, right: rrb.Container, plots: rrb.Container) -> rrb.Blueprint:
    """Views alone, without panels; the clock follows what is recorded."""
    return rrb.Blueprint(
        rrb.Vertical(
            rrb.Horizontal(chart, right, column_shares=[0.52, 0.48]), plots, row_shares=[0.77, 0.23]
        ),
        rrb.TopPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(
            state="collapsed", timeline=TIMELINE, playback_speed=_PLAYBACK_SPEED, play_state="following"
        ),
        auto_layout=False,
        auto_views=False,
    )


def _time_axis(begin_s: float, end_s: float) -> rrb.TimeAxis:
    """A fixed range; without one the plots open half a minute wide."""
    end_s += _TAIL_SHARE * (end_s - begin_s)
    return rrb.TimeAxis(
        view_range=rr.TimeRange(
            start=rr.TimeRangeBoundary.absolute(seconds=begin_s),
            end=rr.TimeRangeBoundary.absolute(seconds=end_s),
        )
    )


def _since_departure() -> rrb.VisibleTimeRanges:
    """Everything up to the time cursor, so that the flown track grows."""
    return rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rr.TimeRangeBoundary.infinite(),
        end=rr.TimeRangeBoundary.cursor_relative(seconds=0.0),
    )


def _chart(chart: Chart) -> rrb.Spatial2DView:
    view = chart.view
    return rrb.Spatial2DView(
        origin="chart",
        name="Chart, north up: wind, plan and flight",
        visual_bounds=rrb.VisualBounds2D(x_range=[view.west, view.east], y_range=[-view.north, -view.south]),
        overrides=_overrides("chart"),
        background=_BACKGROUND,
    )


def _overrides(view: str) -> Mapping[Any, rrb.VisibleTimeRanges | rrb.EntityBehavior]:
    """The flown track grows; a click on its eye brings up all of the forecast, or the difference from it."""
    hidden = rrb.EntityBehavior(visible=False)
    return {
        f"{view}/flown": _since_departure(),
        f"{view}/weather/forecast/picture": hidden,
        f"{view}/weather/forecast/arrows": hidden,
        f"{view}/weather/difference": hidden,
    }


def _oblique(scene: Scene) -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        origin="scene",
        name=f"Oblique from the south, heights x {scene.heights_by:g}",
        eye_controls=rrb.EyeControls3D(
            position=scene.eye.position_km,
            look_target=scene.eye.target_km,
            eye_up=[0.0, 0.0, 1.0],
        ),
        line_grid=rrb.LineGrid3D(visible=False),
        overrides=_overrides("scene"),
        background=_BACKGROUND,
    )


def _plot(
    name: str, origin: str, axis: rrb.TimeAxis, values: tuple[float, float] | None = None
) -> rrb.TimeSeriesView:
    """A plot; `values`: the least and the greatest that it shows, as wide as they are if None."""
    return rrb.TimeSeriesView(
        origin=origin,
        name=name,
        axis_x=axis,
        axis_y=None if values is None else rrb.ScalarAxis(range=values),
        plot_legend=rrb.PlotLegend(visible=False),
    )
