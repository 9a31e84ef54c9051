"""The searches on a user's own matrices, each giving one result a goal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from planner.arrivals import Arrivals, sweep_arrivals
from planner.dead_end import dead_ends
from planner.exact import search_exact
from planner.goal_plan import GoalPlan
from planner.ground import Cell, Ground
from planner.matrix_input import MatrixProblem
from planner.route import evaluate
from planner.staged import Blocked, ends_of_earliest, search, why_blocked
from planner.survival import search_survival, survival_of

Objective = Literal["earliest", "score", "survival"]


def plan_goals(
    asked: MatrixProblem,
    goals: Sequence[Cell],
    objective: Objective,
    depart_step: int,
    *,
    exact: bool = False,
) -> list[GoalPlan]:
    """Plan to some goals from one departure.

    Args:
        asked: the matrices and where to start.
        goals: the goals, on the grid.
        objective: which route is wanted.
        depart_step: the step of departure, within the horizon.
        exact: with "score": the true optimum.
    """
    if objective == "survival":
        return _by_survival(asked, goals, depart_step)
    if objective == "earliest":
        plans = _by_arrival(asked, goals, depart_step)
    else:
        plans = _by_score(asked, goals, depart_step, exact=exact)
    return plans if asked.probability is None else [_with_survival(plan, asked) for plan in plans]


def _by_score(
    asked: MatrixProblem, goals: Sequence[Cell], depart_step: int, *, exact: bool
) -> list[GoalPlan]:
    problem, start = asked.problem, asked.start
    found = search(problem, start, goals, first_step=depart_step)
    step_s = problem.clock.step_s
    plans = [
        GoalPlan(
            entry.goal,
            step_s,
            entry.best,
            str(entry.blocked or ""),
            entry.earliest.arrival_step if entry.earliest else None,
            entry.dead_end,
            entry.stages if entry.best else (),
        )
        for entry in found
    ]
    if not exact or not any(entry.best for entry in found):
        return plans
    best = search_exact(problem, start, goals, first_step=depart_step)
    return [
        replace(plan, route=optimum.route, gap=optimum.gap) if optimum.route else plan
        for plan, optimum in zip(plans, best, strict=True)
    ]


def _by_arrival(asked: MatrixProblem, goals: Sequence[Cell], depart_step: int) -> list[GoalPlan]:
    problem = asked.problem
    clock = problem.clock
    arrivals = sweep_arrivals(problem.ground, asked.start, first_step=depart_step)
    clearance = problem.clearance()
    found = {goal: arrivals.route(goal) for goal in goals}
    missed = [goal for goal, cells in found.items() if cells is None]
    explained = dict(zip(missed, _without_route(problem.ground, arrivals, asked.start, missed), strict=True))
    plans = []
    for goal in goals:
        cells = found[goal]
        if cells is None:
            plans.append(explained[goal])
            continue
        route = evaluate(cells, clearance, clock, problem.weights, depart_step)
        ends = ends_of_earliest(route, clock)
        plans.append(GoalPlan(goal, clock.step_s, route, earliest_step=route.arrival_step, stages=ends))
    return plans


def _by_survival(asked: MatrixProblem, goals: Sequence[Cell], depart_step: int) -> list[GoalPlan]:
    problem, probability = asked.problem, asked.probability
    assert probability is not None  # made with the problem for this objective
    clock, ground = problem.clock, asked.closed
    found = search_survival(
        probability,
        ground,
        asked.start,
        goals,
        members=asked.members,
        abstain_below=asked.abstain_below,
        first_step=depart_step,
        by_stage=True,
    )
    clearance = problem.clearance()
    missed = list(dict.fromkeys(safest.goal for safest in found if not safest.cells))
    explained: dict[Cell, GoalPlan] = {}
    if missed:
        arrivals = sweep_arrivals(ground, asked.start, first_step=depart_step)
        explained = dict(zip(missed, _without_route(ground, arrivals, asked.start, missed), strict=True))
    plans = []
    for safest in found:
        if not safest.cells:
            plans.append(explained[safest.goal])
            continue
        route, ends = safest.evaluated(clearance, clock, problem.weights)
        plans.append(
            GoalPlan(
                safest.goal,
                clock.step_s,
                route,
                stages=ends,
                chance=safest.chance,
                abstained=safest.abstained,
            )
        )
    return plans


def _with_survival(plan: GoalPlan, asked: MatrixProblem) -> GoalPlan:
    """The plan with the chance that its route survives."""
    if plan.route is None or asked.probability is None:
        return plan
    route, clock = plan.route, asked.problem.clock
    chance = survival_of(route.cells, route.first_step, asked.probability, clock, asked.members)
    return replace(plan, chance=chance, abstained=chance.below(asked.abstain_below))


def _without_route(ground: Ground, arrivals: Arrivals, start: Cell, missed: list[Cell]) -> list[GoalPlan]:
    step_s = ground.clock.step_s
    if ground.hazard[ground.clock.stage_of_step(arrivals.first_step)][start]:
        return [GoalPlan(goal, step_s, None, str(Blocked.START_IN_HAZARD)) for goal in missed]
    return [
        GoalPlan(goal, step_s, None, str(why_blocked(ground, goal)), dead_end=end)
        for goal, end in zip(missed, dead_ends(arrivals, missed), strict=True)
    ]
