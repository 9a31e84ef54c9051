"""Figure 3: what each policy comes to, over days, against the paper's score and the oracle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.reproduce.bootstrap import Interval, mean_interval, ratio_interval
from sim.reproduce.judging import Fate

Rows = dict[str, list[dict[str, Any]]]
"""Of one day: policy to rows, a goal each."""

REFERENCE, BEST = "score", "oracle"


@dataclass(frozen=True, slots=True)
class PolicyFigures:
    """Of one policy at one level of error; shares are of all goals of a day.

    `closed`: share of the gap between the paper's score and the oracle. `longer`, `farther`: by how much
    its flights take longer, and have more moves, than the paper's score's to goals that both reach.
    """

    safe: Interval
    lost: Interval
    not_flown: Interval
    more_than_score: Interval
    closed: Interval | None
    longer: Interval | None
    farther: Interval | None


def figures_of(days: Sequence[Rows], policy: str) -> PolicyFigures:
    """A policy's figures over days."""
    safe, lost = shares(days, policy, Fate.SAFE), shares(days, policy, Fate.LOST)
    reference, best = shares(days, REFERENCE, Fate.SAFE), shares(days, BEST, Fate.SAFE)
    gap = best - reference
    return PolicyFigures(
        mean_interval(safe),
        mean_interval(lost),
        mean_interval(1.0 - safe - lost),
        mean_interval(safe - reference),
        ratio_interval(safe - reference, gap) if gap.sum() > 0.0 else None,
        _excess(days, policy, "steps"),
        _excess(days, policy, "moves"),
    )


def shares(days: Sequence[Rows], policy: str, fate: Fate) -> NDArray[np.float64]:
    """The share of a day's goals with a fate, shape (days,)."""
    return np.array([np.mean([row["fate"] == fate for row in rows[policy]]) for rows in days])


def _excess(days: Sequence[Rows], policy: str, what: str) -> Interval | None:
    sums = np.zeros((len(days), 2))
    for day, rows in zip(sums, days, strict=True):
        for mine, other in zip(rows[policy], rows[REFERENCE], strict=True):
            if mine["fate"] == Fate.SAFE == other["fate"]:
                day += mine[what], other[what]
    ratio = ratio_interval(sums[:, 0], sums[:, 1])
    return None if ratio is None else Interval(*(part - 1.0 for part in ratio))
