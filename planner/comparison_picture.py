"""The routes of a comparison, drawn over the hazard, as a PNG."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.compare import ComparisonRow
from planner.grid import Grid
from planner.pictures import figures
from planner.staged import Cell, StagedProblem

_COLUMNS = 4
_PANEL_INCHES = 3.4
_MARGIN = 0.2  # around what is drawn, of its longer side
_MARGIN_CELLS = 2.0
_LEAST_SHAPE = 0.6  # of a panel: its shorter side over its longer one

Place = tuple[float, float]


class _Sheet(NamedTuple):
    """Kilometres north and east of the start; `cell_km`: the sides of a cell, north and east."""

    start: Cell
    cell_km: Place

    def km(self, row: float, column: float) -> Place:
        """A place in rows and columns as (east, north)."""
        return (column - self.start[1]) * self.cell_km[1], (row - self.start[0]) * self.cell_km[0]


def draw(problem: StagedProblem, grid: Grid, start: Cell, rows: Sequence[ComparisonRow], path: Path) -> None:
    """One panel for each planner: its routes, and how many of the stages each cell is hazardous.

    Blue: routes that keep the rules; red and dashed: routes that enter hazard; crosses: goals without a
    route; dots: waits. The panels show what of the problem's `grid` is around the routes.

    Raises:
        PlannerError: if matplotlib is not installed.
    """
    names = list(dict.fromkeys(row.peer for row in rows))
    share = np.mean(problem.hazard, axis=0)
    sheet = _Sheet(start, (float(grid.north_cell_m.mean()) / 1e3, float(grid.east_cell_m.mean()) / 1e3))
    edges_km = np.array([sheet.km(-0.5, -0.5), sheet.km(share.shape[0] - 0.5, share.shape[1] - 0.5)])
    low_km, high_km = np.clip(_shown(sheet, rows), *edges_km)
    width_km, height_km = high_km - low_km
    across = min(_COLUMNS, max(len(names), 1))
    down = max(-(-len(names) // across), 1)
    figure = figures().Figure(
        figsize=(across * _PANEL_INCHES, down * (_PANEL_INCHES * height_km / width_km + 0.35) + 0.5),
        layout="constrained",
    )
    panels = figure.subplots(down, across, squeeze=False, sharex=True, sharey=True).ravel()
    for panel in panels[len(names) :]:
        panel.set_axis_off()
    for number, (panel, name) in enumerate(zip(panels, names, strict=False)):
        own = [row for row in rows if row.peer == name]
        kept = sum(row.keeps_rules for row in own)
        panel.imshow(
            share,
            origin="lower",
            extent=edges_km.T.ravel(),
            cmap="Greys",
            vmin=0.0,
            vmax=1.3,
            interpolation="nearest",
        )
        panel.set_title(f"{name}: {kept} of {len(own)}", fontsize=9)
        for row in own:
            _draw_row(panel, sheet, row)
        panel.plot(0.0, 0.0, "o", color="black", markersize=4)
        panel.set(xlim=(low_km[0], high_km[0]), ylim=(low_km[1], high_km[1]))
        panel.locator_params(nbins=5)
        panel.tick_params(labelsize=7, labelbottom=number + across >= len(names))
    figure.supylabel("km north of the start", fontsize=8)
    figure.supxlabel(
        "km east of the start\ngoals reached within the rules, of all. Blue: keeps the rules; red, dashed: "
        "breaks one; crosses: no\nroute; dots on the way: waits; grey: share of the stages in which a cell "
        "is hazardous; white: none",
        fontsize=8,
    )
    figure.savefig(path, dpi=110, metadata={"Software": None})


def _shown(sheet: _Sheet, rows: Sequence[ComparisonRow]) -> NDArray[np.float64]:
    """What is drawn and a margin: the south-west and the north-east corner, each (east, north) [km]."""
    drawn = np.array([(0.0, 0.0), *(place for row in rows for place in _places_km(sheet, row))])
    low_km, high_km = drawn.min(axis=0), drawn.max(axis=0)
    middle_km, sides_km = (low_km + high_km) / 2.0, high_km - low_km
    sides_km = sides_km + 2.0 * max(_MARGIN * float(sides_km.max()), _MARGIN_CELLS * max(sheet.cell_km))
    sides_km = np.maximum(sides_km, _LEAST_SHAPE * sides_km.max())
    return np.stack([middle_km - sides_km / 2.0, middle_km + sides_km / 2.0])


def _places_km(sheet: _Sheet, row: ComparisonRow) -> Iterator[Place]:
    """Where a route leads, (east, north), and its goal last."""
    for place in row.route.cells or [(point.row, point.column) for point in row.route.track or ()]:
        yield sheet.km(*place)
    yield sheet.km(*row.goal)


def _draw_row(panel: Any, sheet: _Sheet, row: ComparisonRow) -> None:
    *places, goal = _places_km(sheet, row)
    if not row.route.found:
        panel.plot(*goal, "x", color="tab:red", markersize=6)
        return
    colour, line = ("tab:blue", "-") if row.keeps_rules else ("tab:red", "--")
    panel.plot(*zip(*places, strict=True), line, color=colour, linewidth=1.2)
    for here, there in pairwise(places):
        if here == there:
            panel.plot(*here, ".", color=colour, markersize=4)
    panel.plot(*goal, "o", color=colour, markersize=3)
