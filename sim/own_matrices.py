"""Planning on hazard matrices of one's own, from a NumPy file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import planner
from planner.ground import Cell
from sim.errors import SimError


def plan_matrices(
    path: Path, key: str | None, index: int | None, start: str, goals: tuple[str, ...], **how: Any
) -> list[dict[str, Any]]:
    """Plan on the matrices of a file; see `planner.plan`.

    Args:
        path: .npz or .npy, `[stage, row, column]` or with a leading axis.
        key: the array's name in an .npz with several.
        index: of the leading axis.
        start: "row,column".
        goals: the same.
        how: passed on to `planner.plan`.

    Returns:
        One dictionary a goal, ready for JSON.

    Raises:
        SimError: if the file or a cell cannot be read; PlannerError for what the planner refuses.
    """
    hazards = _matrices(path, key)
    if index is not None:
        if not -len(hazards) <= index < len(hazards):
            raise SimError(f"--index {index} is outside the {len(hazards)} sets of {path}; count from 0")
        hazards = hazards[index]
    found = planner.plan(hazards, _cell(start), [_cell(goal) for goal in goals], **how)
    return [goal.to_dict() for goal in found]


def _matrices(path: Path, key: str | None) -> Any:
    try:
        loaded = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise SimError(f"cannot read hazard matrices from {path}: {error}; give .npz or .npy") from error
    if isinstance(loaded, np.ndarray):
        return loaded
    with loaded:
        names = list(loaded.files)
        name = names[0] if key is None and len(names) == 1 else key
        if name not in names:
            raise SimError(f"{path} holds {', '.join(names) or 'nothing'}; name one with --key, not {key!r}")
        try:
            return loaded[name]
        except (OSError, ValueError) as error:
            raise SimError(f"cannot read {name!r} of {path}: {error}") from error


def _cell(text: str) -> Cell:
    try:
        row, column = (int(part) for part in text.split(","))
    except ValueError:
        raise SimError(f"the cell {text!r} is not of the form ROW,COLUMN, such as 37,251") from None
    return row, column
