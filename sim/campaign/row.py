"""The row of one flight: what it was, what came of it, and what made it."""

from __future__ import annotations

import hashlib
import time
from enum import StrEnum
from pathlib import Path
from typing import Any

from recordings.recorder import Outcome
from recordings.tracking import Tracking
from recordings.tracking_report import plain_report
from recordings.verdicts import Verdict
from sim.campaign.executor import Lost
from sim.campaign.flight import Flight
from sim.provenance import source_sha256, versions

Row = dict[str, Any]
"""Column to value, as JSON knows them; `columns.py` says which there are."""

MADE_BY = ("galeway", "git", "source_sha256", "jsbsim", "numpy", "scipy", "python")
"""What a row names of what made it: versions, all of which the recording has, and galeway's own source."""


def made_by() -> dict[str, str]:
    """Of this process, by the names in `MADE_BY`."""
    found = versions() | {"source_sha256": source_sha256()}
    return {name: found[name] for name in MADE_BY}


class Unflown(StrEnum):
    """Outcomes of flights that did not come to an end of their own; those that did have a recorded one."""

    NO_ROUTE = "no_route"
    ABSTAINED = "abstained"
    REFUSED = "refused"
    FAULT = "fault"
    PROCESS_CRASHED = "process_crashed"
    TIMED_OUT = "timed_out"


OUTCOMES = tuple(dict.fromkeys([*map(str, Outcome), *map(str, Unflown)]))


class RowMaker:
    """Makes the row of a flight, and takes the time from now on."""

    def __init__(self, flight: Flight) -> None:
        self._flight, self._begin_s = flight, time.perf_counter()

    def flown(self, tracking: Tracking, verdicts: list[Verdict], recording: Path) -> Row:
        """Of a flight that has a recording."""
        passed = tracking.arrived and all(verdict.passed for verdict in verdicts)
        limits = [
            {
                "limit": str(verdict.limit),
                "passed": verdict.passed,
                "value": verdict.value_text,
                "margin": verdict.to_dict()["margin"],
            }
            for verdict in verdicts
        ]
        row = self._row(tracking.outcome, tracking.outcome_detail, passed=passed)
        return row | flat(plain_report(tracking)) | {"limits": limits} | _content(recording)

    def unflown(self, why: Unflown, reason: str) -> Row:
        """Of a flight that has none."""
        return self._row(why.value, reason, passed=False)

    def lost(self, lost: Lost) -> Row:
        """Of a flight that was lost with its process."""
        row = self._row(Unflown(lost.loss.value).value, lost.reason, passed=False)
        return row | {"wall_time_s": lost.wall_time_s}

    def _row(self, outcome: str, reason: str, *, passed: bool) -> Row:
        flight = self._flight
        return {
            "run": flight.run,
            "seed": flight.seed,
            "overrides": list(flight.overrides),
            "outcome": outcome,
            "reason": reason,
            "passed": passed,
            "scenario_sha256": flight.origin.sha256,
            "wall_time_s": round(time.perf_counter() - self._begin_s, 3),
        } | made_by()


def _content(recording: Path) -> Row:
    """Its length, and what tells whether another has the same bytes."""
    with recording.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    return {"recording_bytes": recording.stat().st_size, "recording_sha256": sha256}


def flat(report: dict[str, Any]) -> Row:
    """Figures by the names that limits give them, such as "cross_track_m.p95"."""
    row: Row = {}
    for name, value in report.items():
        row |= (
            {f"{name}.{part}": inner for part, inner in value.items()}
            if isinstance(value, dict)
            else {name: value}
        )
    return row
