"""A summary in some lines, for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from recordings.figures import number
from sim.campaign.progress import counted
from sim.campaign.summary import FIGURES, UNFLOWN_SHOWN, Group, LimitRate, Spread, Summary, WorstFlight

_WIDEST = 48


def summary_text(summary: Summary) -> str:
    """Outcomes, limits, distributions, and the worst flights."""
    lines = [_heading(summary)]
    for outcome, count in summary.outcomes.items():
        lines += _outcome(outcome, count, summary.reasons.get(outcome, {}))
    if summary.unjudged:
        lines += ["", _unjudged(summary)]
    if summary.limits:
        lines += ["", *_columns([("limit", "kept", ""), *map(_limit, summary.limits)])]
    groups = [summary.all, *summary.varied]
    names = [name for name in FIGURES if name in summary.all.figures]
    if names:
        lines += ["", "5th, 50th and 95th percentiles"]
        rows = [("flights", "arrived", "passed", *names)]
        rows += [_row(group, names) for group in groups]
        labels = ["", *map(_label, groups)]
        lines += _columns([(label, *row) for label, row in zip(labels, rows, strict=True)])
    lines += _worst(summary)
    return "\n".join(lines)


def _outcome(outcome: str, count: int, reasons: Mapping[str, int]) -> Iterator[str]:
    """With its reason, or with each of them and how often it was one."""
    line = f"  {count:6d}  {outcome}"
    if len(reasons) <= 1:
        yield ": ".join([line, *reasons])
        return
    yield line
    for reason, flights in reasons.items():
        yield f"  {flights:14d}  {reason}"
    if rest := count - sum(reasons.values()):
        yield f"  {rest:14d}  for other reasons"


def _unjudged(summary: Summary) -> str:
    if not summary.limits:
        return "the scenario sets no limits, so nothing is judged: passed are those that arrived"
    return f"{counted(summary.unjudged)} had no limits, so nothing is judged of them but whether they arrived"


def _heading(summary: Summary) -> str:
    done = summary.all
    some = done.flights != summary.planned
    flights = f"{done.flights} of {counted(summary.planned)}" if some else counted(done.flights)
    wall = summary.wall_time_s
    took = f", a flight took {number(wall.p50)} s" if wall else ""
    return f"{summary.scenario}: {flights}, {_share(done.passed, done.flights)} passed{took}"


def _share(part: int, whole: int) -> str:
    return f"{part} ({100.0 * part / whole:.1f} %)" if whole else "0"


def _limit(rate: LimitRate) -> tuple[str, ...]:
    return (rate.limit, _share(rate.passed, rate.flights), f"of {rate.flights}")


def _label(group: Group) -> str:
    label = "all" if group.key is None else f"{group.key}={group.value}"
    return label if len(label) <= _WIDEST else f"{label[: _WIDEST - 1]}…"  # a whole table, maybe


def _row(group: Group, names: Sequence[str]) -> tuple[str, ...]:
    counts = (str(group.flights), str(group.arrived), str(group.passed))
    return (*counts, *(_spread(group.figures.get(name)) for name in names))


def _spread(spread: Spread | None) -> str:
    return "" if spread is None else " ".join(map(number, (spread.p5, spread.p50, spread.p95)))


def _worst(summary: Summary) -> Iterator[str]:
    """Those that did not pass, and apart from them those that did."""
    failed = [flight for flight in summary.worst if not flight.passed]
    if failed:
        order = (
            f"up to {UNFLOWN_SHOWN} of each outcome without a recording, then those that did not arrive, then"
        )
        many = f"{len(failed)} of {counted(summary.all.flights - summary.all.passed)}"
        yield ""
        yield f"{many} that did not pass: {order} by limits broken and {summary.worst_by}"
        for flight in failed:
            yield from _flight(flight, summary.worst_by)
    passed = [flight for flight in summary.worst if flight.passed]
    if passed:
        yield ""
        many = f"{len(passed)} of {counted(summary.all.passed)}"
        yield f"{many} that passed, those with the largest {summary.worst_by}"
        for flight in passed:
            yield from _flight(flight, summary.worst_by)


def _flight(flight: WorstFlight, by: str) -> Iterator[str]:
    settings = " ".join((*flight.overrides, f"seed={flight.seed}"))
    figure = "" if flight.figure is None else f", {by} {number(flight.figure)}"
    broken = f", broke {'; '.join(flight.limits_broken)}" if flight.limits_broken else ""
    yield f"  {settings}: {flight.outcome} ({flight.reason}){figure}{broken}"
    yield f"    {flight.replay}"


def _columns(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
