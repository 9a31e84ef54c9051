"""The run card: what was flown, in a few lines of Markdown."""

from __future__ import annotations

from datetime import UTC, datetime

from recordings.recorder import FlightHeader


def run_card(header: FlightHeader, ended: str) -> str:
    """The card of a flight.

    Args:
        header: what is known before take-off.
        ended: how the flight ended, or that it has not.
    """
    plan = header.plan
    departure = datetime.fromtimestamp(plan.departure_s, UTC)
    rows = [
        (f"**{header.scenario}**, seed {header.seed}", ended, "planned", _planned(header)),
        ("departure", f"{departure:%Y-%m-%d %H:%M} UTC", "planner", f"{plan.planner}, by {plan.objective}"),
        (
            "airspeed",
            f"{header.airspeed_min_mps:g} to {header.airspeed_max_mps:g} m/s",
            "hazard",
            f"wind over {header.threshold_mps:g} m/s",
        ),
        ("galeway", header.versions.get("galeway", ""), "git", header.versions.get("git", "")),
    ]
    first, *others = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([first, "|---|---|---|---|", *others, ""])


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
