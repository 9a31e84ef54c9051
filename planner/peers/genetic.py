"""A genetic algorithm over a few via points and waits, by PyGAD.

A route is coded as via points between start and goal and a wait before each leg; legs are walked as
staircases of the four moves. Its fitness is taken in the changing map.
"""

from __future__ import annotations

import importlib
import random
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.peers.moves import Moves
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.staged import Cell, StagedProblem

VIA_POINTS = 4
GENERATIONS = 120
POPULATION = 60
_LONGEST_WAIT_STAGES = 2
_BREACH_STEPS = 50.0  # what one forbidden move costs, in steps of arrival


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The fittest route after the last generation, if it breaks no rule."""
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    try:
        pygad = importlib.import_module("pygad")
    except ImportError:
        return PeerRoute(reason="needs PyGAD: pip install 'galeway[peers]'")
    moves, last = Moves(problem), problem.clock.step_count - 1

    def fitness(_: Any, genes: NDArray[np.float64], __: int) -> float:
        cells = _walk(genes, start, goal)
        return -(len(cells) - 1) - _BREACH_STEPS * _breaches(moves, cells, last)

    rows, columns = problem.hazard.shape[1:]
    via = [{"low": 0.0, "high": float(rows)}, {"low": 0.0, "high": float(columns)}] * VIA_POINTS
    longest = float(_LONGEST_WAIT_STAGES * problem.clock.steps_per_stage)
    states = random.getstate(), np.random.get_state()  # noqa: NPY002 - PyGAD seeds the generators of all
    try:
        algorithm = pygad.GA(
            num_generations=GENERATIONS,
            sol_per_pop=POPULATION,
            num_parents_mating=POPULATION // 3,
            keep_elitism=4,
            num_genes=3 * VIA_POINTS + 1,
            gene_space=via + [{"low": -longest, "high": longest}] * (VIA_POINTS + 1),
            mutation_num_genes=2,
            parent_selection_type="tournament",
            fitness_func=fitness,
            random_seed=seed,
            suppress_warnings=True,
        )
        algorithm.run()
        best, _, _ = algorithm.best_solution(algorithm.last_generation_fitness)
    finally:
        random.setstate(states[0])
        np.random.set_state(states[1])  # noqa: NPY002
    cells = _walk(best, start, goal)
    breaches = _breaches(moves, cells, last)
    if breaches:
        return PeerRoute(reason=f"the fittest of {GENERATIONS} generations still breaks {breaches} moves")
    return PeerRoute(tuple(cells))


def _walk(genes: NDArray[np.float64], start: Cell, goal: Cell) -> list[Cell]:
    """The cells by step that a row of genes stands for; it ends where the goal is first met."""
    via = [(int(genes[2 * at]), int(genes[2 * at + 1])) for at in range(VIA_POINTS)]
    waits = [max(int(wait), 0) for wait in genes[2 * VIA_POINTS :]]
    cells = [start]
    for target, wait in zip([*via, goal], waits, strict=True):
        cells.extend([cells[-1]] * wait)
        cells.extend(_staircase(cells[-1], target))
        if goal in cells:
            break
    return cells[: cells.index(goal) + 1]


def _staircase(here: Cell, there: Cell) -> list[Cell]:
    """The cells after `here` of a walk that stays near the straight line."""
    rows, columns = abs(there[0] - here[0]), abs(there[1] - here[1])
    north, east = (1 if there[axis] > here[axis] else -1 for axis in (0, 1))
    (row, column), made_north, made_east = here, 0, 0
    cells = []
    for _ in range(rows + columns):
        if (2 * made_north + 1) * columns < (2 * made_east + 1) * rows:
            row, made_north = row + north, made_north + 1
        else:
            column, made_east = column + east, made_east + 1
        cells.append((row, column))
    return cells


def _breaches(moves: Moves, cells: list[Cell], last: int) -> int:
    """Moves that are not allowed, and steps beyond the horizon."""
    late = max(len(cells) - 1 - last, 0)
    inside = cells[: last + 1]
    return late + sum(not moves.may(step, here, there) for step, (here, there) in enumerate(pairwise(inside)))
