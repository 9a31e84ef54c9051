"""The staged search: one sweep over the stages carries every reachable cell from step to step.

Source: "Route planning of UAV based on improved BFS". There is no closed list, since a reachable cell may
become dangerous and a blocked one may open. Each (step, cell) holds one label, the best incoming one by
equation (2); the parent is kept per (step, cell), so that routes may wait and come back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from planner.errors import BadFieldError, OutsideGridError
from planner.hazards import OFFSETS, Bools, Move, StageClock, clearance_cells
from planner.score import Weights

Cell = tuple[int, int]

_NOWHERE = -np.inf  # the value of what was not reached


class Occupancy(StrEnum):
    """Which stages a move asks to be safe.

    PAPER: the cell occupied at step k is safe in the stage that contains k. STRICT: both cells of a move
    are safe in every stage that the move touches.
    """

    PAPER = "paper"
    STRICT = "strict"


class Blocked(StrEnum):
    """Why a goal has no route."""

    START_IN_HAZARD = "the start is in hazard at departure"
    GOAL_ALWAYS_IN_HAZARD = "the goal is in hazard in every stage"
    NEVER_REACHABLE = "no safe way leads there within the horizon"
    NOT_FLYABLE = "every safe way there asks for airspeeds that the aircraft does not have"


@dataclass(frozen=True, slots=True)
class Route:
    """One way to a goal: the cell occupied at each step from 0 to the arrival, with the score there."""

    cells: tuple[Cell, ...]
    score: float
    clearance_cells: tuple[float, ...]

    @property
    def arrival_step(self) -> int:
        """The step at which the goal is reached."""
        return len(self.cells) - 1

    @property
    def waits(self) -> int:
        """Steps spent without moving."""
        return sum(here == there for here, there in zip(self.cells, self.cells[1:], strict=False))


@dataclass(frozen=True, slots=True)
class GoalRoutes:
    """What the sweep found for one goal: both routes, or why there is none."""

    goal: Cell
    earliest: Route | None
    best: Route | None
    blocked: Blocked | None


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
        stages = self.clock.stage_count
        if self.hazard.ndim != 3 or self.hazard.shape[0] != stages or not self.hazard.size:
            raise BadFieldError(
                f"hazard matrices of shape {self.hazard.shape} do not fit {stages} stages; "
                "give [stage, north, east] with at least one cell"
            )
        expected = (stages, len(Move), *self.hazard.shape[1:])
        if self.flyable is not None and self.flyable.shape != expected:
            raise BadFieldError(f"flyable moves have shape {self.flyable.shape}, not {expected}")


def search(problem: StagedProblem, start: Cell, goals: Sequence[Cell]) -> list[GoalRoutes]:
    """Find the earliest and the best-scoring route from `start` to each goal in one sweep.

    Args:
        problem: hazard, times, weights and the moves that can be made.
        start: (row, column) occupied at step 0.
        goals: (row, column) of each goal.

    Returns:
        One entry a goal, in their order.

    Raises:
        OutsideGridError: if the start or a goal lies off the grid.
    """
    shape = problem.hazard.shape[1:]
    for name, (row, column) in (("start", start), *(("goal", goal) for goal in goals)):
        if not (0 <= row < shape[0] and 0 <= column < shape[1]):
            raise OutsideGridError(
                f"the {name} ({row}, {column}) lies off the grid of {shape[0]} rows and {shape[1]} columns; "
                "rows and columns count from 0"
            )
    clearance = clearance_cells(problem.hazard, problem.weights.clearance_cap_cells)
    if problem.hazard[0][start]:
        return [GoalRoutes(goal, None, None, Blocked.START_IN_HAZARD) for goal in goals]
    parents, scores = _sweep(problem, clearance, start, goals)
    return [
        _routes_to(goal, scores[:, index], parents, clearance, problem) for index, goal in enumerate(goals)
    ]


def _sweep(
    problem: StagedProblem, clearance: NDArray[np.float64], start: Cell, goals: Sequence[Cell]
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Run every step; return parents per (step, cell) and scores per (step, goal), -inf if unreached."""
    clock, weights = problem.clock, problem.weights
    shape = problem.hazard.shape[1:]
    gamma = weights.gamma
    parents = np.zeros((clock.step_count, *shape), dtype=np.uint8)
    parents[0][start] = Move.STAY
    reached = np.zeros(shape, dtype=np.bool_)
    reached[start] = True
    history = np.where(reached, clearance[0], 0.0)  # sum of clearance along each label's route
    moves = np.zeros(shape)
    goal_index = tuple(np.array(goals, dtype=np.intp).reshape(-1, 2).T)
    scores = np.full((clock.step_count, len(goals)), _NOWHERE)
    for step in range(clock.step_count):
        stage = clock.stage_of_step(step)
        if step:
            before = clock.stage_of_step(step - 1)
            safe = ~problem.hazard[stage]
            if problem.occupancy is Occupancy.STRICT:
                safe &= ~problem.hazard[before]
                reached &= safe  # a source must also be safe as the next stage begins
            flyable = None if problem.flyable is None else problem.flyable[before]
            key = np.where(reached, weights.beta / (step + 1) * history - gamma * moves, _NOWHERE)
            best, parent = _best_incoming(key, gamma, flyable)
            reached = safe & (best > _NOWHERE)
            history, moves = _carry(history, moves, parent, reached)
            history[reached] += clearance[stage][reached]
            parents[step][reached] = parent[reached]
        value = weights.score(
            clearance=clearance[stage][goal_index],
            mean_clearance=history[goal_index] / (step + 1),
            moves=moves[goal_index],
            steps=step,
        )
        scores[step] = np.where(reached[goal_index], value, _NOWHERE)
    return parents, scores


