"""Planning on a user's own hazard matrices."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.arrivals import Arrivals, sweep_arrivals
from planner.dead_end import dead_ends
from planner.errors import BadFieldError, PlannerError
from planner.exact import search_exact
from planner.goal_plan import GoalPlan
from planner.ground import Cell, Ground, Occupancy
from planner.hazards import Bools, StageClock
from planner.route import evaluate
from planner.score import Weights
from planner.staged import Blocked, StagedProblem, search, why_blocked
from planner.survival import probability_from_members, search_survival

Objective = Literal["earliest", "score", "survival"]
OBJECTIVES: tuple[Objective, ...] = ("earliest", "score", "survival")


def plan(
    hazards: ArrayLike,
    start: Sequence[int],
    goals: Sequence[Sequence[int]],
    *,
    steps_per_stage: int = 30,
    step_s: float = 120.0,
    objective: Objective = "earliest",
    weights: Weights | None = None,
    occupancy: Occupancy | str = Occupancy.PAPER,
    exact: bool = False,
    depart_step: int = 0,
    probability: ArrayLike | None = None,
    blur_cells: float = 3.0,
    abstain_below: float = 0.0,
) -> list[GoalPlan]:
    """Plan on hazard matrices.

    Args:
        hazards: [stage, row, column], anything but zero is hazard; rows northward, columns eastward. With the
            objective "survival" also an ensemble [member, stage, row, column].
        start: (row, column), counted from 0.
        goals: (row, column) of each goal; one may be given twice.
        steps_per_stage: steps that each matrix holds for.
        step_s: length of a step [s].
        objective: which route is wanted: "earliest" arrival, best "score" of equation (2), or "survival".
        weights: of equation (2), also to score the routes of the other objectives.
        occupancy: "paper" or "strict"; see Occupancy.
        exact: with "score": the true optimum and its gap instead of the one-label value.
        depart_step: the step of departure.
        probability: with "survival": the chance of hazard [stage, row, column]; made from `hazards` if None.
        blur_cells: with "survival": blur of the share of members, in cells.
        abstain_below: with "survival": the least chance to survive.

    Returns:
        One result a goal, in their order.

    Raises:
        PlannerError: for input that makes no sense; the message says what and what to give instead.
    """
    if objective not in OBJECTIVES:
        raise PlannerError(f"the objective {objective!r} is unknown; choose one of {', '.join(OBJECTIVES)}")
    if exact and objective != "score":
        raise PlannerError(f"exact applies to the objective 'score', not {objective!r}; leave it out")
    members = _members(hazards, objective)
    clock = _clock(members.shape[1], steps_per_stage, step_s, depart_step)
    try:
        how = Occupancy(occupancy)
    except ValueError:
        raise PlannerError(f"the occupancy {occupancy!r} is unknown; choose paper or strict") from None
    problem = StagedProblem(members[0], clock, weights or Weights(), how)
    begin = _cell("start", start)
    ends = [_cell("goal", goal) for goal in goals]
    if not ends:
        raise PlannerError("no goal is given; name at least one (row, column)")
    ground = problem.ground
    for name, cell in (("start", begin), *(("goal", goal) for goal in ends)):
        ground.check_cell(name, cell)
    if objective == "survival":
        chance = _probability(probability, members, blur_cells)
        return _by_survival(problem, chance, members, begin, ends, depart_step, abstain_below)
    if objective == "earliest":
        return _by_arrival(problem, begin, ends, depart_step)
    return _by_score(problem, begin, ends, depart_step, exact=exact)


def _members(hazards: ArrayLike, objective: str) -> Bools:
    """The matrices as [member, stage, row, column]."""
    try:
        array = np.asarray(hazards)
        bad = array.dtype.kind not in "biuf"
    except ValueError:
        raise BadFieldError("the hazard matrices disagree in shape; give one shape for all stages") from None
    if bad:
        raise BadFieldError(f"hazard matrices of type {array.dtype}; give numbers or booleans")
    dimensions = (3, 4) if objective == "survival" else (3,)
    if array.ndim not in dimensions:
        raise BadFieldError(
            f"hazard matrices of shape {array.shape}; give [stage, row, column]"
            + (
                " or [member, stage, row, column]"
                if objective == "survival"
                else ", or pick one by its index"
            )
        )
    if not array.size:
        raise BadFieldError(f"hazard matrices of shape {array.shape} are empty; give a stage with a cell")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        at = tuple(int(index) for index in np.argwhere(~np.isfinite(array))[0])
        raise BadFieldError(f"the hazard at {at} is {array[at]}; give 0 for safe and 1 for hazard")
    hazard = np.asarray(array != 0, dtype=np.bool_)
    return hazard[None] if hazard.ndim == 3 else hazard


def _clock(stages: int, steps_per_stage: int, step_s: float, depart_step: int) -> StageClock:
    if not np.isfinite(step_s):
        raise BadFieldError(f"a step of {step_s} s; give a finite number above 0")
    clock = StageClock(0.0, stages, _whole("steps per stage", steps_per_stage), step_s)
    if not 0 <= _whole("departure step", depart_step) < clock.step_count:
        raise PlannerError(
            f"departure at step {depart_step} is not within the horizon of {clock.step_count} steps"
        )
    return clock


def _whole(name: str, value: int) -> int:
    try:
        return operator.index(value)
    except TypeError:
        raise PlannerError(f"the {name} {value!r} is not a whole number") from None


def _cell(name: str, cell: Sequence[int]) -> Cell:
    try:
        row, column = cell
    except (TypeError, ValueError):
        raise PlannerError(f"the {name} {cell!r} is not a (row, column)") from None
    return _whole(f"{name}'s row", row), _whole(f"{name}'s column", column)


def _probability(given: ArrayLike | None, members: Bools, blur_cells: float) -> NDArray[np.float64]:
    if given is None:
        return probability_from_members(members, blur_cells=blur_cells)
    return np.asarray(given, dtype=np.float64)


def _by_score(
    problem: StagedProblem, start: Cell, goals: list[Cell], depart_step: int, *, exact: bool
) -> list[GoalPlan]:
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
        GoalPlan(
            plan.goal,
            step_s,
            optimum.route,
            earliest_step=plan.earliest_step,
            stages=plan.stages,
            gap=optimum.gap,
        )
        if optimum.route
        else plan
        for plan, optimum in zip(plans, best, strict=True)
    ]


def _by_arrival(problem: StagedProblem, start: Cell, goals: list[Cell], depart_step: int) -> list[GoalPlan]:
    arrivals = sweep_arrivals(problem.ground, start, first_step=depart_step)
    clearance = problem.clearance()
    found = {goal: arrivals.route(goal) for goal in goals}
    missed = [goal for goal, cells in found.items() if cells is None]
    explained = dict(zip(missed, _without_route(problem.ground, arrivals, start, missed), strict=True))
    plans = []
    for goal in goals:
        cells = found[goal]
        if cells is None:
            plans.append(explained[goal])
        else:
            route = evaluate(cells, clearance, problem.clock, problem.weights, depart_step)
            plans.append(GoalPlan(goal, problem.clock.step_s, route, earliest_step=route.arrival_step))
    return plans


def _by_survival(
    problem: StagedProblem,
    probability: NDArray[np.float64],
    members: Bools,
    start: Cell,
    goals: list[Cell],
    depart_step: int,
    abstain_below: float,
) -> list[GoalPlan]:
    ground = Ground(np.zeros_like(problem.hazard), problem.clock, problem.occupancy)
    found = search_survival(
        probability,
        ground,
        start,
        goals,
        members=members if len(members) > 1 else None,
        abstain_below=abstain_below,
        first_step=depart_step,
    )
    clearance = problem.clearance()
    plans = []
    for safest in found:
        if not safest.cells:
            reason = "no way leads there that is not certain to meet hazard"
            plans.append(GoalPlan(safest.goal, problem.clock.step_s, None, reason))
            continue
        route = evaluate(safest.cells, clearance, problem.clock, problem.weights, depart_step)
        plans.append(
            GoalPlan(
                safest.goal,
                problem.clock.step_s,
                route,
                survival=safest.survival,
                members_survived=safest.members_survived,
                members=safest.members,
                abstained=safest.abstained,
            )
        )
    return plans


def _without_route(ground: Ground, arrivals: Arrivals, start: Cell, missed: list[Cell]) -> list[GoalPlan]:
    step_s = ground.clock.step_s
    if ground.hazard[ground.clock.stage_of_step(arrivals.first_step)][start]:
        return [GoalPlan(goal, step_s, None, str(Blocked.START_IN_HAZARD)) for goal in missed]
    return [
        GoalPlan(goal, step_s, None, str(why_blocked(ground, goal)), dead_end=end)
        for goal, end in zip(missed, dead_ends(arrivals, missed), strict=True)
    ]
