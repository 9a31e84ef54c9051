"""The plots and the lanes of phases: their lines, names and colours, and the values that go into them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from aircraft.path import Phase
from planner.plans import Plan
from recordings.limit_bands import limit_bands
from recordings.recorder import FlightHeader
from recordings.rerun_text import drawable
from recordings.rerun_times import FlightTimes

Floats = NDArray[np.float64]
Colour = tuple[int, ...]


class Series(NamedTuple):
    """A line of a plot."""

    name: str
    colour: Colour
    width: float = 1.2


class LimitLine(NamedTuple):
    """A level across a plot; one that is not `shown` only makes room for it."""

    name: str
    level: float
    shown: bool = True


CROSS_TRACK, ALTITUDE, LATENESS = "plots/cross_track", "plots/altitude", "plots/lateness"
SPEED, WIND = "plots/speed", "plots/wind"
LEVELS = "plots/levels"

_YELLOW, _GREY, _RED = (255, 209, 64), (125, 135, 150), (226, 84, 44)
PLOTS = {
    CROSS_TRACK: (Series("right of the reference", _YELLOW),),
    ALTITUDE: (Series("above the reference", _YELLOW),),
    LATENESS: (Series("behind schedule", _YELLOW),),
    SPEED: (Series("over ground", _GREY, 0.8), Series("through the air", _YELLOW)),
    WIND: (Series("with gusts", _GREY, 0.8), Series("steady", _YELLOW)),
}
"""Entity to its lines, in the order drawn: the last lies on top."""

LEVELS_TITLE = "Altitude [m]"
_LEVELS_LINES = (Series("commanded", _GREY, 3.0), Series("flown", _YELLOW))

BANDS = {
    "cross_track_m": CROSS_TRACK,
    "altitude_error_m": ALTITUDE,
    "time_error_s": LATENESS,
    "waypoint_time_error_s": LATENESS,
}
"""The errors that limits are set on, and the plots that they are drawn into."""

_LEAD_IN = "lead-in"
PHASES = {
    Phase.LEAD_IN: _LEAD_IN,
    Phase.LEG: "legs",
    Phase.TURN: "legs",  # hundreds of a few seconds each, which the chart shows better
    Phase.LOITER: "loiter",
}
_LANES = {
    "lanes/phase": {_LEAD_IN: _GREY, "legs": (52, 96, 168), "loiter": (196, 148, 40)},
    "lanes/hazard": {"clear": (44, 92, 70), "hazard": _RED},
}
_NOTHING = (0, 0, 0, 0)
_STAGE_COLOURS = ((58, 68, 86), (80, 92, 114))


def draw_plots(stream: rr.RecordingStream, header: FlightHeader, times: FlightTimes) -> None:
    """Log names and colours of all lines and lanes, and the limits from end to end of the plan."""
    drawn = {**PLOTS, LEVELS: _LEVELS_LINES} if level_range_m([header.plan]) else PLOTS
    for entity, lines in drawn.items():
        stream.log(entity, line_style(lines), static=True)
    for entity, limits in limit_lines(header).items():
        levels = [Series(line.name, _RED if line.shown else _NOTHING, 1.4) for line in limits]
        stream.log(f"{entity}/limits", line_style(levels), static=True)
    ends_s = header.reference.start_time_s[0], header.reference.end_time_s[-1]
    draw_limits(stream, header, times, np.array(ends_s))
    for entity, colours in _LANES.items():
        stream.log(entity, _lane(colours), static=True)


def draw_stages(stream: rr.RecordingStream, plan: Plan) -> None:
    """Log the colours of the lane of stages, for all of a plan; one made anew can take longer."""
    stages = max((point.stage for point in plan.waypoints), default=0) + 2  # a late flight sees one more
    numbers = {str(stage): _STAGE_COLOURS[stage % 2] for stage in range(stages)}
    stream.log("lanes/stage", _lane(numbers), static=True)


def _lane(colours: Mapping[str, Colour]) -> rr.StateConfiguration:
    labels = [" " if name == _LEAD_IN else name for name in colours]  # too short for a word
    return rr.StateConfiguration(values=list(colours), labels=labels, colors=list(colours.values()))


def draw_limits(stream: rr.RecordingStream, header: FlightHeader, times: FlightTimes, time_s: Floats) -> None:
    """Log the lines of the limits at some times."""
    for entity, limits in limit_lines(header).items():
        columns = scalars([np.full(len(time_s), line.level) for line in limits])
        stream.send_columns(f"{entity}/limits", times.columns(time_s), columns)


def limit_lines(header: FlightHeader) -> dict[str, list[LimitLine]]:
    """The lines between which a flight is to stay: entity of the plot to its lines.

    Limits on an error's size bound it on both sides.
    """
    slowest_mps, fastest_mps = header.airspeed_min_mps, header.airspeed_max_mps
    lines = {
        SPEED: [
            LimitLine("slowest", slowest_mps),
            LimitLine("fastest", fastest_mps),
            LimitLine("room", 0.9 * slowest_mps, shown=False),
            LimitLine("room", 1.1 * fastest_mps, shown=False),
        ],
        WIND: [
            LimitLine("hazard", header.threshold_mps),
            LimitLine("room", 1.2 * header.threshold_mps, shown=False),
        ],
    }
    for band in limit_bands(header.limits):
        if band.error in BANDS:
            shown = [LimitLine(band.text, level) for level in band.levels]
            lines.setdefault(BANDS[band.error], []).extend(shown)
    for entity in (CROSS_TRACK, ALTITUDE, LATENESS):
        room = room_for(max((abs(line.level) for line in lines.setdefault(entity, [])), default=0.0))
        lines[entity] += [LimitLine("room", level, shown=False) for level in (room, -room)]
    return lines


def room_for(bound: float) -> float:
    """A level that is shown so that a bound lies well inside a plot, and numbers stand at its side.

    The viewer puts them at powers of ten, and at all their multiples where these are few.
    """
    power = 10.0 ** math.floor(math.log10(bound)) if bound > 0.0 else 1.0
    return 10.0 * power if bound > 3.5 * power else max(1.2 * bound, power)


def plot_titles(header: FlightHeader) -> dict[str, str]:
    """Entity to the title of its plot, from left to right; the titles say what colours mean."""
    limited = limit_lines(header)
    errors = {
        CROSS_TRACK: "Right of path [m]",
        ALTITUDE: "Above path [m]",
        LATENESS: "Behind time [s]",
    }
    for entity, title in errors.items():
        levels = {line.level for line in limited[entity] if line.shown}
        bounds = sorted({abs(level) if -level in levels else level for level in levels})
        limit = f", limit {', '.join(f'{bound:g}' for bound in bounds)}" if bounds else ""
        errors[entity] = title + limit
    return {**errors, SPEED: "Airspeed, ground grey [m/s]", WIND: "Wind, with gusts grey [m/s]"}


def level_range_m(plans: Sequence[Plan]) -> tuple[float, float] | None:
    """What a plot of the altitude shows: the levels and room around them, from 0 if they are low.

    None if there is but one level, and so nothing to show.
    """
    levels_m = {altitude_m for plan in plans for altitude_m, _ in plan.level_flight}
    low_m, high_m = min(levels_m), max(levels_m)
    if low_m == high_m:
        return None
    return max(low_m - 0.5 * (high_m - low_m), 0.0), high_m + 0.1 * (high_m - low_m)


def scalars(lines: Sequence[Floats]) -> rr.ComponentColumnList:
    """The columns of a plot with several lines, one value of each in every row."""
    values = np.column_stack(lines)
    return rr.Scalars.columns(scalars=values.ravel()).partition(np.full(len(values), len(lines)))


def plot_values(
    state: Mapping[str, Floats], late_s: Floats, above_m: Floats, across_m: Floats
) -> dict[str, list[Floats]]:
    """What goes into `PLOTS`: entity to the values of its lines, each of shape (rows,).

    Args:
        state: fields of `FlightState` by name, each of shape (rows,).
        late_s: time behind the schedule.
        above_m: height above the reference.
        across_m: distance right of the reference.
    """
    wind_north_mps, wind_east_mps = state["wind_north_mps"], state["wind_east_mps"]
    gusty_mps = np.hypot(wind_north_mps + state["gust_north_mps"], wind_east_mps + state["gust_east_mps"])
    return {
        CROSS_TRACK: [across_m],
        ALTITUDE: [above_m],
        LATENESS: [late_s],
        SPEED: [np.hypot(state["north_mps"], state["east_mps"]), state["airspeed_mps"]],
        WIND: [gusty_mps, np.hypot(wind_north_mps, wind_east_mps)],
    }


def line_style(lines: Sequence[Series]) -> rr.SeriesLines:
    """Names and colours of the lines of a plot."""
    return rr.SeriesLines(
        aggregation_policy=rr.components.AggregationPolicy.MinMax,  # extremes stay visible in a long flight
        names=[drawable(line.name) for line in lines],
        colors=[line.colour for line in lines],
        widths=[line.width for line in lines],
    )
