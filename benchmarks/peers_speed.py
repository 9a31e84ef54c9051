"""The other systems against ours on the paper's size, and all of them side by side on a smaller map."""

from __future__ import annotations

import multiprocessing
import resource
import signal
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from statistics import fmean

import numpy as np
from numpy.typing import NDArray
from tables import duration, table, times
from timing import clocked, say
from worlds import Cell, drifting_patches, size_of, start_and_goals

from planner.arrivals import sweep_arrivals
from planner.compare import compare
from planner.hazards import StageClock
from planner.peers import PEERS, Find, PeerRoute
from planner.peers.breach import first_breach
from planner.score import Weights
from planner.staged import Occupancy, StagedProblem

TITLE = "The systems that the planner is compared with"
STEPS = 30
LIMIT_S = 15
"""Processor time that a system has on the paper's size for all of its goals."""
OURS = ("paper", "staged")
SHARE, SHORT_STEPS = 4, 8  # the smaller map has every fourth row and column, and as many steps a stage less

Hazard = NDArray[np.bool_]


def problem_of(hazard: Hazard, steps_per_stage: int) -> StagedProblem:
    clock = StageClock(0.0, len(hazard), steps_per_stage)
    return StagedProblem(hazard, clock, Weights(), Occupancy.PAPER)


@dataclass(frozen=True, slots=True)
class Answers:
    """What one system did with the goals that it came to within the limit.

    `arrivals`: the step of arrival by routes that keep the rules, else None. `own_s`: processor time.
    """

    arrivals: list[float | None]
    own_s: float
    finished: bool


def _answer(name: str, problem: StagedProblem, start: Cell, goals: list[Cell], answers: Connection) -> None:
    """What a child process does; the system ends it at the limit."""
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT_S, LIMIT_S + 5))
    for goal in goals:
        begin_s = time.process_time()
        route = PEERS[name].find(problem, start, goal)
        own_s = time.process_time() - begin_s
        kept = route.found and first_breach(problem, start, goal, route) is None
        answers.send((route.arrival_step if kept else None, own_s))


def answers_of(name: str, problem: StagedProblem, start: Cell, goals: list[Cell]) -> Answers:
    """Ask one system for a route to each goal, in a process of its own.

    Raises:
        SystemExit: if the process fails.
    """
    fork = multiprocessing.get_context("fork")
    receiver, sender = fork.Pipe(duplex=False)
    child = fork.Process(target=_answer, args=(name, problem, start, goals, sender))
    child.start()
    sender.close()
    found: list[tuple[float | None, float]] = []
    try:
        while True:
            found.append(receiver.recv())
    except EOFError:
        child.join()
    finished = len(found) == len(goals)
    if child.exitcode != (0 if finished else -signal.SIGXCPU):
        raise SystemExit(f"{name} ended with exit code {child.exitcode}")
    own_s = sum(taken_s for _, taken_s in found) if finished else float(LIMIT_S)
    say(f"{name}: {len(found)} goals in {'' if finished else '> '}{own_s:.2f} s")
    return Answers([arrival for arrival, _ in found], own_s, finished)


def full_size(hazard: Hazard) -> str:
    """Each system against one sweep of arrivals with routes, both for all goals."""
    problem, (start, goals) = problem_of(hazard, STEPS), start_and_goals(hazard)

    def sweep_once() -> list[tuple[Cell, ...] | None]:
        arrivals = sweep_arrivals(problem.ground, start)
        return [arrivals.route(goal) for goal in goals]

    ours_s, routes = clocked(sweep_once, 9)
    earliest = [None if route is None else len(route) - 1 for route in routes]
    reachable = sum(step is not None for step in earliest)
    one_by_one_s, _ = clocked(lambda: [PEERS["staged"].find(problem, start, goal) for goal in goals], 3)
    all_found = [f"{reachable} of {reachable}", str(len(goals))]
    rows = [
        ["**galeway, all goals in one sweep**", *all_found, duration(ours_s), ""],
        ["**galeway, a sweep for each goal**", *all_found, duration(one_by_one_s), ""],
    ]
    for name, peer in PEERS.items():
        if name in OURS:
            continue
        found = answers_of(name, problem, start, goals)
        pairs = list(zip(found.arrivals, earliest, strict=False))
        if peer.optimal and any(one != other for one, other in pairs):
            raise SystemExit(f"{name} and the staged search do not find the same")
        as_early = [one is not None and one <= other for one, other in pairs if other is not None]
        above = "" if found.finished else "> "
        rows.append(
            [
                f"**{peer.about}**" if peer.optimal else peer.about,
                f"{sum(as_early)} of {reachable}",
                str(len(pairs)),
                f"{above}{duration(found.own_s)}",
                f"{above}{times(found.own_s / ours_s)}",
            ]
        )
    return table(["", "earliest arrivals", "goals answered", "time", "galeway faster"], rows)


def _clocking(find: Find, spent_s: list[float]) -> Find:
    """The same call, which also notes the processor time that it takes."""

    def clocking(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
        own_s, route = clocked(lambda: find(problem, start, goal, seed=seed))
        spent_s.append(own_s)
        return route

    return clocking


def side_by_side(problem: StagedProblem, start: Cell, goals: list[Cell]) -> str:
    """All systems, ours among them, by the comparison that `galeway compare` makes."""
    rows = []
    for name, peer in PEERS.items():
        spent_s: list[float] = []
        own = compare(problem, start, goals, {name: peer._replace(find=_clocking(peer.find, spent_s))})
        kept = [row for row in own if row.keeps_rules]
        delays = [row.delay_steps for row in kept if row.delay_steps is not None]
        say(f"{name}: {sum(spent_s):.2f} s")
        rows.append(
            [
                peer.about,
                str(len(kept)),
                str(sum(row.breach is not None for row in own)),
                str(sum(delay <= 0.0 for delay in delays)),
                f"{fmean(delays):+.1f}" if delays else "-",
                f"{max(delays):+.1f}" if delays else "-",
                duration(fmean(spent_s)),
            ]
        )
    head = ["", "arrivals", "against the rules", "earliest", "mean delay", "worst delay", "time a goal"]
    return table(head, rows)


def section() -> str:
    hazard = drifting_patches()
    small = hazard[:, ::SHARE, ::SHARE]
    start, goals = start_and_goals(small)
    return f"""\
{size_of(hazard, STEPS)}, ten goals.
Each system of `planner/peers/` runs in a process of its own, one goal after the other as its call asks, and
has {LIMIT_S} s of processor time for all of them; ours finds all in one sweep. In bold, what solves the same
problem: the earliest arrival in the changing map, or that there is none. Ours is to be at least 10 times
faster than each of these for the same answer; the run checks that it is the same. The others are given for
their times: they answer an easier question. The paper's own planner, cell by cell, is in the section above.

{full_size(hazard)}

All of them on a smaller map, {size_of(small, SHORT_STEPS)},
with {len(goals)} goals. Arrivals are by routes that keep every rule; "against the rules", a route was given
that does not, mostly through hazard to come. Delays are in steps after the earliest arrival by the four
moves; systems in the plane cut corners, so that theirs can be negative.

{side_by_side(problem_of(small, SHORT_STEPS), start, goals)}"""


if __name__ == "__main__":
    print(section())
