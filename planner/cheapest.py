"""The cheapest way to each goal by a price that is not time: labels of (cell, bucket of time).

Such prices are not first in, first out: who arrives later may have come the better way. So a cell keeps one
label for each bucket of time in which a cheaper way arrives: cheaper than to have come by the label before
and to have waited since. Where nothing is gained by coming later, as in most cells, that leaves the few
labels of an earliest-arrival search. Within a stage prices do not change, so a wait ends only when a stage
begins that opens a move or makes it cheaper. The order in the buckets is that of `earliest`.

One label a bucket is not all that matters, so the result can miss the optimum by a little, and even a cell
that only an earlier, dearer arrival of the same bucket reaches before a door closes (there the earliest way
stays). What it says of a way is exact up to the bend of the wind within a cell.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.edges import Edges, Ints, TimedProblem, buckets
from planner.intervals import MARGIN, SafeIntervals
from planner.price import Price, framed
from planner.way import Cell, Node
from planner.windfield import Floats

_APART_S = 600.0  # a label that comes sooner after the one before has to be better by more


@dataclass(frozen=True, eq=False)
class Arrivals:
    """The labels of one goal in order of time, shape (labels,).

    `label`: their numbers. `time_s`: of arrival. `integral`: of the price's rate over the time until then.
    `length_m`: flown.
    """

    label: Ints
    time_s: Floats
    integral: Floats
    length_m: Floats


@dataclass(frozen=True, eq=False)
class Cheapest:
    """All labels, shape (labels,): `place`, `arrive_s`, `parent` (-1 at the start), `leave_s` of the parent.

    `arrivals`: the labels of each goal.
    """

    intervals: SafeIntervals
    place: Ints
    arrive_s: Floats
    parent: Ints
    leave_s: Floats
    arrivals: dict[Cell, Arrivals]

    def nodes_to(self, label: int, stage_s: float) -> list[Node]:
        """The nodes of the way to a label."""
        labels = [label]
        while (before := int(self.parent[labels[-1]])) >= 0:
            labels.append(before)
        labels.reverse()
        intervals = self.intervals
        leave_s = [float(self.leave_s[after]) for after in labels[1:]]
        nodes = []
        for at, leave in zip(labels, [*leave_s, np.inf], strict=True):
            arrive_s, place = float(self.arrive_s[at]), int(self.place[at])
            run = int(intervals.run[int(arrive_s // stage_s), place])
            begin_s, end_s = (float(stages[run]) * stage_s for stages in (intervals.begin, intervals.end))
            nodes.append(Node(intervals.cell_of(place), arrive_s, leave, begin_s, end_s))
        return nodes


class _Batch(NamedTuple):
    """Arrivals of moves, shape (moves,)."""

    place: Ints
    time_s: Floats
    integral: Floats
    length_m: Floats
    parent: Ints
    leave_s: Floats

    def part(self, which: NDArray[np.bool_] | Ints) -> _Batch:
        return _Batch(
            self.place[which],
            self.time_s[which],
            self.integral[which],
            self.length_m[which],
            self.parent[which],
            self.leave_s[which],
        )


def sweep(
    problem: TimedProblem,
    price: Price,
    start: Cell,
    goals: Sequence[Cell],
    until_s: Floats,
    most: float,
    begin_s: float = 0.0,
) -> Cheapest:
    """Labels from a cell that is left at a time, `begin_s`, or later.

    Args:
        problem: what to sweep through; the start has to be safe then.
        price: with a rate.
        start: where all ways begin.
        goals: whose arrivals are kept.
        until_s: latest arrival of use in each cell, shape [north, east].
        most: integral of the rate above which a way is of no use.
        begin_s: since departure.
    """
    spread = _Spread(problem, price, goals, until_s, most)
    begin = problem.intervals.place_of(*start)
    first = np.array([begin], dtype=np.intp)
    zero = np.zeros(1)
    pending: dict[int, list[_Batch]] = defaultdict(list)
    begun_s = np.array([begin_s])
    batch = _Batch(first, begun_s, zero, zero, np.array([-1], dtype=np.intp), np.array([np.nan]))
    timetable = list(buckets(problem))
    ends_s = np.array([end_s for _, _, end_s in timetable])
    _put(pending, batch, ends_s)
    entered = -1
    for number, (stage, span, end_s) in enumerate(timetable):
        if stage != entered:
            _put(pending, spread.moves(spread.enter(stage), span), ends_s)
            entered = stage
        batches = pending.pop(number, None)
        if batches:
            left = spread.settle(_joined(batches), end_s)
            _put(pending, spread.moves(left, span), ends_s)
    return spread.found()


def _put(pending: dict[int, list[_Batch]], batch: _Batch, ends_s: Floats) -> None:
    """Lay arrivals into the buckets that they fall in."""
    numbers = np.searchsorted(ends_s, batch.time_s, side="right")
    for number in range(int(numbers.min(initial=ends_s.size)), int(numbers.max(initial=-1)) + 1):
        which = np.flatnonzero(numbers == number)
        if which.size:
            pending[number].append(batch.part(which))


class _Spread:
    """The label that is best to have waited with in each place, and how labels spread."""

    def __init__(
        self, problem: TimedProblem, price: Price, goals: Sequence[Cell], until_s: Floats, most: float
    ) -> None:
        assert price.rate is not None
        self.problem, self.price, self.most = problem, price, most
        self.edges = Edges(problem)
        self.rate = framed(price.rate, MARGIN)
        until_s = np.minimum(until_s, problem.air.time_s[-1])
        self.until_s = framed(until_s[np.newaxis], MARGIN)[0]
        places = self.until_s.size
        self.time_s = np.full(places, np.inf)
        self.integral, self.length_m = np.zeros((2, places))
        self.label = np.full(places, -1, dtype=np.intp)
        self.least = np.full(places, np.inf)
        self.goals = np.array([problem.intervals.place_of(*goal) for goal in goals], dtype=np.intp)
        self.is_goal = np.zeros(places, dtype=np.bool_)
        self.is_goal[self.goals] = True
        self.settled: list[_Batch] = []
        self.arrived: list[tuple[Ints, _Batch]] = []
        self.count = 0

    def enter(self, stage: int) -> _Departures:
        """Go on to a stage; the moves that are worth having waited for."""
        opened = self.edges.enter(stage)
        if not stage:
            return _Departures.none()
        begin_s = stage * self.problem.clock.stage_s
        known = np.isfinite(self.time_s)
        self.time_s[known & (self.problem.intervals.run_end[stage] == 0)] = np.inf
        place = np.flatnonzero(np.isfinite(self.time_s))
        self.integral[place] += self.rate[stage - 1][place] * (begin_s - self.time_s[place])
        self.time_s[place] = begin_s
        fall = self.rate[stage - 1] - self.rate[stage]
        target = place + self.edges.shift[:, np.newaxis]
        edge_s = self.problem.moves.length_m.min() / self.problem.airspeed_mps
        there = fall.take(target, mode="clip")  # off the sheet no move leads
        cheaper = 0.5 * (fall[place] + there) * edge_s > self.price.enough
        moves, which = np.nonzero((self.edges.joint[:, place] > 0) & (opened[:, place] | cheaper))
        return self._from_held(place[which], moves)

    def _from_held(self, place: Ints, moves: Ints) -> _Departures:
        return _Departures(
            place, moves, self.time_s[place], self.integral[place], self.length_m[place], self.label[place]
        )

    def settle(self, batch: _Batch, end_s: float) -> _Departures:
        """Keep the best arrival of a bucket in each place, if it is better than waiting; all its moves."""
        place = batch.place
        rate = self.rate[self.edges.stage][place]
        left_s = end_s - batch.time_s
        value = batch.integral + rate * left_s + self.price.per_m * batch.length_m
        ranked = value - self.price.enough * (left_s / _APART_S)  # of equal ones the earliest
        np.minimum.at(self.least, place, ranked)
        won = np.flatnonzero((ranked == self.least[place]) & (value < self._held(place, end_s)))
        self.least[place] = np.inf
        won = won[np.unique(place[won], return_index=True)[1]]
        best = batch.part(won)
        place, labels = best.place, self.count + np.arange(won.size)
        self.time_s[place], self.integral[place] = best.time_s, best.integral
        self.length_m[place], self.label[place] = best.length_m, labels
        self.settled.append(best)
        self.count += won.size
        at_goal = np.flatnonzero(self.is_goal[place])
        if at_goal.size:
            self.arrived.append((labels[at_goal], best.part(at_goal)))
        moves, which = np.nonzero(self.edges.joint[:, place] > 0)
        return self._from_held(place[which], moves)

    def moves(self, left: _Departures, span: int) -> _Batch:
        """Make moves; of their arrivals those that are of use."""
        edges = self.edges
        place, moves, depart_s, integral, length_m, label = left
        arrive_s = edges.fly(place, moves, depart_s, span)
        target = place + edges.shift[moves]
        on_time = np.flatnonzero(arrive_s <= self.until_s[target])
        place, moves, target = place[on_time], moves[on_time], target[on_time]
        depart_s, arrive_s = depart_s[on_time], arrive_s[on_time]
        there = (arrive_s / self.problem.clock.stage_s).astype(np.intp)
        rate = 0.5 * (self.rate[edges.stage][place] + self.rate[there, target])
        integral = integral[on_time] + rate * (arrive_s - depart_s)
        length_m = length_m[on_time] + edges.length_of(place, moves)
        value = integral + self.price.per_m * length_m
        good = np.flatnonzero((integral <= self.most) & (value < self._held(target, arrive_s)))
        arrivals = _Batch(target, arrive_s, integral, length_m, label[on_time], depart_s)
        return arrivals.part(good)

    def _held(self, place: Ints, time_s: Floats | float) -> Floats:
        """What the price (but for that of time) has to stay below in places: that of having waited there."""
        since_s = self.time_s[place]
        known = np.isfinite(since_s)
        waited_s = time_s - np.where(known, since_s, 0.0)
        value = self.integral[place] + self.price.per_m * self.length_m[place]
        value += self.rate[self.edges.stage][place] * waited_s
        enough = self.price.enough + self.price.enough_share * np.abs(value)
        enough *= np.maximum(_APART_S / np.maximum(waited_s, 1.0), 1.0)
        return np.where(known, value - enough, np.inf)

    def found(self) -> Cheapest:
        """Everything that was settled."""
        every = _joined(self.settled)
        labels = np.concatenate([np.empty(0, dtype=np.intp), *(labels for labels, _ in self.arrived)])
        there = _joined([batch for _, batch in self.arrived])
        arrivals = {}
        for place in self.goals.tolist():
            which = np.flatnonzero(there.place == place)
            at = there.part(which)
            arrivals[self.problem.intervals.cell_of(place)] = Arrivals(
                labels[which], at.time_s, at.integral, at.length_m
            )
        return Cheapest(
            self.problem.intervals, every.place, every.time_s, every.parent, every.leave_s, arrivals
        )


class _Departures(NamedTuple):
    """Moves to be made, and the labels of the places that they leave, shape (moves,)."""

    place: Ints
    moves: Ints
    depart_s: Floats
    integral: Floats
    length_m: Floats
    label: Ints

    @classmethod
    def none(cls) -> _Departures:
        empty, none = np.empty(0), np.empty(0, dtype=np.intp)
        return cls(none, none, empty, empty, empty, none)


def _joined(batches: Sequence[_Batch]) -> _Batch:
    empty, none = np.empty(0), np.empty(0, dtype=np.intp)
    nothing = _Batch(none, empty, empty, empty, none, empty)
    return _Batch(*(np.concatenate(parts) for parts in zip(nothing, *batches, strict=True)))
