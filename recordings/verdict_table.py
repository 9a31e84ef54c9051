"""Verdicts as a table, a row each."""

from __future__ import annotations

from collections.abc import Sequence

from recordings.verdicts import Verdict

_HEADINGS = ("limit", "value", "margin", "worst", "broken")


def table(verdicts: Sequence[Verdict]) -> list[str]:
    """The lines of a table, its headings first; PASS or FAIL begins each of the others."""
    rows = [_HEADINGS, *map(_cells, verdicts)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    words = ["    ", *(verdict.word for verdict in verdicts)]
    return [
        f"{word} {'  '.join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))}".rstrip()
        for word, row in zip(words, rows, strict=True)
    ]


def _cells(verdict: Verdict) -> tuple[str, ...]:
    broken = ", ".join(filter(None, (verdict.reason, verdict.broken_text)))
    worst = str(verdict.worst) if verdict.worst is not None else ""
    return str(verdict.limit), verdict.value_text, verdict.margin_text, worst, broken
