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

from planner.earliest import Cell, Earliest
from planner.legs import Country, Ints, are_safe, fly, lay_legs
from planner.windfield import Floats

_SKIPS = np.array([1, 2, 3, 4, 6, 8, 12, 16, 24, 32])
_TURN_S = 3.0  # what another leg must save at least: one leg that is nearly as fast flies better than many
_SAME_S = 0.1  # arrivals that differ by no more, as those of search and legs do, are the same
_AROUND = 2  # nodes of the way to either side of a corner that the last round tries instead of it


@dataclass(frozen=True, slots=True)
class Node:
    """A cell on the way, when it is reached and left, and the run of safe stages around [s since departure].

    The last one is not left: its `leave_s` is infinite.
    """

    cell: Cell
    arrive_s: float
    leave_s: float
    safe_from_s: float
    safe_until_s: float


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight leg, when it is left and ended [s since departure], and the true airspeed on it."""

    start: Cell
    end: Cell
    leave_s: float
    arrive_s: float
    airspeed_mps: float


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


def straighten(country: Country, way: Sequence[Node], airspeed_mps: float) -> list[Leg] | None:
    """Straight legs along a way, from time 0 on, or None if the way itself cannot be flown in its intervals.

    They arrive no later than the way does by the search, or flown cell by cell with the wind as it is in
    between (the two differ by what the wind bends within a cell).

    Args:
        country: what the legs are flown through.
        way: its nodes; waiting is tried where a node was left later than reached.
        airspeed_mps: true airspeed.
    """
    network = _Network(country, way, airspeed_mps)
    leave_s = [node.leave_s for node in way]
    best = network.earliest(leave_s, range(len(way)), _SKIPS, _TURN_S)
    if best is None or _arrival(best) > way[-1].arrive_s + _SAME_S:
        best = network.earliest(leave_s, range(len(way)), _SKIPS, 0.0)
    if best is None:
        return None
    for around in (0, _AROUND):
        nodes = _nodes_around(best, around, len(way) - 1)
        found = network.earliest(_departures_of(best, len(way)), nodes, np.arange(1, len(nodes)), _TURN_S)
        if found and _arrival(found) <= _arrival(best):
            best = found
    return [leg for _, leg in best if leg]


_Kept = list[tuple[int, Leg | None]]


class _Network:
    """Direct legs between nodes of one way."""

    def __init__(self, country: Country, way: Sequence[Node], airspeed_mps: float) -> None:
        self.country = country
        self.airspeed_mps = airspeed_mps
        self.cells = [node.cell for node in way]
        self.rows, self.columns = np.array(self.cells).T
        self.safe_from_s = np.array([node.safe_from_s for node in way])
        self.safe_until_s = np.array([node.safe_until_s for node in way])

    def earliest(
        self, leave_s: Sequence[float], nodes: Sequence[int], skips: Ints, turn_s: float
    ) -> _Kept | None:
        """The earliest way from the first to the last of some nodes, if there is one.

        Args:
            leave_s: when each node was left before, or not a number.
            nodes: those that legs may begin and end at, rising.
            skips: by how many of them a leg may go on.
            turn_s: what each leg counts for.
        """
        last = len(nodes) - 1
        index = np.array(nodes)
        cost_s, arrive_s = np.full(last + 1, np.inf), np.full(last + 1, np.inf)
        cost_s[0] = arrive_s[0] = 0.0
        source: list[tuple[int, float]] = [(-1, 0.0)] * (last + 1)
        for at in range(last):
            if not np.isfinite(arrive_s[at]):
                continue
            to = (at + skips)[at + skips <= last]
            for depart_s in _departures(float(arrive_s[at]), leave_s[nodes[at]], self.country.stage_s):
                end_s = self._arrivals(nodes[at], index[to], depart_s)
                waste_s = cost_s[at] - arrive_s[at] + turn_s
                good = end_s + waste_s < cost_s[to]
                arrive_s[to[good]] = end_s[good]
                cost_s[to[good]] = end_s[good] + waste_s
                for reached in to[good].tolist():
                    source[reached] = at, depart_s
        if not np.isfinite(arrive_s[last]):
            return None
        kept: _Kept = []
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
        return [(nodes[0], None), *reversed(kept)]

    def _arrivals(self, node: int, to: Ints, depart_s: float) -> Floats:
        """When legs to other nodes end; infinite where they are not safe, or the node is not."""
        end_s = np.full(to.shape, np.inf)
        other = np.flatnonzero((self.rows[to] != self.rows[node]) | (self.columns[to] != self.columns[node]))
        to = to[other]
        if to.size:
            legs = lay_legs(self.country.chart, self.cells[node], self.rows[to], self.columns[to])
            time_s = fly(self.country, legs, depart_s, self.airspeed_mps)
            good = are_safe(self.country, legs, time_s)
            good &= (time_s[:, -1] >= self.safe_from_s[to]) & (time_s[:, -1] < self.safe_until_s[to])
            end_s[other[good]] = time_s[good, -1]
        return end_s


def _arrival(kept: _Kept) -> float:
    leg = kept[-1][1]
    return leg.arrive_s if leg else 0.0


def _departures_of(kept: _Kept, count: int) -> list[float]:
    """When each node of the way was left, not a number where it was not on the way."""
    leave_s = [float("nan")] * count
    for (at, _), (_, leg) in pairwise(kept):
        if leg:
            leave_s[at] = leg.leave_s
    return leave_s


def _nodes_around(kept: _Kept, around: int, last: int) -> list[int]:
    return sorted({min(max(at + offset, 0), last) for at, _ in kept for offset in range(-around, around + 1)})


def _departures(arrive_s: float, leave_s: float, stage_s: float) -> list[float]:
    """At once, at each stage that begins until the node was left before, and then."""
    if not arrive_s < leave_s < np.inf:
        return [arrive_s]
    begins = np.arange(np.floor(arrive_s / stage_s) + 1, np.ceil(leave_s / stage_s)) * stage_s
    return [arrive_s, *begins.tolist(), leave_s]
