"""The true optimum of equation (2), which one label per (step, cell) can miss.

For an arrival at step T the score is alpha D + beta / (T + 1) (sum of clearance) - gamma L - delta T: a sum
along the route, so that a sweep with the fixed weight 1 / (T + 1) finds its true optimum for that T. Not
every T needs its own sweep. With G(w) the largest value of w beta (sum of clearance) - gamma L among the
routes that arrive at step T, G is a maximum of linear functions, hence convex: between two weights that
were tried it lies below their chord, and that bounds the score of all arrivals between. The sweep goes
where the bound is highest, until no bound exceeds what was found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.ground import Cell
from planner.route import Route, evaluate
from planner.staged import StagedProblem
from planner.sweep import Swept, Worth, sweep
from planner.trace import routes

Floats = NDArray[np.float64]

TOLERANCE = 1e-6


@dataclass(frozen=True, slots=True)
class ExactRoute:
    """The best route to a goal, or None where there is none, and how far it may be from the optimum.

    `upper_bound`: no route scores more. `gap`: upper bound less score, 0 where the optimum is proven.
    """

    goal: Cell
    route: Route | None
    upper_bound: float
    gap: float


@dataclass(slots=True)
class _Trial:
    """One sweep's weight, and at each (step, goal) G and the score of the route that attains it."""

    weight: float
    attained: Floats
    scores: Floats


def search_exact(
    problem: StagedProblem,
    start: Cell,
    goals: Sequence[Cell],
    *,
    first_step: int = 0,
    tolerance: float = TOLERANCE,
    sweeps: int = 60,
) -> list[ExactRoute]:
    """Find the route of the highest score to each goal, over all routes and arrivals in the horizon.

    Args:
        problem: hazard, times, weights and the moves that can be made.
        start: (row, column) occupied at the step of departure, safe then.
        goals: (row, column) of each goal.
        first_step: the step of departure.
        tolerance: a gap below this counts as closed.
        sweeps: the most sweeps to spend; what is still open then is reported as the gap.
    """
    finder = _Finder(problem, start, goals, first_step)
    lower = finder.lower
    reached = np.flatnonzero(np.isfinite(lower).any(axis=1))
    if not reached.size:
        return [ExactRoute(goal, None, -np.inf, 0.0) for goal in goals]
    finder.try_step(int(reached[0]))
    finder.try_step(int(reached[-1]))
    for _ in range(sweeps - len(finder.trials)):
        upper, best = finder.upper(), finder.best_scores().max(axis=0)
        open_by = np.where(np.isfinite(upper), upper - np.where(np.isfinite(best), best, 0.0), -np.inf)
        if open_by.max() <= tolerance:
            break
        finder.try_step(int(open_by.max(axis=1).argmax()))
    return finder.results(tolerance)


class _Finder:
    def __init__(self, problem: StagedProblem, start: Cell, goals: Sequence[Cell], first_step: int) -> None:
        self.problem, self.start, self.goals, self.first_step = problem, start, goals, first_step
        self.clearance = problem.clearance()
        clock, weights = problem.clock, problem.weights
        self.elapsed = np.maximum(np.arange(clock.step_count) - first_step, 0)[:, None]
        rows, columns = np.array(goals, dtype=np.intp).reshape(-1, 2).T
        stages = np.arange(clock.step_count) // clock.steps_per_stage
        self.fixed = weights.alpha * self.clearance[:, rows, columns][stages] - weights.delta * self.elapsed
        self.trials: list[_Trial] = []
        self.lower = self._try(1.0)

    def _sweep(self, weight: float, *, keep: bool) -> Swept:
        weights = self.problem.weights
        cap = weights.clearance_cap_cells
        worth = Worth(self.clearance, weights.beta * weight, weights.beta * weight * cap, weights.gamma)
        return sweep(
            self.problem.ground, worth, self.start, self.goals, first_step=self.first_step, keep=keep
        )

    def _try(self, weight: float) -> Floats:
        """Sweep with a weight; the scores that its routes attain."""
        weights = self.problem.weights
        swept = self._sweep(weight, keep=False)
        attained = swept.values() - weights.gamma * self.elapsed
        moves = self.elapsed - swept.waits()
        history = (attained + weights.gamma * moves) / weight
        scores = np.asarray(self.fixed + history / (self.elapsed + 1) - weights.gamma * moves)
        self.trials.append(_Trial(weight, attained, scores))
        return scores

    def try_step(self, step: int) -> None:
        """Sweep with the weight that is exact for an arrival step."""
        weight = 1.0 / float(self.elapsed[step, 0] + 1)
        if all(trial.weight != weight for trial in self.trials):
            self._try(weight)

    def best_scores(self) -> Floats:
        """The highest score found, shape [step, goal]."""
        return np.asarray(np.max([trial.scores for trial in self.trials], axis=0))

    def upper(self) -> Floats:
        """What no route's score exceeds, shape [step, goal], -inf where there is no route."""
        trials = sorted(self.trials, key=lambda trial: trial.weight)
        tried = np.array([trial.weight for trial in trials])
        attained = np.array([trial.attained for trial in trials])
        if len(trials) == 1:  # nothing but the departure itself is an arrival
            return trials[0].scores
        wanted = 1.0 / (self.elapsed[:, 0] + 1)
        above = np.clip(np.searchsorted(tried, wanted - 1e-15), 1, len(tried) - 1)
        below = above - 1
        share = (wanted - tried[below]) / (tried[above] - tried[below])
        share = np.clip(share, 0.0, 1.0)[:, None]
        step = np.arange(len(wanted))
        with np.errstate(invalid="ignore"):
            chord = (1.0 - share) * attained[below, step] + share * attained[above, step]
        return np.where(np.isfinite(self.lower), self.fixed + chord, -np.inf)

    def results(self, tolerance: float) -> list[ExactRoute]:
        """The best route of each goal, traced out of the sweep that found it."""
        upper, scores = self.upper(), np.array([trial.scores for trial in self.trials])
        found: dict[int, ExactRoute] = {}
        by_trial: dict[int, list[tuple[int, int]]] = {}
        for index, goal in enumerate(self.goals):
            trial, step = divmod(int(scores[:, :, index].argmax()), scores.shape[1])
            if np.isfinite(scores[trial, step, index]):
                by_trial.setdefault(trial, []).append((index, step))
            else:
                found[index] = ExactRoute(goal, None, -np.inf, 0.0)
        for trial, ends in by_trial.items():
            swept = self._sweep(self.trials[trial].weight, keep=True)
            traced = routes(swept, [(self.goals[index], step) for index, step in ends])
            for (index, _), cells in zip(ends, traced, strict=True):
                route = evaluate(
                    cells, self.clearance, self.problem.clock, self.problem.weights, self.first_step
                )
                bound = max(float(upper[:, index].max()), route.score)
                gap = bound - route.score
                found[index] = ExactRoute(self.goals[index], route, bound, gap if gap > tolerance else 0.0)
        return [found[index] for index in range(len(self.goals))]
