"""The staged search: one sweep over the stages carries every reachable cell from step to step.

Source: "Route planning of UAV based on improved BFS". There is no closed list, since a reachable cell may
become dangerous and a blocked one may open. Each (step, cell) holds one label, the best incoming one by
equation (2); of two equally good labels the one with fewer moves stays, and of predecessors with equal labels
the first in the order STAY, NORTH, SOUTH, EAST, WEST is the parent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.arrivals import sweep_arrivals
from planner.blocked import Blocked
from planner.clearance import capped_clearance
from planner.dead_end import DeadEnd, dead_ends
from planner.ground import Cell, Ground, Occupancy
from planner.hazards import Bools, StageClock
from planner.route import Route, evaluate
from planner.score import Weights
from planner.sweep import Swept, Worth, sweep
from planner.trace import routes

__all__ = [
    "Blocked",
    "Cell",
    "GoalRoutes",
    "Occupancy",
    "Route",
    "StageEnd",
    "StagedProblem",
    "search",
]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class StageEnd:
    """What is known of a goal when a stage ends: the best route so far, or None while it is out of reach."""

    stage: int
    best: Route | None


def ends_of_earliest(route: Route, clock: StageClock) -> tuple[StageEnd, ...]:
    """The stages of a search whose earliest route is its best."""
    stages = range(clock.stage_of_step(route.first_step), clock.stage_count)
    arrival = clock.stage_of_step(route.arrival_step)
    return tuple(StageEnd(stage, route if arrival <= stage else None) for stage in stages)


@dataclass(frozen=True, slots=True)
class GoalRoutes:
    """What the sweep found for one goal: both routes, or why there is none.

    `stages`: the best route so far at the end of each stage, from the departure's on.
    """

    goal: Cell
    earliest: Route | None
    best: Route | None
    blocked: Blocked | None
    stages: tuple[StageEnd, ...] = ()
    dead_end: DeadEnd | None = None


@dataclass(frozen=True, slots=True)
class StagedProblem:
    """What to search through.

    `hazard`: [stage, north, east]. `flyable`: [stage, move, north, east] by the cell a move leaves, or None
    where every move can be made. Rows run northward, columns eastward.
    """

    hazard: Bools
    clock: StageClock
    weights: Weights
    occupancy: Occupancy = Occupancy.STRICT
    flyable: Bools | None = None

    def __post_init__(self) -> None:
        Ground(self.hazard, self.clock, self.occupancy, self.flyable)  # raises where shapes disagree

    @property
    def ground(self) -> Ground:
        """The problem without the weights."""
        return Ground(self.hazard, self.clock, self.occupancy, self.flyable)

    def clearance(self) -> Floats:
        """Clearance of every cell in every stage, capped, in cells."""
        return capped_clearance(self.hazard, self.weights.clearance_cap_cells)


def search(
    problem: StagedProblem, start: Cell, goals: Sequence[Cell], *, first_step: int = 0
) -> list[GoalRoutes]:
    """Find the earliest and the best-scoring route from `start` to each goal in one sweep.

    Args:
        problem: hazard, times, weights and the moves that can be made.
        start: (row, column) occupied at the step of departure.
        goals: (row, column) of each goal.
        first_step: the step of departure; length and time of equation (2) count from there.

    Returns:
        One entry a goal, in their order.

    Raises:
        OutsideGridError: if the start or a goal lies off the grid.
    """
    ground = problem.ground
    ground.check_cell("start", start)
    for goal in goals:
        ground.check_cell("goal", goal)
    if ground.hazard[ground.clock.stage_of_step(first_step)][start]:
        return [GoalRoutes(goal, None, None, Blocked.START_IN_HAZARD) for goal in goals]
    clearance = problem.clearance()
    swept = sweep(ground, score_worth(clearance, problem.weights), start, goals, first_step=first_step)
    found = _collect(swept, clearance, problem.weights, goals)
    return _explain(found, ground, start, first_step)


def score_worth(clearance: Floats, weights: Weights) -> Worth:
    """Equation (2) as worth of labels.

    Among labels of one step k and cell alpha D and delta T are equal, L is k less the waits, and Dbar the sum
    of clearance over k + 1. Times k + 1 what is left is beta times that sum plus gamma (k + 1) a wait.
    """
    cap = weights.clearance_cap_cells
    return Worth(clearance, weights.beta, weights.beta * cap, weights.gamma, wait_grows=True)


def scores_at(swept: Swept, clearance: Floats, weights: Weights, goals: Sequence[Cell]) -> Floats:
    """Equation (2) of the label at each (step, goal), -inf where unreached."""
    clock = swept.ground.clock
    elapsed = np.maximum(np.arange(clock.step_count) - swept.first_step, 0)[:, None]
    rows, columns = np.array(goals, dtype=np.intp).reshape(-1, 2).T
    stages = np.arange(clock.step_count) // clock.steps_per_stage
    here = clearance[:, rows, columns][stages]
    from_history = swept.values() / (elapsed + 1)
    return np.asarray(weights.alpha * here + from_history - (weights.gamma + weights.delta) * elapsed)


def _collect(swept: Swept, clearance: Floats, weights: Weights, goals: Sequence[Cell]) -> list[GoalRoutes]:
    """Trace the earliest, the best and the best so far of each stage, all in one go."""
    clock = swept.ground.clock
    scores = scores_at(swept, clearance, weights, goals)
    stages = range(clock.stage_of_step(swept.first_step), clock.stage_count)
    wanted: dict[tuple[Cell, int], Route | None] = {}
    plans: list[tuple[Cell, int | None, list[int | None]]] = []
    for goal, score in zip(goals, scores.T, strict=True):
        reached = np.isfinite(score)
        earliest = int(reached.argmax()) if reached.any() else None
        ends = [_best_before(score, (stage + 1) * clock.steps_per_stage) for stage in stages]
        plans.append((goal, earliest, ends))
        wanted.update({(goal, step): None for step in (earliest, *ends) if step is not None})
    for end, cells in zip(wanted, routes(swept, list(wanted)), strict=True):
        wanted[end] = evaluate(cells, clearance, clock, weights, swept.first_step)

    def route(goal: Cell, step: int | None) -> Route | None:
        return None if step is None else wanted[goal, step]

    return [
        GoalRoutes(
            goal,
            route(goal, earliest),
            route(goal, ends[-1]),
            None,
            tuple(StageEnd(stage, route(goal, end)) for stage, end in zip(stages, ends, strict=True)),
        )
        for goal, earliest, ends in plans
    ]


def _best_before(score: Floats, end: int) -> int | None:
    best = int(score[:end].argmax())
    return best if np.isfinite(score[best]) else None


def _explain(found: list[GoalRoutes], ground: Ground, start: Cell, first_step: int) -> list[GoalRoutes]:
    """Say of the goals without a route why."""
    missed = [entry.goal for entry in found if entry.earliest is None]
    if not missed:
        return found
    arrivals = sweep_arrivals(ground, start, first_step=first_step)
    reasons = dict(zip(missed, dead_ends(arrivals, missed), strict=True))
    return [
        entry
        if entry.earliest
        else replace(entry, blocked=why_blocked(ground, entry.goal), dead_end=reasons[entry.goal])
        for entry in found
    ]


def why_blocked(ground: Ground, goal: Cell) -> Blocked:
    """Why a goal that is not reached from a safe start is not."""
    always = bool(ground.hazard[:, goal[0], goal[1]].all())
    return Blocked.GOAL_ALWAYS_IN_HAZARD if always else Blocked.NEVER_REACHABLE
