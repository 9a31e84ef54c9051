"""A user's own hazard matrices and cells, checked, before anything is searched."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.errors import BadFieldError, PlannerError
from planner.ground import Cell, Ground, Occupancy
from planner.hazards import Bools, StageClock
from planner.score import Weights
from planner.staged import StagedProblem
from planner.survival import check_level, probability_from_members, without_certain_hazard

Floats = NDArray[np.float64]

BLUR_CELLS = 3.0
"""Blur of the share of members, in cells, unless another is asked for."""


@dataclass(frozen=True, slots=True)
class MatrixProblem:
    """What is asked on hazard matrices.

    `problem`: the matrices; of an ensemble every cell that is hazardous in any member. `members`: the
    ensemble [member, stage, row, column], None without one. `probability`: of hazard, [stage, row, column],
    None where no chance to survive is asked for. `survival`: routes are to be likely to survive, and only
    certain hazard is closed to them.
    """

    problem: StagedProblem
    start: Cell
    goals: tuple[Cell, ...]
    members: Bools | None
    probability: Floats | None
    abstain_below: float
    survival: bool

    @classmethod
    def checked(
        cls,
        hazards: ArrayLike,
        start: Sequence[int],
        goals: Sequence[Sequence[int]],
        *,
        survival: bool,
        steps_per_stage: int,
        step_s: float,
        weights: Weights | None,
        occupancy: Occupancy | str,
        members: ArrayLike | None = None,
        probability: ArrayLike | None = None,
        blur_cells: float = BLUR_CELLS,
        abstain_below: float = 0.0,
    ) -> MatrixProblem:
        """Check all that is given; see `planner.plan` for what it means.

        Raises:
            PlannerError: for input that makes no sense; the message says what and what to give instead.
        """
        matrices = _matrices(hazards, ensemble=survival and members is None)
        ensemble = matrices if len(matrices) > 1 else None
        if members is not None:
            ensemble = _matrices(members, ensemble=True, what="members")
            if ensemble.shape[1:] != matrices.shape[1:]:
                raise BadFieldError(
                    f"members of shape {ensemble.shape} do not fit hazard matrices of {matrices.shape[1:]}; "
                    "give [member, stage, row, column]"
                )
        problem = StagedProblem(
            np.logical_or.reduce(matrices),
            _clock(matrices.shape[1], steps_per_stage, step_s),
            weights or Weights(),
            _occupancy(occupancy),
        )
        begin = _cell("start", start)
        ends = tuple(_cell("goal", goal) for goal in goals)
        if not ends:
            raise PlannerError("no goal is given; name at least one (row, column)")
        problem.ground.check_departures(begin, ends, ())
        check_level(abstain_below)
        source = matrices if ensemble is None and survival else ensemble
        chance = _probability(probability, source, blur_cells)
        if chance is None and abstain_below > 0.0:
            raise PlannerError(
                f"abstain below {abstain_below} asks for a chance to survive; "
                "choose the objective 'survival', or give members or a probability of hazard"
            )
        if chance is not None:
            without_certain_hazard(problem.ground, chance)  # raises where it makes no sense
        return cls(problem, begin, ends, ensemble, chance, abstain_below, survival)

    @property
    def closed(self) -> Ground:
        """Where no route may lead: the matrices, or for survival what is certain to be hazard."""
        if not self.survival or self.probability is None:
            return self.problem.ground
        free = replace(self.problem.ground, hazard=np.zeros_like(self.problem.hazard))
        return without_certain_hazard(free, self.probability)

    def departure(self, step: int) -> int:
        """A step of departure, if it is one of the horizon; else raises PlannerError."""
        self.problem.ground.check_departures(self.start, (), (_whole("departure step", step),))
        return step


def _matrices(hazards: ArrayLike, *, ensemble: bool, what: str = "hazard matrices") -> Bools:
    """The matrices as [member, stage, row, column], of which there is one unless they may be an ensemble."""
    try:
        array = np.asarray(hazards)
        bad = array.dtype.kind not in "biuf"
    except ValueError:
        raise BadFieldError(f"the {what} disagree in shape; give one shape for all stages") from None
    if bad:
        raise BadFieldError(f"{what} of type {array.dtype}; give numbers or booleans")
    if array.ndim not in ((3, 4) if ensemble else (3,)):
        other = "or [member, stage, row, column]" if ensemble else "or pick one by its index"
        raise BadFieldError(f"{what} of shape {array.shape}; give [stage, row, column], {other}")
    if not array.size:
        raise BadFieldError(f"{what} of shape {array.shape} are empty; give a stage with a cell")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        at = tuple(int(index) for index in np.argwhere(~np.isfinite(array))[0])
        raise BadFieldError(
            f"the value of the {what} at {at} is {array[at]}; give 0 for safe and 1 for hazard"
        )
    hazard = np.asarray(array != 0, dtype=np.bool_)
    return hazard[None] if hazard.ndim == 3 else hazard


def _clock(stages: int, steps_per_stage: int, step_s: float) -> StageClock:
    if not np.isfinite(step_s):
        raise BadFieldError(f"a step of {step_s} s; give a finite number above 0")
    return StageClock(0.0, stages, _whole("steps per stage", steps_per_stage), step_s)


def _occupancy(name: Occupancy | str) -> Occupancy:
    try:
        return Occupancy(name)
    except ValueError:
        raise PlannerError(f"the occupancy {name!r} is unknown; choose paper or strict") from None


def _whole(name: str, value: int) -> int:
    try:
        return operator.index(value)
    except TypeError:
        raise PlannerError(f"the {name} {value!r} is not a whole number") from None


def _cell(name: str, cell: Sequence[int]) -> Cell:
    try:
        row, column = cell
    except (TypeError, ValueError):
        raise PlannerError(f"the {name} {cell!r} is not a (row, column)") from None
    return _whole(f"{name}'s row", row), _whole(f"{name}'s column", column)


def _probability(given: ArrayLike | None, members: Bools | None, blur_cells: float) -> Floats | None:
    if given is not None:
        return np.asarray(given, dtype=np.float64)
    return None if members is None else probability_from_members(members, blur_cells=blur_cells)
