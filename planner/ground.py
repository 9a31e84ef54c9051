"""Where and how one may move: hazard, time, occupancy and the moves that can be flown."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from planner.errors import BadFieldError, OutsideGridError, PlannerError
from planner.hazards import OFFSETS, Bools, Move, StageClock

Cell = tuple[int, int]


class Occupancy(StrEnum):
    """Which stages a move asks to be safe.

    PAPER: the cell occupied at step k is safe in the stage that contains k. STRICT: both cells of a move
    are safe in every stage that the move touches.
    """

    PAPER = "paper"
    STRICT = "strict"


@dataclass(frozen=True, slots=True)
class Ground:
    """What a search moves through.

    `hazard`: [stage, north, east]. `flyable`: [stage, move, north, east] by the cell a move leaves, or None
    where every move can be made; waiting is always possible where it is safe. Rows run northward, columns
    eastward.
    """

    hazard: Bools
    clock: StageClock
    occupancy: Occupancy = Occupancy.STRICT
    flyable: Bools | None = None

    def __post_init__(self) -> None:
        stages = self.clock.stage_count
        if self.hazard.ndim != 3 or self.hazard.shape[0] != stages or not self.hazard.size:
            raise BadFieldError(
                f"hazard matrices of shape {self.hazard.shape} do not fit {stages} stages; "
                "give [stage, north, east] with at least one cell"
            )
        expected = (stages, len(Move), *self.hazard.shape[1:])
        if self.flyable is not None and self.flyable.shape != expected:
            raise BadFieldError(f"flyable moves have shape {self.flyable.shape}, not {expected}")

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.hazard.shape[1], self.hazard.shape[2]

    def check_cell(self, name: str, cell: Cell) -> None:
        """Raise OutsideGridError if a cell lies off the grid."""
        rows, columns = self.shape
        if not (0 <= cell[0] < rows and 0 <= cell[1] < columns):
            raise OutsideGridError(
                f"the {name} ({cell[0]}, {cell[1]}) lies off the grid of {rows} rows and {columns} columns; "
                "rows and columns count from 0"
            )

    def check_departures(self, start: Cell, goals: Iterable[Cell], slots: Iterable[int]) -> None:
        """Raise a PlannerError if a cell lies off the grid or a step of departure outside the horizon."""
        for name, cell in (("start", start), *(("goal", goal) for goal in goals)):
            self.check_cell(name, cell)
        steps = self.clock.step_count
        for slot in slots:
            if not 0 <= slot < steps:
                raise PlannerError(f"departure at step {slot} is not within the horizon of {steps} steps")

    def may_move(self, step: int, here: Cell, move: Move) -> bool:
        """Whether a move that ends at a step may leave a safe cell; it must stay on the grid."""
        rows, columns = OFFSETS[move]
        there = here[0] + rows, here[1] + columns
        stage, before = self.clock.stage_of_step(step), self.clock.stage_of_step(step - 1)
        if self.hazard[stage][there]:
            return False
        if self.occupancy is Occupancy.STRICT and (self.hazard[before][there] or self.hazard[stage][here]):
            return False
        return move is Move.STAY or self.flyable is None or bool(self.flyable[before, move][here])
