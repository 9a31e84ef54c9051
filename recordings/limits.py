"""Limits on the figures of a report, such as `cross_track_m.p95 <= 2`, and what came of them."""

from __future__ import annotations

import difflib
import json
import math
import operator
import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any, cast, get_type_hints

from recordings.errors import BadLimitError
from recordings.figures import Moment, number
from recordings.recorder import Outcome
from recordings.tracking import Tracking
from recordings.tracking_report import NOT_REPORTED

_OPERATORS = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_EXPRESSION = re.compile(r"\s*([A-Za-z_][\w.]*)\s*(<=|>=|==|!=|<|>)\s*(.+?)\s*")
_EXAMPLE = 'write it like `cross_track_m.p95 <= 2`, `arrived == true` or `outcome == "arrived"`'

_WRONG_SIDE = {"<": "over by", "<=": "over by", ">": "short by", ">=": "short by", "==": "off by"}

Value = bool | str | float


@dataclass(frozen=True, slots=True)
class Limit:
    """A figure of the report, by name, and what it has to be."""

    name: str
    comparison: str
    bound: Value

    def __str__(self) -> str:
        return f"{self.name} {self.comparison} {_text(self.bound)}"


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came of a limit.

    `value`: of the figure, None where there was nothing to measure, which is never a pass. `margin`: how far
    the value is on the right side of the bound, negative on the wrong one; None where that has no meaning.
    `worst`: when and where the figure was at its worst. `reason`: why it failed, if not for its value.
    """

    limit: Limit
    passed: bool
    value: Value | None
    margin: float | None = None
    worst: Moment | None = None
    reason: str = ""

    def __str__(self) -> str:
        line = f"{'PASS' if self.passed else 'FAIL'} {self.limit}: {_text(self.value)}"
        if self.margin is not None:
            size = number(abs(self.margin))
            right_side = self.passed or self.reason
            line += f" ({size} to spare)" if right_side else f" ({_WRONG_SIDE[self.limit.comparison]} {size})"
        reason = f", {self.reason}" if self.reason else ""
        worst = f", worst {self.worst}" if self.worst is not None else ""
        return line + reason + worst


def parse_limits(texts: Iterable[str]) -> list[Limit]:
    """Limits from their expressions.

    Raises:
        BadLimitError: if one is not a comparison of a figure of the report with a value of its kind.
    """
    return [_parse(text) for text in texts]


def load_limits(path: Path) -> list[Limit]:
    """Limits from a TOML file, `limits = ["...", ...]`.

    Raises:
        BadLimitError: if the file cannot be read, holds something else or no limit, or one is bad.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BadLimitError(f"cannot read the limits {path}: {error.strerror}") from error
    except ValueError as error:  # of TOML or of UTF-8
        raise BadLimitError(f"{path} is not TOML: {error}") from error
    texts = content.pop("limits", None)
    if content or not isinstance(texts, list) or not all(isinstance(text, str) for text in texts):
        raise BadLimitError(f'{path} must hold `limits = ["...", ...]` and nothing else; {_EXAMPLE}')
    limits = parse_limits(texts)
    _require_some(limits, f"{path} holds")
    return limits


def judge(tracking: Tracking, limits: Sequence[Limit]) -> list[Verdict]:
    """Compare a flight with limits; one that cannot be tested fails.

    Raises:
        BadLimitError: if there is no limit: a check that tests nothing must not pass.
    """
    _require_some(limits, "there is")
    return [_judge(tracking, limit) for limit in limits]


def _require_some(limits: Sequence[Limit], where: str) -> None:
    if not limits:
        raise BadLimitError(f"{where} no limit, so nothing would be checked; {_EXAMPLE}")


def _judge(tracking: Tracking, limit: Limit) -> Verdict:
    value, bound, worst = _value(tracking, limit.name), limit.bound, tracking.worst.get(limit.name)
    if value is None or value != value:
        return Verdict(limit, False, value, reason="nothing could be measured")
    passed = bool(_OPERATORS[limit.comparison](value, bound))
    margin = None
    if isinstance(value, float) and isinstance(bound, float):
        margin = _margin(value, limit.comparison, bound)
    if limit.name.startswith("waypoint_time_error_s.") and tracking.waypoints_missed:
        reason = f"and {tracking.waypoints_missed} waypoints were never reached"
        return Verdict(limit, False, value, margin, worst, reason)
    return Verdict(limit, passed, value, margin, worst)


def _margin(value: float, comparison: str, bound: float) -> float | None:
    if comparison.startswith("<"):
        return bound - value
    if comparison.startswith(">"):
        return value - bound
    return -abs(value - bound) if comparison == "==" and value != bound else None


def _value(tracking: Tracking, name: str) -> Value | None:
    value: Any = tracking
    for part in name.split("."):
        value = getattr(value, part)
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _parse(text: str) -> Limit:
    found = _EXPRESSION.fullmatch(text)
    if found is None:
        raise BadLimitError(f"the limit {text!r} cannot be understood; {_EXAMPLE}")
    name, comparison, literal = found.groups()
    kinds = figure_kinds()
    if name not in kinds:
        raise BadLimitError(f"the limit {text!r} is on {name}, which no report has; {_nearest(name, kinds)}")
    try:
        bound: object = json.loads(literal, parse_int=float)
    except ValueError as error:
        raise BadLimitError(f"the limit {text!r} compares with {literal}, no value; {_EXAMPLE}") from error
    kind = kinds[name]
    if not isinstance(bound, kind) or (isinstance(bound, float) and not math.isfinite(bound)):
        raise BadLimitError(f"the limit {text!r} compares with {literal}, but {name} is {_KINDS[kind]}")
    if kind is not float and comparison not in ("==", "!="):
        raise BadLimitError(f"the limit {text!r} compares by {comparison}; {name} is {_KINDS[kind]}, use ==")
    if name == "outcome" and bound not in list(Outcome):
        near = _nearest(cast(str, bound), list(Outcome))
        raise BadLimitError(
            f"the limit {text!r} compares with {literal}, an outcome that no flight has; {near}"
        )
    return Limit(name, comparison, cast(Value, bound))


_KINDS: dict[type, str] = {bool: "true or false", str: 'a "text"', float: "a number"}


@cache
def figure_kinds() -> dict[str, type]:
    """Every name that a limit can be on, such as "cross_track_m.p95", and the type of its bound."""
    kinds: dict[str, type] = {}
    hints = get_type_hints(Tracking)
    for field in fields(Tracking):
        hint = hints[field.name]
        if field.name in NOT_REPORTED:
            continue
        if is_dataclass(hint):
            kinds |= {f"{field.name}.{part.name}": float for part in fields(hint)}
        else:
            kinds[field.name] = hint if hint in (bool, str) else float
    return kinds


def _nearest(name: str, kinds: Iterable[str]) -> str:
    """The names that come nearest; of a name whose figure is missing, the figures it has."""
    within = [known for known in kinds if known.startswith(f"{name}.")]
    near = within or difflib.get_close_matches(name, kinds, n=1, cutoff=0.0)
    return f"did you mean {' or '.join(near)}?"


def _text(value: Value | None) -> str:
    if value is None:
        return "none"
    return number(value) if isinstance(value, float) else json.dumps(value)
