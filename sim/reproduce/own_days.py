"""Days that are given as hazard matrices, true and forecast, as `galeway plan --hazards` reads them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.ground import Cell, Occupancy
from planner.matrix_input import MatrixProblem
from sim.errors import SimError
from sim.matrix_file import read_matrices
from sim.reproduce.ensembles import MatrixEnsemble
from sim.reproduce.outlook import Case, Outlook


@dataclass(frozen=True, slots=True)
class OwnDays:
    """Matrices `[stage, row, column]`, or with a leading axis of days.

    `members_key`: of an ensemble in the forecast's file, `[(day,) member, stage, row, column]`; without one,
    the forecast itself, blurred, is all that is known of the chance of hazard. No forecasts are issued later.
    """

    hazards: Path
    key: str | None
    forecast: Path
    forecast_key: str | None
    members_key: str | None
    start: Cell
    goals: tuple[Cell, ...]
    steps_per_stage: int = 30
    step_s: float = 120.0

    def count(self) -> int:
        """How many days there are.

        Raises:
            SimError: if files cannot be read or do not fit each other; PlannerError for what is no hazard.
        """
        truth = _read(self.hazards, self.key, 4, "hazard matrices", "--key")
        forecast = _read(self.forecast, self.forecast_key, 4, "forecasts", "--forecast-key")
        if truth.shape != forecast.shape:
            raise SimError(
                f"{self.forecast} holds matrices of shape {forecast.shape}, {self.hazards} of {truth.shape} "
                "(days, stages, rows, columns); give a forecast for each"
            )
        if not len(truth):
            raise SimError(f"{self.hazards} holds no day: its shape is {truth.shape}; give one or more")
        if self.members_key is not None:
            members = _read(self.forecast, self.members_key, 5, "members", "--members")
            if (members.shape[0], *members.shape[2:]) != truth.shape:
                raise SimError(
                    f"members of shape {members.shape} do not fit matrices of {truth.shape}; "
                    "give [day, member, stage, row, column]"
                )
        for day in range(len(truth)):
            self.case(day)
        return len(truth)

    def case(self, day: int) -> Case:
        """See `Source`."""
        truth = self._checked(_read(self.hazards, self.key, 4, "hazard matrices", "--key")[day])
        seen = self._checked(_read(self.forecast, self.forecast_key, 4, "forecasts", "--forecast-key")[day])
        members = seen.problem.hazard[None]
        if self.members_key is not None:
            members = _read(self.forecast, self.members_key, 5, "members", "--members")[day] != 0
        outlook = Outlook(lambda: seen.problem.hazard, MatrixEnsemble(members), seen.problem.clock)
        return Case(truth.start, truth.goals, truth.problem.ground, outlook)

    def _checked(self, matrices: NDArray[Any]) -> MatrixProblem:
        return MatrixProblem.checked(
            matrices,
            self.start,
            self.goals,
            survival=False,
            steps_per_stage=self.steps_per_stage,
            step_s=self.step_s,
            weights=None,
            occupancy=Occupancy.PAPER,
        )


@lru_cache(maxsize=3)
def _read(path: Path, key: str | None, axes: int, what: str, ask: str) -> NDArray[Any]:
    """The matrices, with a leading axis of days also where there is but one."""
    matrices = np.asarray(read_matrices(path, key, ask=ask))
    if matrices.ndim not in (axes - 1, axes):
        raise SimError(
            f"{path} holds {what} of shape {matrices.shape}; {axes - 1} axes are needed, or {axes} with the "
            "days first"
        )
    return matrices if matrices.ndim == axes else matrices[None]