def _best_incoming(
    key: NDArray[np.float64], gamma: float, flyable: Bools | None
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """The largest value that arrives at each cell and the move that brings it; ties go to the first move."""
    best = key.copy()
    parent = np.zeros(key.shape, dtype=np.uint8)
    for move in (Move.NORTH, Move.SOUTH, Move.EAST, Move.WEST):
        source, target = _slices(move)
        arriving = key[source] - gamma
        if flyable is not None:
            arriving = np.where(flyable[move][source], arriving, _NOWHERE)
        better = arriving > best[target]
        best[target][better] = arriving[better]
        parent[target][better] = move
    return best, parent


def _carry(
    history: NDArray[np.float64],
    moves: NDArray[np.float64],
    parent: NDArray[np.uint8],
    reached: Bools,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Histories and move counts taken over from the cell that each parent move left."""
    new_history, new_moves = np.zeros_like(history), np.zeros_like(moves)
    for move in Move:
        source, target = _slices(move)
        came = reached[target] & (parent[target] == move)
        new_history[target][came] = history[source][came]
        new_moves[target][came] = moves[source][came] + (move is not Move.STAY)
    return new_history, new_moves


_ENDS = {
    0: (slice(None), slice(None)),
    1: (slice(None, -1), slice(1, None)),
    -1: (slice(1, None), slice(None, -1)),
}


def _slices(move: Move) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Index the cells that a move leaves and, in the same order, those that it enters."""
    rows, columns = (_ENDS[offset] for offset in OFFSETS[move])
    return (rows[0], columns[0]), (rows[1], columns[1])


def _routes_to(
    goal: Cell,
    scores: NDArray[np.float64],
    parents: NDArray[np.uint8],
    clearance: NDArray[np.float64],
    problem: StagedProblem,
) -> GoalRoutes:
    arrivals = np.flatnonzero(np.isfinite(scores))
    if not arrivals.size:
        always = bool(problem.hazard[(slice(None), *goal)].all())
        reason = Blocked.GOAL_ALWAYS_IN_HAZARD if always else Blocked.NEVER_REACHABLE
        return GoalRoutes(goal, None, None, reason)

    def route(step: int) -> Route:
        cells = _walk_back(goal, step, parents)
        stages = (problem.clock.stage_of_step(at) for at in range(step + 1))
        clear = tuple(
            float(clearance[stage, row, column]) for stage, (row, column) in zip(stages, cells, strict=True)
        )
        return Route(cells, float(scores[step]), clear)

    return GoalRoutes(goal, route(int(arrivals[0])), route(int(scores.argmax())), None)


def _walk_back(goal: Cell, step: int, parents: NDArray[np.uint8]) -> tuple[Cell, ...]:
    cells = [goal]
    for at in range(step, 0, -1):
        row, column = cells[-1]
        rows, columns = OFFSETS[Move(int(parents[at, row, column]))]
        cells.append((row - rows, column - columns))
    return tuple(reversed(cells))
