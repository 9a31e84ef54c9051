"""Compares a flight with limits, one verdict each; a limit that nothing could test fails."""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, assert_never

import numpy as np

from recordings.errors import BadLimitError
from recordings.evidence import Evidence, Mask
from recordings.figures import Floats, Moment, Places, unit_of
from recordings.limit_kinds import Always, Compared, Limit, Never, Timely, Value, Within
from recordings.limit_names import statistic
from recordings.quantities import DURATIONS, QUANTITIES
from recordings.recorder import Outcome
from recordings.tracking import Tracking
from recordings.verdicts import Break, Verdict

_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_NOTHING = "nothing could be measured"


def judge(tracking: Tracking, limits: Sequence[Limit]) -> list[Verdict]:
    """Compare a flight with limits.

    Raises:
        BadLimitError: if there is no limit: a check that tests nothing must not pass.
    """
    if not limits:
        raise BadLimitError(
            "there is no limit, so nothing would be checked; such as `cross_track_m.p95 <= 2`"
        )
    evidence = Evidence(tracking)
    return [_judge(evidence, limit) for limit in limits]


def measured(tracking: Tracking, name: str) -> Value | None:
    """A figure or statistic that a limit can be on; None where there was nothing to measure."""
    return _compared(Evidence(tracking), Compared(name, "==", 0.0)).value


def _judge(evidence: Evidence, limit: Limit) -> Verdict:
    match limit:
        case Compared():
            return _compared(evidence, limit)
        case Within() | Always():
            return _at_every_moment(evidence, limit)
        case Never():
            return _never(evidence, limit)
        case Timely():
            return _timely(evidence, limit)
    assert_never(limit)


class _Part(NamedTuple):
    """What was measured of a limit's quantity in the limit's part of the flight.

    `values`: all that was measured, and `inside` which of them count; NaN where there was nothing to measure.
    """

    values: Floats
    places: Places
    inside: Mask
    at_waypoints: bool

    @property
    def missed(self) -> int:
        """Waypoints that count and were never reached."""
        return int(np.isnan(self.values[self.inside]).sum()) if self.at_waypoints else 0

    def broken(self, bad: Mask) -> dict[str, Any]:
        """For how long; of waypoints, at how many."""
        bad = bad & self.inside
        if self.at_waypoints:
            return {"reason": f"at {bad.sum()} of {self.inside.sum()} waypoints"} if bad.any() else {}
        lasting_s = self.places.lasting_s()
        return {"broken_s": float(lasting_s[bad].sum()), "longest": _longest(bad, self.places, lasting_s)}


def _longest(bad: Mask, places: Places, lasting_s: Floats) -> Break | None:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], bad, [False]]).astype(np.int8)))
    if not len(edges):
        return None
    first, last = edges[::2], edges[1::2] - 1
    ends_s = places.time_s[last] + lasting_s[last]
    longest = int(np.argmax(ends_s - places.time_s[first]))
    return Break(float(places.time_s[first[longest]]), float(ends_s[longest]))


def _part(evidence: Evidence, name: str, limit: Compared | Within | Always) -> _Part:
    values, places = evidence.quantity(name)
    at_waypoints = QUANTITIES[name].at_waypoints
    when = evidence.tracking.series.planned if at_waypoints else places  # of waypoints, also the missed ones
    known = np.ones(len(values), np.bool_) if at_waypoints else np.isfinite(values) | np.isposinf(values)
    return _Part(values, places, evidence.within(limit.window, when) & known, at_waypoints)


def _untested(limit: Compared | Within | Always | Never) -> str:
    """Why a limit fails of which nothing was measured."""
    part = " ".join(map(str, limit.window))
    return f"no moment of the flight is {part}" if part else _NOTHING


def _compared(evidence: Evidence, limit: Compared) -> Verdict:
    of = statistic(limit.name)
    if of is not None:
        return _of_statistic(evidence, limit, of.quantity, of.of)
    if limit.name in DURATIONS:
        return _of_duration(evidence, limit)
    value: Any = getattr(evidence.tracking, limit.name)
    worst = evidence.tracking.worst.get(limit.name)
    if value is None or value != value:
        return Verdict(limit, False, value, reason=_NOTHING)
    return _verdict(limit, float(value) if type(value) is int else value, worst)


def _verdict(limit: Compared, value: Value, worst: Moment | None) -> Verdict:
    passed = bool(_OPERATORS[limit.comparison](value, limit.bound))
    margin = None
    if isinstance(value, float) and isinstance(limit.bound, float):
        margin = _margin(value, limit.comparison, limit.bound)
    return Verdict(limit, passed, value, margin, worst)


def _margin(value: float, comparison: str, bound: float) -> float | None:
    if comparison.startswith("<"):
        return bound - value
    if comparison.startswith(">"):
        return value - bound
    return -abs(value - bound) if comparison == "==" and value != bound else None


