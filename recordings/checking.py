"""A recording checked: read, measured, judged, and compared with another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import recordings
from recordings.comparison import Tolerance, compare, differences
from recordings.errors import RecordingError
from recordings.limit_kinds import Limit
from recordings.limits import judge, parse_limits
from recordings.tracking import Tracking, track
from recordings.tracking_report import plain_report
from recordings.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class Baseline:
    """The flight to be no worse than, with tolerances by figure."""

    tracking: Tracking
    tolerances: Mapping[str, Tolerance]


@dataclass(frozen=True, slots=True, eq=False)
class Checked:
    """What came of one recording.

    `tracking`: None if it cannot be measured. `missing`: what it lacks; empty if it is complete.
    `notes`: what else is to be known. `error`: why it could not be judged; empty if it was.
    """

    path: Path
    tracking: Tracking | None
    verdicts: tuple[Verdict, ...]
    missing: str = ""
    notes: tuple[str, ...] = ()
    error: str = ""

    @property
    def passed(self) -> bool:
        """Whether it is complete and every verdict good."""
        return not self.error and not self.missing and all(verdict.passed for verdict in self.verdicts)

    def to_dict(self) -> dict[str, Any]:
        """The report, and behind its figures what came of the check, for JSON."""
        return (plain_report(self.tracking) if self.tracking is not None else {}) | {
            "recording": str(self.path),
            "complete": not self.missing and self.tracking is not None,
            "missing": self.missing,
            "passed": self.passed,
            "verdicts": [verdict.to_dict() for verdict in self.verdicts],
            "notes": list(self.notes),
            "error": self.error,
        }


def check(path: Path, limits: Sequence[Limit] | None = None, baseline: Baseline | None = None) -> Checked:
    """Read, measure and judge a recording; what is wrong with it stands in the answer.

    Args:
        path: of the recording.
        limits: None for those that its own scenario set.
        baseline: of a flight to compare with; then it is no error to have no limits.
    """
    tracking: Tracking | None = None
    notes: tuple[str, ...] = ()
    missing = ""
    try:
        recording = recordings.open(path)
        missing = recording.missing
        tracking = track(recording)
        verdicts: list[Verdict] = []
        own = parse_limits(recording.limits) if limits is None else limits
        if own or baseline is None:
            verdicts += judge(tracking, own)
        if baseline is not None:
            verdicts += compare(tracking, baseline.tracking, baseline.tolerances)
            notes = tuple(differences(tracking, baseline.tracking))
    except RecordingError as error:
        return Checked(path, tracking, (), missing, error=str(error))
    return Checked(path, tracking, tuple(verdicts), missing, notes)
