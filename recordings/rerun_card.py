"""The run card and the verdicts: what was flown and what came of its limits, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

from recordings.limits import Verdict
from recordings.overlay import Overlaid
from recordings.recorder import FlightHeader
from recordings.tracking import track

_WIDTH = 40  # letters of a limit


def run_card(header: FlightHeader, ended: str) -> str:
    """The card of a flight.

    Args:
        header: what is known before take-off.
        ended: how the flight ended, or that it has not.
    """
    plan = header.plan
    departure = datetime.fromtimestamp(plan.departure_s, UTC)
    levels = ", ".join(f"{altitude_m:g}" for altitude_m, _ in plan.level_flight)
    rows = (
        ("scenario", f"**{header.scenario}**, seed {header.seed}"),
        ("planned", _planned(header)),
        *((("levels", f"{levels} m"),) if len(plan.level_flight) > 1 else ()),
        ("departure", f"{departure:%Y-%m-%d %H:%M} UTC"),
        ("planner", f"{plan.planner}, by {plan.objective}"),
        ("galeway", f"{header.versions.get('galeway', '')} {header.versions.get('git', '')}".strip()),
    )
    outcome, _, detail = ended.partition(": ")
    told = f"**{outcome}**{detail and f': {detail}'}\n\n{_table(rows)}"  # a line is wrapped, a cell is not
    return f"{told}\n{_hazard(header)}\n" if header.also else told


def _hazard(header: FlightHeader) -> str:
    """All that is hazardous; the legend has the wind, which most flights have alone."""
    return f"**hazard**: {'; '.join((f'wind over {header.threshold_mps:.4g} m/s', *header.also))}"


def limits_card(limits: Sequence[str]) -> str:
    """The limits of a flight that is not judged yet."""
    if not limits:
        return "The scenario sets no limits, so nothing is judged.\n"
    rows = [(f"**{len(limits)} limits**", "judged after the flight")]
    return _table([*rows, *((_short(limit), "") for limit in limits)])


def verdicts_card(verdicts: Sequence[Verdict]) -> str:
    """What came of the limits of a flight, the broken ones first."""
    if not verdicts:
        return limits_card(())
    passed = sum(verdict.passed for verdict in verdicts)
    head = (f"**{passed} of {len(verdicts)} limits hold**", "measured", "")
    rows = (
        (_short(str(verdict.limit)), verdict.value_text, "PASS" if verdict.passed else "**FAIL**")
        for verdict in sorted(verdicts, key=lambda verdict: verdict.passed)
    )
    return _table([head, *rows])


def _table(rows: Sequence[tuple[str, ...]]) -> str:
    """The first row is the head."""
    first, *others = [f"| {' | '.join(cell.replace('|', '/') for cell in row)} |" for row in rows]
    return "\n".join([first, "|---" * len(rows[0]) + "|", *others, ""])


def _short(limit: str) -> str:
    """A limit in the width of the view; the events have it whole."""
    return limit if len(limit) <= _WIDTH else f"{limit[: _WIDTH - 3]}..."


def flights_card(flights: Sequence[Overlaid]) -> str:
    """The card of several flights, a row each."""
    rows = [("flight", "outcome", "time", "across p95", "above p95", "hazard")]
    for flight in flights:
        tracking = track(flight.recording)
        rows.append(
            (
                f"**{flight.label}**",
                tracking.outcome.replace("_", " "),
                clock(tracking.flight_time_s),
                _figure(tracking.cross_track_m.p95, "m"),
                _figure(tracking.altitude_error_m.p95, "m"),
                _figure(tracking.hazard_exposure_s, "s"),
            )
        )
    return _table(rows)


def _figure(value: float | None, unit: str) -> str:
    return "none" if value is None else f"{value:.1f} {unit}"


def clock(time_s: float) -> str:
    """Hours and minutes; seconds too below an hour."""
    seconds = round(time_s)
    if abs(seconds) < 3600:
        return f"{seconds // 60} min {seconds % 60:02d} s"
    return f"{seconds // 3600}:{seconds // 60 % 60:02d} h"


def _planned(header: FlightHeader) -> str:
    plan = header.plan
    length_m = plan.outcome.length_m
    length = "" if length_m is None else f", {length_m / 1000.0:.0f} km"
    return f"{clock(plan.duration_s)}{length} to {plan.goal}"
