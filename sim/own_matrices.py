"""Planning on hazard matrices of one's own, from a NumPy file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import planner
from planner.ground import Cell
from sim.departing import Departing
from sim.errors import SimError
from sim.matrix_file import read_matrices
from sim.plan_job import write_isochrones


@dataclass(frozen=True, slots=True)
class MatrixAnswer:
    """What came of it: for JSON, the table of departures to read, if there is one, and whether all is well.

    `passed`: each goal has a route that is to be flown.
    """

    answer: Any
    table: str | None
    passed: bool


def plan_matrices(
    path: Path,
    key: str | None,
    index: int | None,
    members_key: str | None,
    start: str,
    goals: tuple[str, ...],
    departing: Departing | None,
    isochrones: Path | None,
    **how: Any,
) -> MatrixAnswer:
    """Plan on the matrices of a file; see `planner.plan`.

    Args:
        path: .npz or .npy, `[stage, row, column]` or with a leading axis.
        key: the array's name in an .npz with several.
        index: of the leading axis; without, a leading axis is an ensemble.
        members_key: the name of an ensemble in the same .npz, `[member, stage, row, column]`.
        start: "row,column".
        goals: the same.
        departing: the departures to choose from.
        isochrones: where to write the arrival step of every cell.
        how: passed on to `planner.plan` or `planner.plan_departures`.

    Raises:
        SimError: if the file or a cell cannot be read; PlannerError for what the planner refuses.
    """
    survival = how.get("objective") == "survival" or (
        departing is not None and departing.best_by == "survival"
    )
    if "blur_cells" in how and not survival and members_key is None:
        raise SimError(
            "--blur-cells blurs the share of members for survival; add --objective survival or --members KEY"
        )
    if members_key is not None:
        how["members"] = read_matrices(path, members_key, ask="--members")
    hazards = read_matrices(path, key)
    if index is not None:
        if hazards.ndim == 0 or not -len(hazards) <= index < len(hazards):
            sets = len(hazards) if hazards.ndim else 0
            raise SimError(f"--index {index} is outside the {sets} sets of {path}; count from 0")
        hazards = hazards[index]
    begin, ends = cell_of(start, "--start"), [cell_of(goal, "--goal") for goal in goals]
    if isochrones is not None:
        _write_isochrones(isochrones, hazards, begin, departing, how)
    if departing is None:
        found = planner.plan(hazards, begin, ends, **how)
        return MatrixAnswer([goal.to_dict() for goal in found], None, _all_flown(found))
    chosen = planner.plan_departures(
        hazards,
        begin,
        ends,
        departing.slots_min,
        best_by=departing.best_by,
        distinct=departing.distinct,
        **how,
    )
    return MatrixAnswer(chosen.to_dict(), chosen.table.text(), _all_flown(chosen.goals))


def _all_flown(goals: list[planner.GoalPlan]) -> bool:
    return all(goal.reachable and not goal.abstained for goal in goals)


def _write_isochrones(
    path: Path, hazards: Any, start: Cell, departing: Departing | None, how: dict[str, Any]
) -> None:
    if departing is not None or how.get("objective") == "survival":
        raise SimError(
            "--isochrones belong to one departure over hazard that is certain; "
            "leave out --departures and --objective survival"
        )
    asked = {name: how[name] for name in ("steps_per_stage", "step_s", "occupancy") if name in how}
    write_isochrones(path, planner.isochrones(hazards, start, **asked))


def cell_of(text: str, option: str) -> Cell:
    """A cell as it is written on the command line, in an option of that name."""
    try:
        row, column = (int(part) for part in text.split(","))
    except ValueError:
        raise SimError(f"{option} {text!r} is not of the form ROW,COLUMN, such as 37,251") from None
    return row, column
