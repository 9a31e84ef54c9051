"""What came of a limit: as a value, as a line for people, and for programs."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from recordings.figures import Moment, clock, clock_tenths, number
from recordings.limit_kinds import Against, Always, Compared, Limit, Timely, Value, Within, short

_DIGITS = 6
_WRONG_SIDE = {"<": "over by", "<=": "over by", ">": "short by", ">=": "short by", "==": "off by"}


class Break(NamedTuple):
    """The time for which a limit was broken without a pause, seconds since departure."""

    from_s: float
    to_s: float

    def __str__(self) -> str:
        return f"{clock(self.from_s)} to {clock(self.to_s)}"


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came of a limit.

    `value`: of the figure, of the worst moment, or of what happened; None where there was nothing to measure,
    which is never a pass. `margin`: how far it is on the right side of the bound, negative on the wrong one;
    None where that has no meaning. `worst`: when and where it was at its worst. `broken_s`: for how long it
    was broken, 0 if it was not, None where that has no meaning; `longest`: the longest break. `reason`: why
    it failed, if not for its value.
    """

    limit: Limit | Against
    passed: bool
    value: Value | None
    margin: float | None = None
    worst: Moment | None = None
    broken_s: float | None = None
    longest: Break | None = None
    reason: str = ""

    @property
    def word(self) -> str:
        """PASS or FAIL."""
        return "PASS" if self.passed else "FAIL"

    @property
    def value_text(self) -> str:
        """The value for people: a time of flight as on a clock, "none" where there is none."""
        if self.value is None:
            return "none"
        if isinstance(self.limit, Timely) and isinstance(self.value, float):
            return clock_tenths(self.value)
        return short(self.value)

    @property
    def margin_text(self) -> str:
        """On which side of the bound, and how far; empty without a margin."""
        if self.margin is None:
            return ""
        size = _duration(abs(self.margin)) if isinstance(self.limit, Timely) else number(abs(self.margin))
        if self.margin > 0.0 or self.passed:
            return f"{size} to spare"
        return f"{_wrong_side(self.limit)} {size}"

    @property
    def broken_text(self) -> str:
        """For how long it was broken, and when; empty if it was not."""
        if not self.broken_s:
            return ""
        return f"for {_duration(self.broken_s)}" + (f", longest {self.longest}" if self.longest else "")

    def __str__(self) -> str:
        line = f"{self.word} {self.limit}: {self.value_text}"
        margin = f" ({self.margin_text})" if self.margin_text else ""
        reason = f", {self.reason}" if self.reason else ""
        worst = f", worst {self.worst}" if self.worst is not None else ""
        broken = f", broken {self.broken_text}" if self.broken_text else ""
        return line + margin + reason + worst + broken

    def to_dict(self) -> dict[str, Any]:
        """All of it for JSON."""
        return {
            "limit": str(self.limit),
            "passed": self.passed,
            "value": _plain(self.value),
            "margin": _plain(self.margin),
            "worst": _plain(asdict(self.worst)) if self.worst is not None else None,
            "broken_s": _plain(self.broken_s),
            "longest": _plain(self.longest._asdict()) if self.longest is not None else None,
            "before": _plain(self.limit.before) if isinstance(self.limit, Against) else None,
            "reason": self.reason,
        }


def _wrong_side(limit: Limit | Against) -> str:
    if isinstance(limit, Against):
        return _wrong_side(limit.limit)
    if isinstance(limit, Compared | Always):
        return _WRONG_SIDE[limit.comparison]
    return "outside by" if isinstance(limit, Within) else "missed by"


def _duration(time_s: float) -> str:
    return f"{number(time_s)} s" if time_s < 600.0 else clock(time_s)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, float):
        return round(value, _DIGITS) if math.isfinite(value) else None
    return value
