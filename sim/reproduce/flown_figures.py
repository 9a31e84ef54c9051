"""The flown part in figures: planned-safe and flown-safe, why flights were lost, tracking by wind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.reproduce.bootstrap import Interval, mean_interval
from sim.reproduce.flights import CROSS_EDGES_M, WIND_EDGES_MPS, Row

LATE_S = 30.0
"""From which on a flight that meets hazard counts as late there."""


@dataclass(frozen=True, slots=True)
class FlownFigures:
    """Of one policy at one level of error; shares are of all goals, by days.

    `counts`: (planned, flown) to flights, each "safe" or "lost"; `unflown`: goals without a plan to fly.
    """

    goals: int
    planned: Interval
    flown: Interval
    lost: Interval
    counts: Counter[tuple[str, str]]
    unflown: int


def flown_figures(rows: Sequence[Row]) -> FlownFigures:
    """The figures of one policy's flights at one level; `rows` are those of its goals on all days."""
    days = sorted({row["seed"] for row in rows})
    counts = Counter((row["planned"], row["flown"]) for row in rows if "flown" in row)

    def by_day(key: str, value: str) -> Interval:
        return mean_interval(
            [np.mean([_is(row, key, value) for row in rows if row["seed"] == day]) for day in days]
        )

    return FlownFigures(
        len(rows),
        by_day("planned", "safe"),
        by_day("flown", "safe"),
        by_day("flown", "lost"),
        counts,
        sum("flown" not in row for row in rows),
    )


def _is(row: Row, key: str, value: str) -> bool:
    """Whether a goal's plan, or its flight, came out so; what is not flown did not."""
    return "flown" in row and bool(row[key] == value)


def with_abstention(rows: Sequence[Row]) -> list[Row]:
    """The rows of survival as those of survival or abstain: the same plans, some of them not flown."""
    return [
        {
            "seed": row["seed"],
            "scale": row["scale"],
            "policy": "abstain",
            "goal": row["goal"],
            "planned": "abstained",
        }
        if row.get("abstained")
        else {**row, "policy": "abstain"}
        for row in rows
        if row["policy"] == "survival"
    ]


def why_lost(row: Row) -> str:
    """Why a flight that was flown was lost, in words."""
    if row["outcome"] == "refused":
        return "no flyable curve through the plan"
    if not row["arrived"]:
        return f"ended before its goal: {row['outcome'].replace('_', ' ')}"
    if row["planned"] == "lost":
        return "led through true hazard by its plan"
    late_s = row["late_at_hazard_s"]
    if late_s is not None and abs(late_s) > LATE_S:
        return "plan safe, but late" if late_s > 0.0 else "plan safe, but early"
    return "plan safe, on time, and hazard beside its cells"


class InWind(NamedTuple):
    """Tracking at one range of wind speeds: samples of all flights, percentiles of cross-track error."""

    low_mps: float
    high_mps: float
    samples: int
    median_m: float
    p95_m: float
    p99_m: float


def tracking_by_wind(rows: Sequence[Row]) -> list[InWind]:
    """Cross-track error by wind speed, where there is any of it."""
    flown = [row["cross_track_by_wind"] for row in rows if "cross_track_by_wind" in row]
    total = np.array(flown, dtype=np.int64).sum(axis=0) if flown else np.zeros((0, 1), dtype=np.int64)
    return [
        InWind(low, high, int(counts.sum()), *(_percentile(counts, share) for share in (0.5, 0.95, 0.99)))
        for (low, high), counts in zip(pairwise(WIND_EDGES_MPS), list(total), strict=False)
        if counts.sum()
    ]


def _percentile(counts: NDArray[np.int64], share: float) -> float:
    """Of a histogram, linear within its bins."""
    below = np.concatenate([[0], counts.cumsum()]) / counts.sum()
    return float(np.interp(share, below, CROSS_EDGES_M))
