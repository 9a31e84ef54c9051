"""Runs several planners on one problem and sets their routes side by side, each judged by one referee."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import fmean

import numpy as np
from numpy.typing import NDArray

from planner.errors import BadFieldError
from planner.hazards import Bools, clearance_cells
from planner.peers import PEERS, Peer, PeerRoute
from planner.peers.breach import first_breach
from planner.staged import Cell, StagedProblem, search


@dataclass(frozen=True, slots=True)
class ComparisonRow:
    """One planner's route to one goal.

    `breach`: the first rule of the problem that the route breaks, None where it keeps all of them.
    `safe_in_truth`: whether it keeps clear of the true hazard, None where that was not given. What follows is
    None without a route. `arrival_step`: whole for planners on cells. `delay_steps`: arrival after the
    earliest there is on the four moves, of routes that break no rule; negative where a planner of any course
    cuts corners. `length_cells`: without waits. `waits`: steps spent without moving. Clearances are those of
    the score: in cells, at every step, capped. `score`: equation (2) at the arrival. `wall_s`: time taken.
    """

    peer: str
    goal: Cell
    route: PeerRoute
    breach: str | None
    safe_in_truth: bool | None
    arrival_step: float | None
    delay_steps: float | None
    length_cells: float | None
    waits: float | None
    min_clearance_cells: float | None
    mean_clearance_cells: float | None
    score: float | None
    wall_s: float

    @property
    def keeps_rules(self) -> bool:
        """Whether there is a route that breaks no rule of the problem."""
        return self.route.found and self.breach is None


def compare(
    problem: StagedProblem,
    start: Cell,
    goals: Sequence[Cell],
    peers: Mapping[str, Peer] = PEERS,
    *,
    truth: Bools | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda _: None,
) -> list[ComparisonRow]:
    """Run each planner from `start` to each goal.

    Args:
        problem: what all of them plan on.
        start: (row, column) at step 0.
        goals: (row, column) of each goal.
        peers: name to planner.
        truth: hazard as it really is, of the problem's shape, without any margin.
        seed: for planners that draw lots.
        progress: called with the name of each planner before it runs.

    Returns:
        A row for each planner and goal, planners first; the same every time, but for `wall_s`.

    Raises:
        OutsideGridError: if the start or a goal lies off the grid.
        BadFieldError: if `truth` has another shape than the problem's hazard.
    """
    if truth is not None and truth.shape != problem.hazard.shape:
        raise BadFieldError(
            f"true hazard of shape {truth.shape} does not fit the problem's {problem.hazard.shape}; "
            "bring both to one grid and one clock"
        )
    real = None if truth is None else replace(problem, hazard=truth, flyable=None)
    earliest = [
        None if found.earliest is None else found.earliest.arrival_step
        for found in search(problem, start, goals)
    ]
    clearance = clearance_cells(problem.hazard, problem.weights.clearance_cap_cells)
    rows = []
    for name, peer in peers.items():
        progress(name)
        for goal, optimum in zip(goals, earliest, strict=True):
            begin_s = time.perf_counter()
            route = peer.find(problem, start, goal, seed=seed)
            wall_s = time.perf_counter() - begin_s
            breach = first_breach(problem, start, goal, route, fastest=peer.fastest)
            safe = None
            if real is not None and route.found:
                safe = first_breach(real, start, goal, route, fastest=peer.fastest) is None
            rows.append(_row(name, goal, route, breach, safe, optimum, problem, clearance, wall_s))
    return rows


def _row(
    peer: str,
    goal: Cell,
    route: PeerRoute,
    breach: str | None,
    safe_in_truth: bool | None,
    optimum: int | None,
    problem: StagedProblem,
    clearance: NDArray[np.float64],
    wall_s: float,
) -> ComparisonRow:
    if not route.found:
        nothing = (None,) * 7
        return ComparisonRow(peer, goal, route, breach, safe_in_truth, *nothing, wall_s)
    cells, arrival = cells_by_step(route), route.arrival_step
    length = _length_cells(route)
    clear = [float(clearance[(problem.clock.stage_of_step(step), *cell)]) for step, cell in enumerate(cells)]
    return ComparisonRow(
        peer=peer,
        goal=goal,
        route=route,
        breach=breach,
        safe_in_truth=safe_in_truth,
        arrival_step=arrival,
        delay_steps=arrival - optimum if optimum is not None and breach is None else None,
        length_cells=length,
        waits=_waits_steps(route),
        min_clearance_cells=min(clear),
        mean_clearance_cells=fmean(clear),
        score=problem.weights.score(
            clearance=clear[-1], mean_clearance=fmean(clear), moves=length, steps=len(cells) - 1
        ),
        wall_s=wall_s,
    )


def cells_by_step(route: PeerRoute) -> tuple[Cell, ...]:
    """The cell occupied at each whole step, from 0 to the arrival rounded up."""
    if route.cells is not None:
        return route.cells
    if route.track is None:
        return ()
    steps = np.arange(math.ceil(route.arrival_step) + 1)
    known, rows, columns = zip(*route.track, strict=True)
    places = zip(np.interp(steps, known, rows), np.interp(steps, known, columns), strict=True)
    return tuple((round(float(row)), round(float(column))) for row, column in places)


def _length_cells(route: PeerRoute) -> float:
    places = route.cells or [(point.row, point.column) for point in route.track or ()]
    return sum(math.dist(here, there) for here, there in pairwise(places))


def _waits_steps(route: PeerRoute) -> float:
    """Steps spent in one place."""
    if route.cells is not None:
        return float(sum(here == there for here, there in pairwise(route.cells)))
    return sum(
        there.step - here.step
        for here, there in pairwise(route.track or ())
        if math.dist(here[1:], there[1:]) < 1e-9
    )
