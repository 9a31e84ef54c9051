"""Two recordings of one mission: whether the later one got worse than the earlier, and by how much."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from recordings.errors import BadComparisonError, BadLimitError
from recordings.figures import number, unit_of
from recordings.judging import judge, measured
from recordings.limit_kinds import Against, Compared, Value
from recordings.limit_names import UnknownNameError, compared_kind
from recordings.recorder import Outcome
from recordings.tracking import Tracking
from recordings.verdicts import Verdict

_GIVEN = re.compile(r"\s*([\w.]+)\s*=\s*(\d+\.?\d*|\.\d+)\s*(\S*)\s*")
_SPELT = {"m/s": "mps", "°": "deg"}
_EXAMPLE = "write it like cross_track_m.p95=10% or cross_track_m.p95=0.2m"


@dataclass(frozen=True, slots=True)
class Tolerance:
    """By how much a figure may get worse: a share of what it was, or an amount, whichever is more."""

    share: float = 0.0
    amount: float = 0.0

    def allows(self, before: float) -> float:
        """The amount that it allows to one that was `before`."""
        return max(self.share * abs(before), self.amount)

    def text(self, name: str) -> str:
        """For people, with the unit of a figure."""
        parts = [f"{100.0 * self.share:g} %"] if self.share else []
        if self.amount or not parts:
            parts.append(f"{number(self.amount)} {unit_of(name.partition('.')[0])}".rstrip())
        return " or ".join(parts)


class _Rule(NamedTuple):
    """Which comparisons with what it was a figure has to pass, and its tolerance."""

    comparisons: tuple[str, ...]
    tolerance: Tolerance


def _no_more(share: float = 0.0, amount: float = 0.0) -> _Rule:
    return _Rule(("<=",), Tolerance(share, amount))


def _no_less(share: float = 0.0, amount: float = 0.0) -> _Rule:
    return _Rule((">=",), Tolerance(share, amount))


RULES: Mapping[str, _Rule] = {
    "outcome": _Rule(("==",), Tolerance()),
    "arrived": _Rule(("==",), Tolerance()),
    "waypoints_missed": _no_more(),
    "holds": _no_more(),
    "flight_time_s": _no_more(0.01, 5.0),
    "flown_length_m": _no_more(0.01, 100.0),
    "cross_track_m.mean": _no_more(0.1, 0.1),
    "cross_track_m.p95": _no_more(0.1, 0.2),
    "cross_track_m.max": _no_more(0.25, 1.0),
    "altitude_error_m.mean": _no_more(0.1, 0.1),
    "altitude_error_m.p95": _no_more(0.1, 0.2),
    "altitude_error_m.max": _no_more(0.25, 1.0),
    "waypoint_time_error_s.mean": _no_more(0.1, 0.2),
    "waypoint_time_error_s.p95": _no_more(0.1, 0.5),
    "waypoint_time_error_s.max": _no_more(0.25, 1.0),
    "hazard_exposure_s": _no_more(),
    "min_clearance_m": _no_less(0.05, 100.0),
    "outside_airspeeds_s": _no_more(0.1, 5.0),
    "fuel_kg.min": _no_less(0.01, 0.01),
    "position_estimate_error_m.p95": _no_more(0.1, 0.1),
    "wind_estimate_error_mps.p95": _no_more(0.1, 0.1),
}
"""What is compared unless told otherwise. Seeds differ by less than this; what a bug does is usually more."""


def parse_tolerances(texts: Iterable[str]) -> dict[str, Tolerance]:
    """Tolerances by figure, from texts such as "cross_track_m.p95=10%" or "flight_time_s=30s".

    Raises:
        BadLimitError: if one cannot be understood, or is of something that is no number.
    """
    return dict(map(_tolerance, texts))


def _tolerance(text: str) -> tuple[str, Tolerance]:
    found = _GIVEN.fullmatch(text)
    if found is None:
        raise BadLimitError(f"the tolerance {text!r} cannot be understood; {_EXAMPLE}")
    name, size, unit = found.groups()
    try:
        kind = compared_kind(name)
    except UnknownNameError as error:
        raise BadLimitError(f"the tolerance {text!r} {error}") from None
    if kind is not float:
        raise BadLimitError(f"the tolerance {text!r} is on {name}, which is no number; {_EXAMPLE}")
    if unit == "%":
        return name, Tolerance(share=float(size) / 100.0)
    own = unit_of(name.partition(".")[0])
    if unit and unit != own and unit != _SPELT.get(own):
        raise BadLimitError(
            f"the tolerance {text!r} is in {unit}, but {name} is in {own or 'no unit'}; {_EXAMPLE}"
        )
    return name, Tolerance(amount=float(size))


def compare(
    tracking: Tracking, before: Tracking, tolerances: Mapping[str, Tolerance] | None = None
) -> list[Verdict]:
    """Whether a flight got worse than one before it, a verdict a figure.

    Figures that neither flight has are left out, such as errors of perfect sensors, and so are arrival and
    outcome where the earlier one did not arrive itself. One with a tolerance that is not among `RULES` may
    change by no more than that, either way.

    Args:
        tracking: the later flight.
        before: the earlier one, to be no worse than.
        tolerances: by figure, instead of those of `RULES`.

    Raises:
        BadComparisonError: if they flew different scenarios or to different goals, or the earlier recording
            is incomplete.
    """
    _require_comparable(tracking, before)
    given = tolerances or {}
    rules = dict(RULES)
    for name, tolerance in given.items():
        rules[name] = _Rule(rules[name].comparisons if name in rules else ("<=", ">="), tolerance)
    return [
        verdict
        for name, rule in rules.items()
        for verdict in _compare(tracking, before, name, rule, name in given)
    ]


def differences(tracking: Tracking, before: Tracking) -> list[str]:
    """What else is different about two flights, for people."""
    now, then = tracking.recording.header, before.recording.header
    told = []
    if now.plan.waypoints != then.plan.waypoints or now.plan.departure_s != then.plan.departure_s:
        told.append("the plans differ, so that figures change with the route, too")
    if now.seed != then.seed:
        told.append(f"the seeds differ: {now.seed}, before {then.seed}")
    for name in sorted({*now.versions, *then.versions} - {"git"}):
        here, there = now.versions.get(name, "none"), then.versions.get(name, "none")
        if here != there:
            told.append(f"{name} is {here}, before {there}")
    return told


def _require_comparable(tracking: Tracking, before: Tracking) -> None:
    for what in ("scenario", "goal"):
        now, then = getattr(tracking, what), getattr(before, what)
        if now != then:
            raise BadComparisonError(
                f"the {what} is {now}, and was {then} in the recording to compare with; "
                "compare flights of one"
            )
    if not before.recording.complete:
        raise BadComparisonError(
            f"the recording to compare with is incomplete: {before.recording.missing}; take a whole one"
        )


def _compare(tracking: Tracking, before: Tracking, name: str, rule: _Rule, asked: bool) -> list[Verdict]:
    was, tolerance = measured(before, name), rule.tolerance.text(name)
    if was is None:
        value = measured(tracking, name)
        against = Against(Compared(name, rule.comparisons[0], 0.0), None, tolerance)
        untold = value is None and not asked
        return [] if untold else [Verdict(against, False, value, reason="nothing was measured before")]
    return [
        replace(verdict, limit=Against(limit, was, tolerance))
        for limit in _limits(name, rule, before, was)
        for verdict in judge(tracking, [limit])
    ]


def _limits(name: str, rule: _Rule, before: Tracking, was: Value) -> list[Compared]:
    """What a figure has to be now."""
    if isinstance(was, float):
        allowed = {"<=": rule.tolerance.allows(was), ">=": -rule.tolerance.allows(was)}
        return [Compared(name, comparison, was + allowed[comparison]) for comparison in rule.comparisons]
    good = before.arrived and before.outcome == Outcome.ARRIVED
    return [Compared(name, comparison, was) for comparison in rule.comparisons if good]
