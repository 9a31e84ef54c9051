"""How large the weather is in which the experiments are made, and where missions lie in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from planner.grid import Grid
from planner.hazards import StageClock
from planner.windfield import FieldArray
from sim.reproduce.outlook import Floats, Window

DEPARTURE_S = 86_400.0
"""Of every mission: a day after the beginning of all times that recordings know."""

_EQUATOR_DEGREE_M = 111_200.0


@dataclass(frozen=True, slots=True)
class World:
    """The size of a day's weather and of its missions.

    It lies across the equator, where cells of one angle are of one size. Weather is known on nodes, each
    `node_cells` cells apart, with wind bilinear between them. `system_m`, `life_s`: over which the wind is
    correlated in space, and in time as it drifts. `drifts_mps`: slowest and fastest. `shares`: least and
    greatest part of the area over the threshold at one moment. `age_s`: of the forecast at departure.
    `distances_cells`: least and greatest distance of a goal, in moves. `start_clear_cells`: how far around
    the start no cell is hazardous in the first stage, since nobody departs beside a storm.
    """

    rows: int
    columns: int
    stage_count: int
    steps_per_stage: int
    goals: int
    system_m: float
    distances_cells: tuple[int, int]
    start_clear_cells: int
    age_s: float = 0.0
    drifts_mps: tuple[float, float] = (4.0, 12.0)
    life_s: float = 12 * 3600.0
    shares: tuple[float, float] = (0.10, 0.25)
    step_s: float = 120.0
    cell_m: float = 3600.0
    node_cells: int = 4
    threshold_mps: float = 15.0

    @property
    def clock(self) -> StageClock:
        """The stages."""
        return StageClock(DEPARTURE_S, self.stage_count, self.steps_per_stage, self.step_s)

    @property
    def grid(self) -> Grid:
        """The planner's cells."""
        return self._grid(self.rows, self.columns, 1)

    @property
    def nodes(self) -> Grid:
        """The nodes on which weather is known; every `node_cells`-th cell lies on one."""
        rows, columns = (-(-(count - 1) // self.node_cells) + 1 for count in (self.rows, self.columns))
        return self._grid(rows, columns, self.node_cells)

    def spread(self, on_nodes: FieldArray, window: Window | None = None) -> Floats:
        """What is given on the nodes, bilinear between them, on the cells of a window, all by default.

        Args:
            on_nodes: shape (..., node north, node east).
            window: its rows and columns.
        """
        window = window or Window.whole()
        rows = self._weights(self.rows, on_nodes.shape[-2], window.rows)
        columns = self._weights(self.columns, on_nodes.shape[-1], window.columns)
        return np.asarray(rows @ on_nodes @ columns.T)

    def _weights(self, count: int, nodes: int, window: slice) -> Floats:
        """What each node weighs in each cell of an axis, shape (cells, nodes)."""
        place = np.arange(count)[window, None] / self.node_cells
        return np.clip(1.0 - np.abs(place - np.arange(nodes)), 0.0, None)

    def _grid(self, rows: int, columns: int, step_cells: int) -> Grid:
        cell_rad = math.radians(self.cell_m / _EQUATOR_DEGREE_M)
        south_rad = -cell_rad * (self.rows - 1) / 2.0
        return Grid(south_rad, 0.0, step_cells * cell_rad, step_cells * cell_rad, rows, columns)


PAPER = World(
    548, 421, 18, 30, 10, system_m=220e3, distances_cells=(100, 450), start_clear_cells=8, node_cells=8
)
"""The paper's: 548 x 421 cells, 18 stages of 30 steps, ten goals."""

FLOWN = World(
    65,
    65,
    6,
    10,
    2,
    system_m=30e3,
    life_s=2.5 * 3600.0,
    drifts_mps=(2.0, 6.0),
    shares=(0.14, 0.27),
    distances_cells=(16, 30),
    start_clear_cells=2,
    age_s=2 * 3600.0,
)
"""For flights of half an hour to two hours: weather of a seventh of the size that changes five times as fast,
in stages of twenty minutes, planned on a forecast that is two hours old."""

QUICK = replace(FLOWN, goals=4)
"""For a look at what the command makes, in seconds."""
