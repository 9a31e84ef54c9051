"""A route on the grid, and its value by equation (2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.ground import Cell
from planner.hazards import StageClock
from planner.score import Weights


@dataclass(frozen=True, slots=True)
class ScoreTerms:
    """The four terms of equation (2), with their signs: f is their sum."""

    clearance: float
    mean_clearance: float
    length: float
    time: float

    @property
    def total(self) -> float:
        """The score f."""
        return self.clearance + self.mean_clearance + self.length + self.time


@dataclass(frozen=True, slots=True)
class Route:
    """One way to a goal: the cell occupied at each step from the departure's to the arrival's.

    `clearance_cells`: distance to the nearest hazard at each of those steps, capped. `first_step`: that of
    departure.
    """

    cells: tuple[Cell, ...]
    clearance_cells: tuple[float, ...]
    terms: ScoreTerms
    first_step: int = 0

    @property
    def arrival_step(self) -> int:
        """The step at which the goal is reached."""
        return self.first_step + len(self.cells) - 1

    @property
    def waits(self) -> int:
        """Steps spent without moving."""
        return sum(here == there for here, there in zip(self.cells, self.cells[1:], strict=False))

    @property
    def moves(self) -> int:
        """Steps spent moving, the length L in cells."""
        return len(self.cells) - 1 - self.waits

    @property
    def score(self) -> float:
        """Equation (2) at the arrival."""
        return self.terms.total

    @property
    def steps(self) -> tuple[tuple[int, int, int], ...]:
        """The route as (step, row, column)."""
        return tuple((self.first_step + at, *cell) for at, cell in enumerate(self.cells))


def evaluate(
    cells: tuple[Cell, ...],
    clearance: NDArray[np.float64],
    clock: StageClock,
    weights: Weights,
    first_step: int = 0,
) -> Route:
    """The route over the given cells, with its clearance and score.

    Args:
        cells: occupied at each step.
        clearance: capped, [stage, north, east], in cells.
        clock: the stages.
        weights: of equation (2).
        first_step: the step of departure.
    """
    steps = np.arange(first_step, first_step + len(cells))
    rows, columns = np.array(cells, dtype=np.intp).T
    clear = clearance[steps // clock.steps_per_stage, rows, columns]
    moves = int(np.count_nonzero(np.diff(rows) | np.diff(columns)))
    terms = ScoreTerms(
        clearance=weights.alpha * float(clear[-1]),
        mean_clearance=weights.beta * float(clear.mean()),
        length=-weights.gamma * moves,
        time=-weights.delta * (len(cells) - 1),
    )
    return Route(cells, tuple(clear.tolist()), terms, first_step)
