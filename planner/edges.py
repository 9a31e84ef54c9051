"""The moves of a wind-aware search in time: which are open, and when those that are made have been flown."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.air import Air
from planner.climbs import note_joint_end
from planner.hazards import StageClock
from planner.intervals import MARGIN, SafeIntervals
from planner.moves import Moves
from planner.windfield import Floats
from planner.windtriangle import arrival_times, ground_speed

Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class TimedProblem:
    """What to sweep through.

    `fastest_mps`: a ground speed that no edge exceeds; it sets the width of the buckets. `guard_s`: by how
    much a move has to end before its cells become hazardous.
    """

    intervals: SafeIntervals
    clock: StageClock
    air: Air
    moves: Moves
    airspeed_mps: float
    fastest_mps: float
    guard_s: float = 0.0


def buckets(problem: TimedProblem) -> Iterator[tuple[int, int, float]]:
    """Stage, span of the air and end [s] of every bucket of the horizon, in order.

    None is wider than the shortest edge, and each lies in one stage and one span.
    """
    widest_s = float(problem.moves.length_m.min()) / problem.fastest_mps * (1.0 - 1e-9)
    time_s = problem.air.time_s
    for span, (low_s, high_s) in enumerate(zip(time_s[:-1].tolist(), time_s[1:].tolist(), strict=True)):
        count = int(np.ceil((high_s - low_s) / widest_s))
        edges = np.linspace(low_s, high_s, count + 1).tolist()
        stage = problem.clock.stage_at(0.5 * (low_s + high_s))
        for end_s in edges[1:]:
            yield stage, span, end_s


class Edges:
    """All moves from all places of a problem, in one stage after the other."""

    def __init__(self, problem: TimedProblem) -> None:
        self.problem = problem
        intervals, moves = problem.intervals, problem.moves
        self.shift = np.array([rows * intervals.width + columns for rows, columns in moves.offsets])
        frame = ((0, 0), (MARGIN, MARGIN))
        self.length_m = np.pad(moves.length_m, frame, mode="edge")
        self.half_turn = np.pad(np.complex64(0.5) * moves.course.conj(), frame, mode="edge")
        self.airspeed_mps = np.full(len(moves.offsets), problem.airspeed_mps)
        for change in moves.changes:  # what is left of it over ground
            self.airspeed_mps[change.move] = np.sqrt(problem.airspeed_mps**2 - change.rate_mps**2)
        self.stage = 0
        self.joint = np.zeros((len(moves.offsets), intervals.run.shape[1]), dtype=np.int16)
        self._spare = np.zeros_like(self.joint) if moves.changes else self.joint
        self.sheets: dict[int, NDArray[np.complex64]] = {}

    def enter(self, stage: int) -> NDArray[np.bool_]:
        """Go on to a stage; the moves [move, place] that it opens."""
        before = self.joint
        self.stage = stage
        problem = self.problem
        self.joint = problem.intervals.joint_end(stage, problem.moves.swept)
        if problem.moves.levels is not None:
            span_s = stage * problem.clock.stage_s, (stage + 1) * problem.clock.stage_s
            kept = len(problem.moves.swept)
            level, self.joint, self._spare = self.joint, self._spare, before
            self.joint[:kept] = level
            note_joint_end(
                self.joint[kept:],
                problem.intervals,
                stage,
                problem.moves,
                problem.air,
                span_s,
                problem.airspeed_mps,
            )
        opened: NDArray[np.bool_] = (self.joint > 0) & (before == 0)
        return opened

    def length_of(self, source: Ints, moves: Ints) -> Floats:
        """True length of moves [m]."""
        length_m: Floats = self.length_m[moves, source // self.problem.intervals.width]
        return length_m

    def fly(self, source: Ints, moves: Ints, depart_s: Floats, span: int) -> Floats:
        """When moves that leave places within a span of the air's times end [s].

        Infinite where their cells do not stay safe until then (and the guard after).
        """
        problem = self.problem
        target = source + self.shift[moves]
        half_turn = self.half_turn[moves, source // problem.intervals.width]

        def speed_at(place: int, which: Ints) -> Floats:
            sheet = self._sheet(place)
            wind = (sheet[source[which]] + sheet[target[which]]) * half_turn[which]
            airspeed_mps = self.airspeed_mps[moves[which]] if problem.moves.changes else problem.airspeed_mps
            speed_mps: Floats = ground_speed(wind.real, wind.imag, airspeed_mps)
            return speed_mps

        arrive_s = arrival_times(depart_s, self.length_of(source, moves), problem.air.time_s, span, speed_at)
        until_s = self.joint[moves, source] * problem.clock.stage_s
        return np.where(arrive_s + problem.guard_s < until_s, arrive_s, np.inf)

    def _sheet(self, place: int) -> NDArray[np.complex64]:
        """The wind at one time, framed and flat like the intervals' places."""
        if place not in self.sheets:
            self.sheets.pop(place - 3, None)
            self.sheets[place] = np.pad(self.problem.air.wind_mps[place], MARGIN, mode="edge").ravel()
        return self.sheets[place]
