"""What pictures need: matplotlib, which is an extra, and a file that can be written."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from planner.errors import PlannerError


def figures() -> Any:
    """The figures of matplotlib, drawn without a screen.

    Raises:
        PlannerError: if matplotlib is not installed.
    """
    try:
        return importlib.import_module("matplotlib.figure")
    except ImportError as error:
        raise PlannerError("a picture needs matplotlib: pip install 'galeway[plot]'") from error


def check_picture(path: Path) -> None:
    """Find out before anything takes its minutes whether a picture of it can be drawn.

    Raises:
        PlannerError: if matplotlib is not installed, the file is no PNG, or its folder does not exist.
    """
    figures()
    if path.suffix.lower() != ".png":
        raise PlannerError(f"{path} does not end in .png; name a PNG for the picture")
    if not path.parent.is_dir():
        raise PlannerError(f"there is no folder {path.parent} for {path.name}; make it first")
