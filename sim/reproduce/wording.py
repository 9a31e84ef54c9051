"""Figures with their intervals as text, and tables in Markdown."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sim.reproduce.bootstrap import Interval

FEW_DAYS = 10
"""Below so many, intervals over days and what is concluded from them mean little."""


def counted(count: float, what: str) -> str:
    """Such as "1 day" and "2 days"."""
    return f"{count:g} {what}" if count == 1 else f"{count:g} {what}s"


def seeds(days: Sequence[int]) -> str:
    """Such as "seed 1" and "seeds 1 to 30"."""
    return f"seed {days[0]}" if len(days) == 1 else f"seeds {days[0]} to {days[-1]}"


def number(interval: Interval | None, digits: int = 1) -> str:
    """Such as "3.1 (2.8 to 3.4)"."""
    return _shown(interval, 1.0, digits, "")


def percent(interval: Interval | None, digits: int = 0) -> str:
    """Such as "83 % (79 to 87)"."""
    return _shown(interval, 100.0, digits, " %")


def _shown(interval: Interval | None, factor: float, digits: int, unit: str) -> str:
    if interval is None:
        return "-"
    value, low, high = (_rounded(factor * part, digits) for part in interval)
    return f"{value}{unit}" if math.isnan(interval.low) else f"{value}{unit} ({low} to {high})"


def _rounded(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a Markdown table."""
    return [_line(head), _line(["---"] * len(head)), *map(_line, rows)]


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
