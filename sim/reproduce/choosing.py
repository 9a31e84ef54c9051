"""The choice among values of the dials that were tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.reproduce.bootstrap import Interval, mean_interval
from sim.reproduce.judging import Fate
from sim.reproduce.tuning import Tuning

MOST_LONGER = 0.05
ABSTAIN_BELOW = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)

Worth = Mapping[Fate, int]
ARRIVALS: Worth = {Fate.SAFE: 1}
LESS_LOST: Worth = {Fate.SAFE: 1, Fate.LOST: -1}

Rows = list[dict[str, Any]]
"""Of one level of error: one for each goal of all days, in the same order whatever planned."""


@dataclass(frozen=True, slots=True)
class Tried:
    """A policy at some value of its dials."""

    dials: Tuning
    levels: Sequence[Rows]

    def count(self, fate: Fate) -> int:
        """Of the goals at all levels."""
        return sum(count(rows, fate) for rows in self.levels)

    def worth(self, worth: Worth) -> NDArray[np.int64]:
        """Of each goal, shape (level, goals of all days)."""
        return np.array([[worth.get(row["fate"], 0) for row in rows] for rows in self.levels])

    def longer(self, reference: Tried) -> list[float]:
        """By how much its flights take longer at each level, as a share; see `longer`."""
        return [longer(rows, other) for rows, other in zip(self.levels, reference.levels, strict=True)]


@dataclass(frozen=True, slots=True)
class Choice:
    """All that was tried of a policy, and what is chosen of it, by what its fates are worth.

    `reference`: what flight times are held to.
    """

    tried: Sequence[Tried]
    chosen: Tried
    worth: Worth
    reference: Tried

    def gain(self, other: Tried, days: int) -> Interval:
        """By how much the chosen one is worth more than another, a goal; the interval is over days."""
        more = self.chosen.worth(self.worth) - other.worth(self.worth)
        return mean_interval(more.reshape(len(more), days, -1).mean(axis=(0, 2)))


def choose(tried: Mapping[str, Sequence[Tried]]) -> dict[str, Choice]:
    """Policy to its choice, by the rule that `tuning_text.RULE` tells; abstaining with survival's choice."""
    reference = _most(tried["score"])
    cautious = tried["survival"]
    brisk = [one for one in cautious if max(one.longer(reference)) <= MOST_LONGER]
    survival = _most(brisk or cautious)
    abstain = [abstaining(survival, below) for below in ABSTAIN_BELOW]
    return {
        "score": Choice(tried["score"], reference, ARRIVALS, reference),
        "margins": Choice(tried["margins"], _most(tried["margins"]), ARRIVALS, reference),
        "survival": Choice(cautious, survival, ARRIVALS, reference),
        "abstain": Choice(abstain, _most(abstain, LESS_LOST), LESS_LOST, reference),
    }


def _most(tried: Sequence[Tried], worth: Worth = ARRIVALS) -> Tried:
    """The first of the best."""
    return max(tried, key=lambda one: int(one.worth(worth).sum()))


def count(rows: Rows, fate: Fate) -> int:
    """How many had it."""
    return sum(row["fate"] == fate for row in rows)


def longer(rows: Rows, reference: Rows) -> float:
    """By how much flights take longer, as a share, to the goals that both reach safely; 0 without any."""
    own = others = 0
    for mine, other in zip(rows, reference, strict=True):
        if mine["fate"] == Fate.SAFE == other["fate"]:
            own, others = own + mine["steps"], others + other["steps"]
    return own / others - 1.0 if others else 0.0


def abstaining(tried: Tried, below: float) -> Tried:
    """Survival's plans, those not flown that survive in a smaller share of members."""

    def judged(row: dict[str, Any]) -> dict[str, Any]:
        turned_down = row["fate"] != Fate.NO_ROUTE and row["members_survived"] < below
        return row | {"fate": Fate.ABSTAINED} if turned_down else row

    levels = [[judged(row) for row in rows] for rows in tried.levels]
    return Tried(replace(tried.dials, abstain_below=below), levels)
