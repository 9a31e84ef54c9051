"""A day as a task on which many values of the dials are tried at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from aircraft.description import load_aircraft
from aircraft.own_models import envelope_of
from planner.score import Weights
from sim.reproduce.days import Day
from sim.reproduce.flown_day import FlownDay
from sim.reproduce.forecasts import DayForecasts
from sim.reproduce.judged import judge_policies
from sim.reproduce.outlook import Case
from sim.reproduce.sources import Source
from sim.reproduce.tuning import Tuning
from sim.reproduce.worlds import World


@dataclass(frozen=True, slots=True)
class Trials:
    """The values that are tried: `betas` with each of `caps_cells`, `blurs_cells` with each of `prices`."""

    betas: tuple[float, ...]
    caps_cells: tuple[float, ...]
    margins_cells: tuple[float, ...]
    blurs_cells: tuple[float, ...]
    prices: tuple[float, ...]

    def of(self, policy: str) -> Iterator[Tuning]:
        """The dials at which a policy is tried; those that it does not look at are left alone."""
        if policy == "score":
            for beta, cap_cells in product(self.betas, self.caps_cells):
                yield Tuning(weights=Weights(beta=beta, clearance_cap_cells=cap_cells))
        elif policy == "margins":
            for cells in self.margins_cells:
                yield Tuning(margin_cells=cells)
        else:
            for blur_cells, price in product(self.blurs_cells, self.prices):
                yield Tuning(blur_cells=blur_cells, price=price)


TRIED = ("score", "margins", "survival")
"""Policies that plan; when to abstain is told from what survival planned."""


@dataclass(frozen=True, slots=True)
class TrialDay:
    """One day on which everything is tried."""

    source: Source
    day: int
    trials: Trials


@dataclass(frozen=True, slots=True)
class FlownDays:
    """Days as they are planned to be flown, but judged on the grid: a plan is safe at its own steps."""

    world: World
    scale: float

    def case(self, day: int) -> Case:
        """See `Source`."""
        forecasts = DayForecasts(Day(self.world, day), self.scale)
        flown = FlownDay(forecasts, envelope_of(load_aircraft("aerosonde")))
        return replace(flown.case(), truth=flown.judged())


def try_day(task: TrialDay) -> dict[str, list[list[Any]]]:
    """Policy to one list of rows for each of its dials, a row a goal."""
    case = task.source.case(task.day)
    return {
        policy: [judge_policies(case, (policy,), dials)[policy] for dials in task.trials.of(policy)]
        for policy in TRIED
    }
