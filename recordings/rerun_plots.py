"""The plots and the lanes of phases: their lines, names and colours, and the values that go into them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from aircraft.path import Phase
from recordings.recorder import FlightHeader
from recordings.rerun_times import FlightTimes

Floats = NDArray[np.float64]
Colour = tuple[int, int, int]


class Series(NamedTuple):
    """A line of a plot."""

    name: str
    colour: Colour
    width: float = 1.2


_YELLOW, _BLUE, _GREY, _RED = (255, 209, 64), (96, 165, 255), (125, 135, 150), (214, 74, 32)
PLOTS = {
    "plots/off_reference": (
        Series("late [s]", _GREY, 0.8),
        Series("above [m]", _BLUE),
        Series("across, right positive [m]", _YELLOW),
    ),
    "plots/speed": (Series("over ground", _GREY, 0.8), Series("air", _YELLOW)),
    "plots/wind": (Series("with gusts", _GREY, 0.8), Series("wind", _YELLOW)),
}
"""Entity to its lines, in the order drawn: the last lies on top."""

PHASES = {
    Phase.LEAD_IN: "lead-in",
    Phase.LEG: "en route",
    Phase.TURN: "en route",  # hundreds of a few seconds each, which the chart shows better
    Phase.LOITER: "loiter",
}
_LANES = {
    "lanes/phase": {"lead-in": _GREY, "en route": (52, 96, 168), "loiter": (196, 148, 40)},
    "lanes/hazard": {"clear": (44, 92, 70), "in hazard": _RED},
}
_STAGE_COLOURS = ((58, 68, 86), (80, 92, 114))


def draw_plots(stream: rr.RecordingStream, header: FlightHeader, times: FlightTimes) -> None:
    """Log names and colours of all lines and lanes, and the lines of limits from end to end."""
    reference = header.reference
    ends_s = np.array([reference.start_time_s[0], reference.end_time_s[-1]])
    for entity, lines in PLOTS.items():
        stream.log(entity, _style(lines), static=True)
    for entity, limits in (
        ("plots/speed/envelope", {"slowest": header.airspeed_min_mps, "fastest": header.airspeed_max_mps}),
        ("plots/wind/threshold", {"hazard": header.threshold_mps}),
    ):
        stream.log(entity, _style([Series(name, _RED, 1.5) for name in limits]), static=True)
        stream.send_columns(
            entity, times.columns(ends_s), scalars([np.full(2, value) for value in limits.values()])
        )
    stages = header.plan.waypoints[-1].stage + 2  # a late flight sees one more
    numbers = {str(stage): _STAGE_COLOURS[stage % 2] for stage in range(stages)}
    lanes: Mapping[str, Mapping[str, Colour]] = {**_LANES, "lanes/stage": numbers}
    for entity, colours in lanes.items():
        states = rr.StateConfiguration(values=list(colours), colors=list(colours.values()))
        stream.log(entity, states, static=True)


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
        "plots/off_reference": [late_s, above_m, across_m],
        "plots/speed": [np.hypot(state["north_mps"], state["east_mps"]), state["airspeed_mps"]],
        "plots/wind": [gusty_mps, np.hypot(wind_north_mps, wind_east_mps)],
    }


def _style(lines: Sequence[Series]) -> rr.SeriesLines:
    return rr.SeriesLines(
        aggregation_policy=rr.components.AggregationPolicy.MinMax,  # extremes stay visible in a long flight
        names=[line.name for line in lines],
        colors=[line.colour for line in lines],
        widths=[line.width for line in lines],
    )
