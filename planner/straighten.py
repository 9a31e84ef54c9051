"""From a way cell by cell to few straight legs in any direction, never later and always safe.

The legs between all pairs of nodes of the way (first with a few distances between them, then among those that
were kept and their neighbours) form a small network in time; the earliest way through it is found in order of
the nodes. Every round's network holds the legs of the round before, at the times at which they were flown, so
no round needs to arrive later than the one before; a leg counts for a few seconds more, so that a curve is
not cut into more legs than it is worth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from planner.earliest import Earliest
from planner.legs import Country, Ints, are_safe, fly, lay_legs
from planner.price import TIME, Price
from planner.way import Leg, Node
from planner.windfield import Floats

_SKIPS = np.array([1, 2, 4, 7, 12, 20, 32])
_NEXT = np.arange(1, 10)  # as far as the next corner with what lies around it
_ROUNDING = 1e-9
_SLOWEST_CHANGE = 3.0  # times the least that a change of level takes
_AROUND = 2  # nodes of the way to either side of a corner that the last round tries instead of it


def nodes_to(found: Earliest, state: int, stage_s: float) -> list[Node]:
    """The nodes of the way to a reached state."""
    intervals, states = found.intervals, found.states_to(state)
    leave_s = [float(found.leave_s[after]) for after in states[1:]]
    return [
        Node(
            intervals.cell_of(int(intervals.place[at])),
            float(found.arrive_s[at]),
            leave,
            int(intervals.begin[at]) * stage_s,
            int(intervals.end[at]) * stage_s,
        )
        for at, leave in zip(states, [*leave_s, np.inf], strict=True)
    ]


def cell_by_cell(way: Sequence[Node], airspeed_mps: float) -> list[Leg]:
    """The way as it is, at the times of the search: a leg for each move."""
    return [
        Leg(node.cell, after.cell, node.leave_s, after.arrive_s, airspeed_mps)
        for node, after in pairwise(way)
    ]


def straighten(
    country: Country,
    way: Sequence[Node],
    airspeed_mps: float,
    price: Price = TIME,
    way_price: float | None = None,
) -> list[Leg] | None:
    """Straight legs along a way, from its beginning on, or None if it cannot be flown in its intervals.

    By the price of time they arrive no later than the way does by the search, or flown cell by cell with the
    wind as it is in between (the two differ by what the wind bends within a cell).

    Args:
        country: what the legs are flown through.
        way: its nodes; waiting is tried where a node was left later than reached.
        airspeed_mps: true airspeed.
        price: what is made small.
        way_price: of the way by the search; without it, the time it takes.
    """
    network = _Network(country, way, airspeed_mps, price)
    leave_s = [node.leave_s for node in way]
    limit = price.enough + (way[-1].arrive_s - country.begin_s if way_price is None else way_price)
    best = network.cheapest(leave_s, range(len(way)), _SKIPS, price.per_turn)
    if best is None or best.price > limit:
        best = network.cheapest(leave_s, range(len(way)), _SKIPS, 0.0)
    if best is None:
        return None
    for around, skips in ((0, _SKIPS), (_AROUND, _NEXT)):
        nodes = _nodes_around(best, around, len(way) - 1)
        found = network.cheapest(_departures_of(best, len(way)), nodes, skips, price.per_turn)
        if found and found.price <= best.price + _ROUNDING * abs(best.price):
            best = found
    return [leg for _, leg in best.kept if leg]


@dataclass(frozen=True, slots=True)
class _Legs:
    """Legs to nodes of a way (none to the first), and their price without that of turns."""

    kept: list[tuple[int, Leg | None]]
    price: float


class _Network:
    """Direct legs between nodes of one way."""

    def __init__(self, country: Country, way: Sequence[Node], airspeed_mps: float, price: Price) -> None:
        self.country = country
        self.airspeed_mps = airspeed_mps
        self.price = price
        self.cells = [node.cell for node in way]
        self.rows, self.columns = np.array(self.cells).T
        levels = country.chart.levels
        level, self.row = np.divmod(self.rows, levels.band)
        self.height_m = levels.height_m[level]
        self.safe_from_s = np.array([node.safe_from_s for node in way])
        self.safe_until_s = np.array([node.safe_until_s for node in way])

    def cheapest(
        self, leave_s: Sequence[float], nodes: Sequence[int], skips: Ints, per_turn: float
    ) -> _Legs | None:
        """The cheapest way from the first to the last of some nodes, if there is one.

        Args:
            leave_s: when each node was left before, or not a number.
            nodes: those that legs may begin and end at, rising.
            skips: by how many of them a leg may go on.
            per_turn: what each leg counts for.
        """
        last = len(nodes) - 1
        index = np.array(nodes)
        cost, arrive_s = np.full(last + 1, np.inf), np.full(last + 1, np.inf)
        cost[0], arrive_s[0] = 0.0, self.country.begin_s
        source: list[tuple[int, float]] = [(-1, 0.0)] * (last + 1)
        for at in range(last):
            if not np.isfinite(arrive_s[at]):
                continue
            to = (at + skips)[at + skips <= last]
            now_s = float(arrive_s[at])
            for depart_s in _departures(now_s, leave_s[nodes[at]], self.country.stage_s):
                end_s, price = self._legs(nodes[at], index[to], depart_s)
                waited = self.price.of_wait(self.country, self.cells[nodes[at]], now_s, depart_s)
                total = cost[at] + per_turn + waited + price
                good = total < cost[to]
                arrive_s[to[good]] = end_s[good]
                cost[to[good]] = total[good]
                for reached in to[good].tolist():
                    source[reached] = at, depart_s
        if not np.isfinite(arrive_s[last]):
            return None
        kept: list[tuple[int, Leg | None]] = []
        at = last
        while at > 0:
            before, depart_s = source[at]
            leg = Leg(
                self.cells[nodes[before]],
                self.cells[nodes[at]],
                depart_s,
                float(arrive_s[at]),
                self.airspeed_mps,
            )
            kept.append((nodes[at], leg))
            at = before
        return _Legs([(nodes[0], None), *reversed(kept)], float(cost[last]) - per_turn * len(kept))

    def _legs(self, node: int, to: Ints, depart_s: float) -> tuple[Floats, Floats]:
        """When legs to other nodes end, and their price; infinite where legs or nodes are not safe."""
        end_s, price = np.full((2, *to.shape), np.inf)
        other = np.flatnonzero((self.row[to] != self.row[node]) | (self.columns[to] != self.columns[node]))
        to = to[other]
        if to.size:
            legs = lay_legs(self.country.chart, self.cells[node], self.rows[to], self.columns[to])
            time_s = fly(self.country, legs, depart_s, self.airspeed_mps)
            good = are_safe(self.country, legs, time_s)
            good &= (time_s[:, -1] >= self.safe_from_s[to]) & (time_s[:, -1] < self.safe_until_s[to])
            if legs.level is not None:
                good &= (to == node + 1) | self._steep(node, to, time_s[:, -1] - depart_s)
            end_s[other[good]] = time_s[good, -1]
            price[other[good]] = self.price.of_legs(self.country, legs, time_s)[good]
        return end_s, price

    def _steep(self, node: int, to: Ints, took_s: Floats) -> NDArray[np.bool_]:
        """Which legs keep their level, or change it as a manoeuvre and not all along a long leg."""
        assert self.country.climbing is not None
        least_s = self.country.climbing.least_s(self.height_m[node], self.height_m[to])
        return np.asarray((least_s == 0.0) | (took_s <= _SLOWEST_CHANGE * least_s))


def _departures_of(legs: _Legs, count: int) -> list[float]:
    """When each node of the way was left, not a number where it was not on the way."""
    leave_s = [float("nan")] * count
    for (at, _), (_, leg) in pairwise(legs.kept):
        if leg:
            leave_s[at] = leg.leave_s
    return leave_s


def _nodes_around(legs: _Legs, around: int, last: int) -> list[int]:
    offsets = range(-around, around + 1)
    return sorted({min(max(at + offset, 0), last) for at, _ in legs.kept for offset in offsets})


def _departures(arrive_s: float, leave_s: float, stage_s: float) -> list[float]:
    """At once, and at each stage that begins until the node was left before: that is when legs open."""
    if not arrive_s < leave_s < np.inf:
        return [arrive_s]
    begins = np.arange(np.floor(arrive_s / stage_s) + 1, np.floor(leave_s / stage_s) + 1) * stage_s
    return [arrive_s, *begins.tolist()]
