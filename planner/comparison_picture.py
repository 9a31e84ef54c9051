"""The routes of a comparison, drawn over the hazard, as a PNG."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from planner.compare import ComparisonRow
from planner.errors import PlannerError
from planner.staged import Cell, StagedProblem

_COLUMNS = 4


def check_picture(path: Path) -> None:
    """Find out before the planners take their minutes whether their routes can be drawn.

    Raises:
        PlannerError: if matplotlib is not installed, the file is no PNG, or its folder does not exist.
    """
    _figures()
    if path.suffix.lower() != ".png":
        raise PlannerError(f"{path} does not end in .png; name a PNG for the picture")
    if not path.parent.is_dir():
        raise PlannerError(f"there is no folder {path.parent} for {path.name}; make it first")


def _figures() -> Any:
    try:
        return importlib.import_module("matplotlib.figure")
    except ImportError as error:
        raise PlannerError("a picture needs matplotlib: pip install 'galeway[plot]'") from error


def draw(problem: StagedProblem, start: Cell, rows: Sequence[ComparisonRow], path: Path) -> None:
    """One panel for each planner: its routes, and how many of the stages each cell is hazardous.

    Blue: routes that keep the rules; red and dashed: routes that enter hazard; crosses: goals without a
    route; dots: waits.

    Raises:
        PlannerError: if matplotlib is not installed.
    """
    figures = _figures()
    names = list(dict.fromkeys(row.peer for row in rows))
    share = np.mean(problem.hazard, axis=0)
    height, width = share.shape
    across = min(_COLUMNS, max(len(names), 1))
    down = max(-(-len(names) // across), 1)
    panel_inches = 3.4
    figure = figures.Figure(
        figsize=(across * panel_inches, down * (panel_inches * height / width + 0.35)),
        layout="constrained",
    )
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for panel in panels:
        panel.set_axis_off()
    for panel, name in zip(panels, names, strict=False):
        own = [row for row in rows if row.peer == name]
        kept = sum(row.keeps_rules for row in own)
        panel.imshow(share, origin="lower", cmap="Greys", vmin=0.0, vmax=1.3, interpolation="nearest")
        panel.set_title(f"{name}: {kept} of {len(own)}", fontsize=9)
        for row in own:
            _draw_row(panel, row)
        panel.plot(start[1], start[0], "o", color="black", markersize=4)
    figure.supxlabel(
        "goals reached within the rules, of all. Blue: keeps the rules; red, dashed: breaks one; crosses: no"
        "\nroute; dots on the way: waits; grey: share of the stages in which a cell is hazardous",
        fontsize=8,
    )
    figure.savefig(path, dpi=110, metadata={"Software": None})


def _draw_row(panel: object, row: ComparisonRow) -> None:
    plot = panel.plot  # type: ignore[attr-defined]
    if not row.route.found:
        plot(row.goal[1], row.goal[0], "x", color="tab:red", markersize=6)
        return
    places = row.route.cells or [(point.row, point.column) for point in row.route.track or ()]
    colour, line = ("tab:blue", "-") if row.keeps_rules else ("tab:red", "--")
    plot([place[1] for place in places], [place[0] for place in places], line, color=colour, linewidth=1.2)
    waits = [here for here, there in pairwise(places) if here == there]
    plot([place[1] for place in waits], [place[0] for place in waits], ".", color=colour, markersize=4)
    plot(row.goal[1], row.goal[0], "o", color=colour, markersize=3)
