"""The picture and the section of figure 2."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from planner.hazards import Bools
from sim.reproduce.bootstrap import mean_interval
from sim.reproduce.drawing import COLOURS, bare, new_figure, save
from sim.reproduce.one_stage import Pair
from sim.reproduce.wording import counted, number, percent, table

_ROOM_CELLS = 25


def draw(pair: Pair, hazard: Bools, path: Path, weight_cap_cells: float) -> None:
    """Both routes on the map, and their clearance on the way."""
    figure = new_figure(9.0, 4.6)
    on_map, on_way = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    cells = np.array([*pair.bfs.cells, *pair.staged.cells])
    middle = (cells.min(axis=0) + cells.max(axis=0)) / 2.0
    half = np.ptp(cells, axis=0).max() / 2.0 + _ROOM_CELLS  # a square, so that the map has room for both
    low, high = middle - half, middle + half
    on_map.imshow(hazard, origin="lower", cmap="Greys", vmin=0.0, vmax=2.4, interpolation="nearest")
    for name, label, route in (("bfs", "plain BFS", pair.bfs), ("score", "staged planner", pair.staged)):
        rows, columns = np.array(route.cells).T
        on_map.plot(columns, rows, color=COLOURS[name], linewidth=2.0, label=label)
        travelled = np.arange(len(route.cells))
        on_way.plot(travelled, route.clearance_cells, color=COLOURS[name], linewidth=1.8, label=label)
    (first_row, first_column), (last_row, last_column) = pair.bfs.cells[0], pair.bfs.cells[-1]
    on_map.plot(first_column, first_row, "ko", markersize=7)
    on_map.plot(last_column, last_row, "k*", markersize=12)
    on_map.annotate("start", (first_column, first_row), xytext=(6, 6), textcoords="offset points")
    on_map.annotate("goal", (last_column, last_row), xytext=(6, 6), textcoords="offset points")
    on_map.set(
        xlim=_within(low[1], high[1], hazard.shape[1]),
        ylim=_within(low[0], high[0], hazard.shape[0]),
        xlabel="cells east",
        ylabel="cells north",
        title="hazard (grey) of one stage",
    )
    on_way.axhline(weight_cap_cells, color="0.5", linestyle=":", linewidth=1.0)
    on_way.set(
        xlabel="steps since departure",
        ylabel="distance to the nearest hazard, cells",
        title="clearance on the way",
        ylim=(0.0, weight_cap_cells * 1.08),
    )
    bare(on_way)
    figure.legend(*on_way.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    save(figure, path)


def _within(low: float, high: float, cells: int) -> tuple[float, float]:
    """Of an axis of the map no more than there is: white beside it would look like safe cells."""
    return max(low, -0.5), min(high, cells - 0.5)


def section(days: Sequence[Sequence[dict[str, Any]]], picture: str | None) -> list[str]:
    """What the page says of figure 2."""
    days = [day for day in days if day]
    if not days:
        return ["On no day both planners reach the same goal, so there is nothing to compare."]
    count = sum(len(day) for day in days)
    lines = [] if picture is None else [f"![Routes within one stage]({picture})", ""]
    names = (
        ("min_clearance_cells", "least clearance, cells"),
        ("mean_clearance_cells", "mean clearance, cells"),
        ("beside_hazard", "share of steps beside hazard (clearance below 2 cells)"),
        ("moves", "moves"),
        ("steps", "steps, waits included"),
        ("score", "f by equation (2)"),
    )
    rows = []
    for key, label in names:
        shown = percent if key == "beside_hazard" else number
        bfs, staged = (
            np.array([np.mean([pair[who][key] for pair in day]) for day in days]) for who in ("bfs", "staged")
        )
        parts = (mean_interval(bfs), mean_interval(staged), mean_interval(staged - bfs))
        rows.append([label, *map(shown, parts)])
    return [
        *lines,
        f"Means over {counted(len(days), 'day')}, of the {counted(count, 'goal')} that both reach:",
        "",
        *table(["", "plain BFS", "staged planner", "difference"], rows),
    ]
