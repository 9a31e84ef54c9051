"""The earliest arrival in every safe interval of every cell: a time-dependent sweep through the wind.

Safe-interval search (Phillips & Likhachev, *SIPP: Safe interval path planning for dynamic environments*,
2011) on a first-in-first-out network. A state is a cell and an interval in which it is safe; whoever reaches
it first can wait in it for whatever another could do later. States are settled in buckets of time no wider
than the shortest edge: nothing that leaves within a bucket arrives in it, so all that a bucket holds is final
when it comes up, without a heap, and can be treated as arrays. Buckets end at stages and at times of the air,
so that one bucket lies in one stage and one span. Waiting ends only when a stage begins: that is when moves
open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.edges import Edges, Ints, TimedProblem, buckets
from planner.intervals import SafeIntervals
from planner.windfield import Floats

Cell = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Earliest:
    """Of every state (numbered as the intervals' runs), shape (states,).

    `arrive_s`: since departure, infinite where not reached. `parent`: the state it was reached from, -1 at
    the start. `leave_s`: when that one was left; later than its arrival after a wait.
    """

    intervals: SafeIntervals
    arrive_s: Floats
    parent: NDArray[np.int32]
    leave_s: Floats

    def best_state(self, cell: Cell) -> int | None:
        """The state of a cell that is reached first, None if none is."""
        runs = self.intervals.run[:, self.intervals.place_of(*cell)]
        states = np.unique(runs[runs >= 0])
        if not states.size:
            return None
        best = int(states[np.argmin(self.arrive_s[states])])
        return best if np.isfinite(self.arrive_s[best]) else None

    def states_to(self, state: int) -> list[int]:
        """The states on the way from the start to a reached one, both included."""
        way = [state]
        while (before := int(self.parent[way[-1]])) >= 0:
            way.append(before)
        return way[::-1]


def sweep(
    problem: TimedProblem, start: Cell | Mapping[Cell, float], goals: Sequence[Cell] | None = None
) -> Earliest:
    """Earliest arrivals from a cell left at time 0 or later; with goals, until all of them are settled.

    Or from any of several cells, each from a time of its own on. They have to be safe then, and the wind in
    safe cells weaker than the airspeed.
    """
    intervals = problem.intervals
    front = _Front(problem)
    starts = start if isinstance(start, Mapping) else {start: 0.0}
    for cell, time_s in starts.items():
        first = intervals.run[problem.clock.stage_at(time_s), intervals.place_of(*cell)]
        front.arrive_s[first] = min(front.arrive_s[first], time_s)
    open_states = np.flatnonzero(np.isfinite(front.arrive_s))
    wanted = None if goals is None else np.array([intervals.place_of(*goal) for goal in goals], dtype=np.intp)
    entered = -1
    for stage, span, end_s in buckets(problem):
        if stage != entered:
            opened = front.enter(stage)
            entered = stage
            if stage:
                settled = front.waiting(stage, opened)
                open_states = np.concatenate([open_states, front.relax(*settled, span)])
        now = front.arrive_s[open_states] < end_s
        states = open_states[now]
        open_states = open_states[~now]
        if states.size:
            found = front.immediate(states, end_s)
            open_states = np.concatenate([open_states, front.relax(*found, span)])
        if wanted is not None:
            wanted = wanted[~front.settled(wanted, end_s)]
            if not wanted.size:
                break
    return Earliest(intervals, front.arrive_s, front.parent, front.leave_s)


class _Front(Edges):
    """The labels of the states, and how they spread."""

    def __init__(self, problem: TimedProblem) -> None:
        super().__init__(problem)
        states = problem.intervals.place.size
        self.arrive_s = np.full(states, np.inf)
        self.leave_s = np.full(states, np.nan)
        self.parent = np.full(states, -1, dtype=np.int32)

    def waiting(self, stage: int, opened: NDArray[np.bool_]) -> tuple[Ints, Ints, Floats]:
        """States that have waited for a move to open (states, moves, departures)."""
        moves, places = np.nonzero(opened)
        states = self.problem.intervals.run[stage][places]
        begin_s = stage * self.problem.clock.stage_s
        waited = self.arrive_s[states] < begin_s
        states = states[waited].astype(np.intp)
        return states, moves[waited], np.full(states.shape, begin_s)

    def immediate(self, states: Ints, end_s: float) -> tuple[Ints, Ints, Floats]:
        """Moves of states at once, without those to states that are settled."""
        intervals = self.problem.intervals
        places = intervals.place[states]
        moves, which = np.nonzero(self.joint[:, places] > 0)
        targets = intervals.run[self.stage][places[which] + self.shift[moves]]
        late = self.arrive_s[targets] >= end_s
        moves, states = moves[late], states[which[late]]
        return states, moves, self.arrive_s[states]

    def relax(self, states: Ints, moves: Ints, depart_s: Floats, span: int) -> Ints:
        """Make moves; the states that were reached for the first time come back."""
        intervals = self.problem.intervals
        source = intervals.place[states].astype(np.intp)
        arrive_s = self.fly(source, moves, depart_s, span)
        state = intervals.run[self.stage][source + self.shift[moves]]
        before_s = self.arrive_s[state]
        better = arrive_s < before_s
        state, arrive_s = state[better], arrive_s[better]
        np.minimum.at(self.arrive_s, state, arrive_s)
        won = arrive_s == self.arrive_s[state]
        self.parent[state[won]] = states[better][won]
        self.leave_s[state[won]] = depart_s[better][won]
        return np.unique(state[won & np.isinf(before_s[better])]).astype(np.intp)

    def settled(self, places: Ints, end_s: float) -> NDArray[np.bool_]:
        """Whether places have been reached before a bucket's end."""
        runs = self.problem.intervals.run[:, places]
        return np.asarray(((self.arrive_s[runs] < end_s) & (runs >= 0)).any(axis=0))
