"""Weather drawn as a PNG: speed shaded, arrows of the wind, what is hazardous outlined, a panel a time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from planner.hazards import Bools
from planner.pictures import figures
from planner.windfield import FieldArray, Floats, WindField
from sim.weather.times import utc

MOST_PANELS = 12
_ACROSS = 4
_NAME_INCHES, _MOST_NAMES = 0.6, 8  # of meridians: room for one, and how many there are at most
_ARROWS = 15  # along the longer side of a panel
_TOP_STEP_MPS = 5.0
_COLOURS = "YlGnBu"
_OVER, _CLOSED = "#d62728", "#7b3294"


class Panels(NamedTuple):
    """What is drawn: arrays [panel, north, east] on the grid.

    `time_s`: of each panel, or the end of its window, which begins at `begin_s`. `speed_mps`: shaded.
    `north_mps`, `east_mps`: toward, for arrows; None where only the speed is known. `closed`: hazardous for
    another reason than this speed; None for nothing.
    """

    grid: Grid
    time_s: Floats
    speed_mps: FieldArray
    north_mps: FieldArray | None = None
    east_mps: FieldArray | None = None
    closed: Bools | None = None
    begin_s: Floats | None = None


def panels_of(wind: WindField, time_s: Sequence[float], closed: Bools | None = None) -> Panels:
    """Panels of a wind without heights at some moments.

    Raises:
        OutsideFieldError: if the wind does not hold one of them.
    """
    sheets = [wind.sheet(moment_s) for moment_s in time_s]
    north_mps, east_mps = (np.stack(parts) for parts in zip(*sheets, strict=True))
    return Panels(
        wind.grid, np.asarray(time_s, np.float64), np.hypot(north_mps, east_mps), north_mps, east_mps, closed
    )


def chosen_times(time_s: Floats, most: int = MOST_PANELS) -> NDArray[np.intp]:
    """Which of a row of times are drawn: all, or evenly chosen with the first and the last."""
    return np.unique(np.rint(np.linspace(0, len(time_s) - 1, min(most, len(time_s)))).astype(np.intp))


def draw_weather(path: Path, panels: Panels, *, threshold_mps: float, title: str) -> None:
    """Draw panels; the same weather gives the same bytes.

    Raises:
        PlannerError: if matplotlib is not installed.
    """
    grid, count = panels.grid, len(panels.time_s)
    across = min(_ACROSS, count)
    down = -(-count // across)
    stretch = 1.0 / math.cos(float(grid.lat_rad[0] + grid.lat_rad[-1]) / 2.0)  # a degree north over one east
    tall = stretch * (grid.rows * grid.north_step_rad) / (grid.columns * grid.east_step_rad)
    wide_inches = 9.0 if count == 1 else 3.6
    figure = figures().Figure(
        figsize=(
            across * wide_inches + 1.0,
            down * (0.93 * wide_inches * min(max(tall, 0.3), 2.5) + 0.3) + 0.7,
        ),
        layout="constrained",
    )
    axes = figure.subplots(down, across, squeeze=False, sharex=True, sharey=True).ravel()
    top_mps = _TOP_STEP_MPS * math.ceil(max(float(panels.speed_mps.max()), threshold_mps) / _TOP_STEP_MPS)
    shaded = None
    names = max(int(0.9 * wide_inches * min(1.0, 2.5 / tall) / _NAME_INCHES), 1)
    for number, axis in enumerate(axes):
        if number < count:
            shaded = _draw_panel(axis, panels, number, threshold_mps, top_mps)
            axis.set_aspect(stretch)
            axis.tick_params(axis="x", labelbottom=number + across >= count)  # the lowest of its column
            axis.locator_params(axis="x", nbins=min(names, _MOST_NAMES), steps=[1, 2, 5, 10], min_n_ticks=1)
        else:
            axis.set_axis_off()
    bar = figure.colorbar(shaded, ax=axes.tolist(), shrink=0.9, pad=0.015)
    bar.set_label("m/s")
    bar.ax.axhline(threshold_mps, color=_OVER, linewidth=1.5)
    figure.suptitle(title, fontsize=11)
    hatched = "" if panels.closed is None else "; hatched: hazardous for another reason"
    arrows = "" if panels.north_mps is None else "; arrows: where the air moves to"
    figure.supxlabel(f"red: over {threshold_mps:g} m/s{arrows}{hatched}", fontsize=9)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def _draw_panel(axis: Any, panels: Panels, number: int, threshold_mps: float, top_mps: float) -> Any:
    grid, speed_mps = panels.grid, panels.speed_mps[number]
    lat_deg, lon_deg = np.degrees(grid.lat_rad), np.degrees(grid.lon_rad)
    half_lat, half_lon = math.degrees(grid.north_step_rad) / 2.0, math.degrees(grid.east_step_rad) / 2.0
    shaded = axis.imshow(
        speed_mps,
        origin="lower",
        extent=(lon_deg[0] - half_lon, lon_deg[-1] + half_lon, lat_deg[0] - half_lat, lat_deg[-1] + half_lat),
        cmap=_COLOURS,
        vmin=0.0,
        vmax=top_mps,
        interpolation="nearest",
        aspect="auto",
    )
    if speed_mps.min() <= threshold_mps < speed_mps.max():
        axis.contour(lon_deg, lat_deg, speed_mps, levels=[threshold_mps], colors=_OVER, linewidths=1.2)
    if panels.closed is not None and panels.closed[number].any():
        closed = panels.closed[number].astype(np.float64)
        axis.contourf(lon_deg, lat_deg, closed, levels=[0.5, 2.0], colors="none", hatches=["////"])
        axis.contour(lon_deg, lat_deg, closed, levels=[0.5], colors=_CLOSED, linewidths=1.2)
    if panels.north_mps is not None and panels.east_mps is not None:
        stride = max(-(-max(grid.shape) // _ARROWS), 1)
        thin = slice(stride // 2, None, stride)
        shorter = np.sqrt(np.maximum(speed_mps[thin, thin], 1e-3))  # so that weak wind is seen, too
        axis.quiver(
            lon_deg[thin],
            lat_deg[thin],
            panels.east_mps[number][thin, thin] / shorter,
            panels.north_mps[number][thin, thin] / shorter,
            angles="uv",
            pivot="mid",
            scale=math.sqrt(top_mps) * _ARROWS * 0.7,
            width=0.0035,
            color="#30343b",
        )
    ends = [panels.time_s] if panels.begin_s is None else [panels.begin_s, panels.time_s]
    when = dict.fromkeys(utc(float(times_s[number]))[:16].replace("T", " ") for times_s in ends)
    axis.set_title(f"{' to '.join(when)} UTC", fontsize=9)
    axis.tick_params(labelsize=7)
    axis.xaxis.set_major_formatter(_east)
    axis.yaxis.set_major_formatter(_north)
    return shaded


def _north(lat_deg: float, _: object = None) -> str:
    return f"{abs(lat_deg):g}° {'S' if lat_deg < 0.0 else 'N'}"


def _east(lon_deg: float, _: object = None) -> str:
    turned = (lon_deg + 180.0) % 360.0 - 180.0
    return f"{abs(round(turned, 6)):g}° {'W' if turned < 0.0 else 'E'}"
