"""How a recording opens in the Rerun viewer: chart, oblique view, phases, run card and plots."""

from __future__ import annotations

import rerun as rr
import rerun.blueprint as rrb

from recordings.rerun_chart import Extent
from recordings.rerun_times import TIMELINE

_BACKGROUND = (11, 14, 20)
_PLAYBACK_SPEED = 600.0
_TAIL_SHARE = 0.01  # of the time axis, free at its end


def flight_blueprint(extent: Extent, *, heights_by: float, begin_s: float, end_s: float) -> rrb.Blueprint:
    """The arrangement of one flight's views.

    Args:
        extent: edges of the chart, kilometres.
        heights_by: exaggeration of heights in the oblique view.
        begin_s: start of the time axes, since departure.
        end_s: end of the time axes.
    """
    axis = _time_axis(begin_s, end_s)
    right = rrb.Vertical(
        _oblique(extent, heights_by),
        rrb.StateTimelineView(origin="lanes", name="Phases, hazard at the aircraft, stages", time_view=axis),
        rrb.Tabs(
            rrb.TextDocumentView(origin="card", name="Run card"),
            rrb.TextLogView(origin="events", name="Events"),
        ),
        row_shares=[0.45, 0.28, 0.27],
    )
    plots = rrb.Horizontal(
        _plot("Across [m] yellow, above [m] blue, late [s] grey", "plots/off_reference", axis),
        _plot("Airspeed yellow, ground speed grey, limits red [m/s]", "plots/speed", axis),
        _plot("Wind yellow, with gusts grey, hazard red [m/s]", "plots/wind", axis),
    )
    return rrb.Blueprint(
        rrb.Vertical(
            rrb.Horizontal(_chart(extent), right, column_shares=[0.55, 0.45]), plots, row_shares=[0.75, 0.25]
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


def _chart(extent: Extent) -> rrb.Spatial2DView:
    width_km, height_km = extent.east - extent.west, extent.north - extent.south
    return rrb.Spatial2DView(
        origin="chart",
        name="Chart, north up: wind, plan and flight",
        visual_bounds=rrb.VisualBounds2D(
            x_range=[extent.west - 0.29 * width_km, extent.east + 0.02 * width_km],
            y_range=[-extent.north - 0.06 * height_km, -extent.south + 0.06 * height_km],
        ),
        overrides={"chart/flown": _since_departure()},
        background=_BACKGROUND,
    )


def _oblique(extent: Extent, heights_by: float) -> rrb.Spatial3DView:
    middle = ((extent.west + extent.east) / 2.0, (extent.south + extent.north) / 2.0)
    width_km = max(extent.east - extent.west, extent.north - extent.south)
    return rrb.Spatial3DView(
        origin="scene",
        name=f"Oblique from the south, heights x {heights_by:g}",
        eye_controls=rrb.EyeControls3D(
            position=[middle[0] - 0.1 * width_km, middle[1] - 0.64 * width_km, 0.38 * width_km],
            look_target=[middle[0], middle[1] - 0.13 * width_km, 0.0],
            eye_up=[0.0, 0.0, 1.0],
        ),
        line_grid=rrb.LineGrid3D(visible=False),
        overrides={"scene/flown": _since_departure()},
        background=_BACKGROUND,
    )


def _plot(name: str, origin: str, axis: rrb.TimeAxis) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=origin, name=name, axis_x=axis, plot_legend=rrb.PlotLegend(visible=False)
    )
