"""How the pictures of the page look: one style, colours that colour-blind readers tell apart, small files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from planner.pictures import figures

COLOURS = {
    "bfs": "#D55E00",
    "score": "#0072B2",
    "margins": "#CC79A7",
    "survival": "#009E73",
    "abstain": "#56B4E9",
    "replan": "#E69F00",
    "oracle": "#000000",
}
"""Of each policy, out of the palette of Okabe and Ito (2008)."""

MARKS = dict(zip(COLOURS, "svD^oP*", strict=True))
"""The marker of each policy, for those who see no colours."""

SHARES_PERCENT = (-7.0, 107.0)
"""Limits of an axis of shares, with room for markers at its ends."""

_DPI = 110


def new_figure(width_in: float, height_in: float) -> Any:
    """An empty figure; raises PlannerError without matplotlib."""
    return figures().Figure(figsize=(width_in, height_in), layout="constrained")


def save(figure: Any, path: Path) -> None:
    """Write it as PNG, without the date or version that would make every file another."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=_DPI, metadata={"Software": None})


def whole_numbers(axis: Any) -> None:
    """Ticks at whole numbers only, also where there is but one in reach."""
    axis.get_major_locator().set_params(integer=True, min_n_ticks=1)


def bare(axes: Any) -> None:
    """Without the frame's upper and right side, and with a faint grid."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(alpha=0.3)
    axes.set_axisbelow(True)
