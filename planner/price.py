"""What a way costs besides time: a sum over its legs and waits, kept as prices of a second and of a metre.

Survival and, for a given time of arrival, the score of equation (2) are such sums; so one search and one way
of straightening serve all objectives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.legs import Country, Legs, fly, lay_legs
from planner.way import Leg
from planner.windfield import Floats

_TURN_S = 3.0  # what another leg must save at least: one leg that is nearly as fast flies better than many


@dataclass(frozen=True, eq=False)
class Price:
    """The price of moving; what it is counted in depends on the objective.

    `per_s`: of a second anywhere. `per_m`: of a true metre flown. `rate`: besides, of a second in each cell,
    shape [stage, north, east], None for none. `per_turn`: of another leg. `enough`: prices that differ by no
    more, or by no more than `enough_share` of themselves, are the same to a search.
    """

    per_s: float
    per_m: float = 0.0
    rate: Floats | None = None
    per_turn: float = 0.0
    enough: float = 0.0
    enough_share: float = 0.0

    def of_legs(self, country: Country, legs: Legs, time_s: Floats) -> Floats:
        """The price of each leg flown at such times, shape (legs,), infinite where they are."""
        price = self.per_s * (time_s[:, -1] - time_s[:, 0])
        if self.per_m:
            price = price + self.per_m * legs.length_m.sum(axis=1)
        return price if self.rate is None else price + along(self.rate, country, legs, time_s)

    def of_wait(self, country: Country, cell: tuple[int, int], from_s: float, until_s: float) -> float:
        """The price of waiting in a cell."""
        price = self.per_s * (until_s - from_s)
        if self.rate is not None and until_s > from_s:
            price += while_waiting(self.rate, country, cell, from_s, until_s)
        return price


TIME = Price(per_s=1.0, per_turn=_TURN_S, enough=0.1)
"""Seconds."""


def along(rate: Floats, country: Country, legs: Legs, time_s: Floats) -> Floats:
    """The integral over time of a rate of the cells, bilinear between their centres, of each leg.

    Between two levels the rate is that of the nearer one.
    """
    stages, _, columns = rate.shape
    known = np.where(np.isfinite(time_s), time_s, 0.0)
    stage = np.clip((0.5 * (known[:, 1:] + known[:, :-1]) / country.stage_s).astype(np.intp), 0, stages - 1)
    row, column = np.floor(legs.row).astype(np.intp), np.floor(legs.column).astype(np.intp)
    up, right = legs.row - row, legs.column - column
    north, east = np.minimum(row + 1, country.chart.levels.rows - 1), np.minimum(column + 1, columns - 1)
    if legs.level is not None:
        nearer = np.rint(legs.level).astype(np.intp) * country.chart.levels.band
        row, north = row + nearer, north + nearer
    total = np.zeros(stage.shape)
    for rows_at, columns_at, weight in (
        (row, column, (1.0 - up) * (1.0 - right)),
        (row, east, (1.0 - up) * right),
        (north, column, up * (1.0 - right)),
        (north, east, up * right),
    ):
        for end in (slice(None, -1), slice(1, None)):
            total += 0.5 * weight[:, end] * rate[stage, rows_at[:, end], columns_at[:, end]]
    with np.errstate(invalid="ignore"):
        sums: Floats = (total * np.diff(time_s, axis=1)).sum(axis=1)
    return np.where(np.isfinite(time_s[:, -1]), sums, np.inf)


def while_waiting(
    rate: Floats, country: Country, cell: tuple[int, int], from_s: float, until_s: float
) -> float:
    """The integral over time of a rate in one cell."""
    stages = np.arange(len(rate))
    last = len(rate) - 1
    begin_s, end_s = stages * country.stage_s, (stages + 1) * country.stage_s
    end_s[last] = np.inf
    spent_s = np.clip(np.minimum(end_s, until_s) - np.maximum(begin_s, from_s), 0.0, None)
    return float((spent_s * rate[:, cell[0], cell[1]]).sum())


def over_way(rate: Floats, country: Country, legs: Sequence[Leg]) -> float:
    """The integral over time of a rate along a way from its beginning to the last arrival, waits included."""
    total, now_s = 0.0, country.begin_s
    for leg in legs:
        total += while_waiting(rate, country, leg.start, now_s, leg.leave_s)
        laid = lay_legs(country.chart, leg.start, *(np.array([index]) for index in leg.end))
        total += float(along(rate, country, laid, fly(country, laid, leg.leave_s, leg.airspeed_mps))[0])
        now_s = leg.arrive_s
    return total


def framed(rate: NDArray[np.float64], margin: int) -> Floats:
    """A rate with a frame of zeros, flattened like the places of `intervals`: [stage, place]."""
    return np.pad(rate, ((0, 0), (margin, margin), (margin, margin))).reshape(len(rate), -1)
