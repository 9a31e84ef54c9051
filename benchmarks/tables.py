"""Tables and figures in markdown."""

from __future__ import annotations

from collections.abc import Sequence


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table whose columns, but for the first, are figures."""
    lines = [head, ["---", *("---:" for _ in head[1:])], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def duration(seconds: float) -> str:
    """In milliseconds below one second."""
    if seconds >= 1.0:
        return f"{seconds:.1f} s"
    milliseconds = seconds * 1e3
    return f"{milliseconds:.1f} ms" if milliseconds < 20.0 else f"{milliseconds:.0f} ms"


def times(ratio: float) -> str:
    """How many times faster."""
    return f"{ratio:,.0f} x" if ratio >= 10.0 else f"{ratio:.2f} x"