def _of_statistic(evidence: Evidence, limit: Compared, name: str, of: Callable[[Floats], float]) -> Verdict:
    part = _part(evidence, name, limit)
    sizes = np.abs(part.values) if QUANTITIES[name].is_error else part.values
    counted = np.flatnonzero(part.inside & ~np.isnan(sizes))
    value = of(sizes[counted]) if len(counted) else np.nan
    if not np.isfinite(value):
        missed = f", {part.missed} waypoints were never reached" if part.missed else ""
        return Verdict(limit, False, None, reason=_untested(limit) + missed)
    at = int(counted[_worst(limit, sizes[counted])])
    worst = part.places.moment(at, float(sizes[at]), unit_of(name))
    verdict = _verdict(limit, value, worst)
    if part.missed:
        return replace(verdict, passed=False, reason=f"and {part.missed} waypoints were never reached")
    if limit.comparison in ("==", "!="):
        return verdict
    bad = ~_OPERATORS[limit.comparison](sizes, limit.bound)
    return replace(verdict, **part.broken(bad & (not verdict.passed)))


def _worst(limit: Compared, sizes: Floats) -> int:
    """Which of them: what lies farthest over an upper bound or under a lower one."""
    least = limit.name.endswith(".min") or (
        limit.comparison in (">", ">=") and not limit.name.endswith(".max")
    )
    return int(sizes.argmin() if least else sizes.argmax())


def _of_duration(evidence: Evidence, limit: Compared) -> Verdict:
    (beyond, places), (shown, _) = evidence.duration(limit.name)
    part = _Part(beyond, places, evidence.within(limit.window, places), at_waypoints=False)
    counted = np.flatnonzero(part.inside)
    if not len(counted):
        return Verdict(limit, False, None, reason=_untested(limit))
    at = int(counted[beyond[counted].argmax()])
    worst = places.moment(at, float(shown[at]), DURATIONS[limit.name].unit)
    bad = part.inside & (beyond > 0.0)
    verdict = _verdict(limit, float(places.lasting_s()[bad].sum()), worst)
    return replace(verdict, **part.broken(bad & (not verdict.passed)))


def _at_every_moment(evidence: Evidence, limit: Within | Always) -> Verdict:
    part = _part(evidence, limit.name, limit)
    counted = np.flatnonzero(part.inside & ~np.isnan(part.values))
    if not len(counted) or np.isinf(part.values[counted]).all():
        missed = f", {part.missed} waypoints were never reached" if part.missed else ""
        return Verdict(limit, False, None, reason=_untested(limit) + missed)
    shown, over, bad = _beyond(limit, part.values)
    at = int(counted[over[counted].argmax()])
    passed = not bad[counted].any()
    worst = part.places.moment(at, float(shown[at]), unit_of(limit.name))
    verdict = Verdict(limit, passed, worst.value, -float(over[at]), worst)
    if part.missed:
        return replace(verdict, passed=False, reason=f"and {part.missed} waypoints were never reached")
    return replace(verdict, **part.broken(bad))


def _beyond(limit: Within | Always, values: Floats) -> tuple[Floats, Floats, Mask]:
    """What is shown of each moment, how far it lies beyond its bound, and whether that breaks the limit."""
    if isinstance(limit, Always):
        over = values - limit.bound if limit.comparison.startswith("<") else limit.bound - values
        return values, over, ~_OPERATORS[limit.comparison](values, limit.bound)
    if limit.low is None:
        sizes = np.abs(values)
        return sizes, sizes - limit.high, sizes > limit.high
    over = np.maximum(values - limit.high, limit.low - values)
    return values, over, over > 0.0


def _never(evidence: Evidence, limit: Never) -> Verdict:
    happening, series = limit.happening, evidence.tracking.series
    happened = evidence.happened(happening)
    happened = happened.chosen(evidence.within(limit.window, happened))
    if len(happened.time_s):
        worst = happened.moment(0, float(len(happened.time_s)), "×, first")
        return Verdict(limit, False, float(len(happened.time_s)), None, worst)
    if not evidence.within(limit.window, series.samples).any():
        return Verdict(limit, False, None, reason=_untested(limit))
    if not evidence.recording.complete:
        return Verdict(limit, False, 0.0, reason="but the recording is incomplete, so it may have happened")
    worst_of_all = evidence.lowest() if happening.words == Outcome.CRASHED and not limit.window else None
    return Verdict(limit, True, 0.0, None, worst_of_all)


def _timely(evidence: Evidence, limit: Timely) -> Verdict:
    happened = evidence.happened(limit.happening)
    if not len(happened.time_s):
        return Verdict(limit, False, None, reason="it never happened")
    bound_s = limit.time.since(evidence.recording.header.plan.departure_s)
    time_s = float(happened.time_s[0])
    margin_s = bound_s - time_s if limit.before else time_s - bound_s
    return Verdict(limit, margin_s >= 0.0, time_s, margin_s, happened.moment(0, time_s, "s"))
