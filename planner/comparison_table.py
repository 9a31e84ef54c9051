"""A comparison in plain text: every row, or a line for each planner."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from statistics import fmean

from planner.compare import ComparisonRow
from planner.staged import Cell

_ROWS_HEAD = (
    "planner", "goal", "arrival", "delay", "length", "waits", "min D", "mean D", "score", "truth", "ms", ""
)  # fmt: skip
_SUMMARY_HEAD = (
    "planner", "found", "kept", "first", "truth", "delay", "worst", "length", "waits", "min D", "mean D",
    "score", "ms",
)  # fmt: skip


def rows_table(rows: Iterable[ComparisonRow], goal_names: Sequence[tuple[Cell, str]] = ()) -> str:
    """A line for each planner and goal; the last column says what is wrong with the route, or its absence.

    Arrival, delay and waits in steps; length and clearance D in cells; truth: safe in the true hazard.
    """
    names = dict(goal_names)
    lines = [
        (
            row.peer,
            names.get(row.goal, f"{row.goal[0]},{row.goal[1]}"),
            _number(row.arrival_step),
            _number(row.delay_steps, sign=True),
            _number(row.length_cells),
            _number(row.waits),
            _number(row.min_clearance_cells),
            _number(row.mean_clearance_cells),
            _number(row.score),
            {True: "safe", False: "hazard", None: "-"}[row.safe_in_truth],
            _number(1000.0 * row.wall_s),
            row.breach or row.route.reason,
        )
        for row in rows
    ]
    return _table(_ROWS_HEAD, lines)


def summary_table(rows: Iterable[ComparisonRow]) -> str:
    """A line for each planner.

    Of the goals: found, a route was given; kept, it breaks no rule of the problem; first, it is kept and as
    early as can be; truth, it is safe in the true hazard. The rest is over the routes that were kept: mean
    and worst delay and mean waits in steps, mean length and clearances in cells, mean score. ms: mean time
    over all goals.
    """
    lines = []
    for name, group in groupby(rows, key=lambda row: row.peer):
        own = list(group)
        kept = [row for row in own if row.keeps_rules]
        delays = [row.delay_steps for row in kept if row.delay_steps is not None]
        truth = [row.safe_in_truth for row in own]
        lines.append(
            (
                name,
                f"{sum(row.route.found for row in own)}/{len(own)}",
                f"{len(kept)}/{len(own)}",
                f"{sum(delay <= 0.0 for delay in delays)}/{len(own)}",
                f"{truth.count(True)}/{len(own)}" if truth.count(None) < len(own) else "-",
                _mean(delays, sign=True),
                _number(max(delays, default=None), sign=True),
                _mean(row.length_cells for row in kept),
                _mean(row.waits for row in kept),
                _number(min((row.min_clearance_cells or 0.0 for row in kept), default=None)),
                _mean(row.mean_clearance_cells for row in kept),
                _mean(row.score for row in kept),
                _number(1000.0 * fmean(row.wall_s for row in own)),
            )
        )
    return _table(_SUMMARY_HEAD, lines)


def _mean(values: Iterable[float | None], *, sign: bool = False) -> str:
    known = [value for value in values if value is not None]
    return _number(fmean(known) if known else None, sign=sign)


def _number(value: float | None, *, sign: bool = False) -> str:
    if value is None:
        return "-"
    text = f"{value:{'+' if sign else ''}.1f}".removesuffix(".0")
    return "0" if text in ("-0", "+0") else text


def _table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    widths = [max(map(len, column)) for column in zip(head, *lines, strict=True)]
    left = {0, 1 if "goal" in head else 0, len(head) - 1 if not head[-1] else 0}

    def line(cells: Sequence[str]) -> str:
        padded = (
            cell.ljust(width) if at in left else cell.rjust(width)
            for at, (cell, width) in enumerate(zip(cells, widths, strict=True))
        )
        return "  ".join(padded).rstrip()

    return "\n".join([line(head), *(line(cells) for cells in lines)]) + "\n"
