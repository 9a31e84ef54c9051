"""Which flights' recordings stay."""

from __future__ import annotations

import heapq
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from recordings.limits import figure_kinds
from sim.campaign.row import Row
from sim.errors import CampaignError

BY_DEFAULT = "cross_track_m.p95"

_WORST = re.compile(r"worst:([1-9]\d{0,5})(?::(.+))?")


@dataclass(frozen=True, slots=True)
class Keep:
    """What is kept: all, those that failed, none, or the `count` worst.

    A flight is worse than another if it broke more (it did not arrive, then the number of broken limits),
    then if it is greater in the figure `by`. Flights without a recording keep none.
    """

    kind: Literal["all", "failed", "worst", "none"]
    count: int = 0
    by: str = BY_DEFAULT

    @classmethod
    def parse(cls, text: str) -> Keep:
        """From "all", "failed", "none", "worst:10", or "worst:10:altitude_error_m.p95".

        Raises:
            CampaignError: if it is none of these.
        """
        if text in ("all", "failed", "none"):
            return cls(text)  # type: ignore[arg-type]
        found = _WORST.fullmatch(text)
        if not found:
            raise CampaignError(f"--keep {text!r} is none of all, failed, none and worst:N, such as worst:10")
        by = found[2] or BY_DEFAULT
        numbers = [name for name, kind in figure_kinds().items() if kind is float]
        if by not in numbers:
            raise CampaignError(
                f"--keep {text!r} is by {by}, which is no figure of the report; "
                f"there are {', '.join(numbers)}"
            )
        return cls("worst", int(found[1]), by)

    def __str__(self) -> str:
        if self.kind != "worst":
            return self.kind
        return f"worst:{self.count}" + ("" if self.by == BY_DEFAULT else f":{self.by}")

    def may_keep(self, row: Row) -> bool:
        """Whether a recording is left in its place when the flight has ended."""
        return self.kind in ("all", "worst") or (self.kind == "failed" and not row["passed"])

    @staticmethod
    def path(folder: Path, run: int) -> Path:
        """Where a flight's recording stays."""
        return folder / f"run_{run:06d}.mcap"

    def badness(self, row: Row) -> tuple[float, ...]:
        """Sorts flights: the greater the worse."""
        broken = sum(not limit["passed"] for limit in row.get("limits") or ())
        figure = row.get(self.by)
        return (not row.get("arrived"), broken, math.inf if figure is None else float(figure), -row["run"])


class WorstKept:
    """Takes away the recordings of flights that are no longer among the worst."""

    def __init__(self, keep: Keep, folder: Path) -> None:
        self._keep, self._folder = keep, folder
        self._worst: list[tuple[tuple[float, ...], int]] = []

    def add(self, row: Row) -> None:
        """Take note of a flight that has landed."""
        if self._keep.kind != "worst" or row.get("recording_bytes") is None:
            return
        heapq.heappush(self._worst, (self._keep.badness(row), row["run"]))
        if len(self._worst) > self._keep.count:
            _, run = heapq.heappop(self._worst)
            self._keep.path(self._folder, run).unlink(missing_ok=True)
