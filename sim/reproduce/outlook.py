"""What a planner knows when a forecast has been issued."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from planner.ground import Cell, Ground, Occupancy
from planner.hazards import Bools, StageClock

Floats = NDArray[np.float64]
Way = tuple[Cell, ...] | None
"""The cell at each step from departure to arrival; None where there is no way."""


class Window(NamedTuple):
    """A part of the stages, rows and columns."""

    stages: slice
    rows: slice
    columns: slice

    @classmethod
    def whole(cls) -> Window:
        """All of them."""
        return cls(slice(None), slice(None), slice(None))


class Ensemble(Protocol):
    """An ensemble of forecasts: the chance of hazard, and routes counted in it."""

    def probability(self, blur_cells: float, window: Window) -> Floats:
        """That a cell of a window is hazardous, shape [stage, north, east] of the window."""

    def survived(self, cells: tuple[Cell, ...], clock: StageClock) -> float:
        """The share of members in which a route that departs at step 0 meets no hazard."""


@dataclass(frozen=True)
class Outlook:
    """A forecast, its ensemble, and how one may move.

    `forecast`: makes its hazard [stage, north, east], which not everyone asks for. `flyable`: [stage, move,
    north, east], None where every move can be made.
    """

    forecast: Callable[[], Bools]
    ensemble: Ensemble
    clock: StageClock
    occupancy: Occupancy = Occupancy.PAPER
    flyable: Bools | None = None

    @cached_property
    def hazard(self) -> Bools:
        """Hazard as forecast."""
        return self.forecast()


@dataclass(frozen=True)
class Case:
    """A mission on a day: what policies may look at.

    `truth`: for the oracle alone, and for judging; moves that it calls flyable are so in the true wind.
    `outlook`: as of departure. `later`: as of the beginning of a stage (1, 2, ...), None where no more
    forecasts are issued.
    """

    start: Cell
    goals: tuple[Cell, ...]
    truth: Ground
    outlook: Outlook
    later: Callable[[int], Outlook] | None = None
    _found: dict[Hashable, list[Way]] = field(default_factory=dict)

    def once(self, key: Hashable, find: Callable[[], list[Way]]) -> list[Way]:
        """What several policies begin with, found once."""
        if key not in self._found:
            self._found[key] = find()
        return self._found[key]
