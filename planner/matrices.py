"""Planning on a user's own hazard matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.arrivals import sweep_arrivals
from planner.departure_table import DepartureTable
from planner.departures import BestBy, choose_slots, first_safe_slot, search_departures, slots_in_steps
from planner.errors import PlannerError
from planner.goal_plan import GoalPlan
from planner.ground import Occupancy
from planner.matrix_input import BLUR_CELLS, MatrixProblem
from planner.matrix_search import Objective, plan_goals
from planner.score import Weights
from planner.survival import survival_by_departure

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
    members: ArrayLike | None = None,
    probability: ArrayLike | None = None,
    blur_cells: float = BLUR_CELLS,
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
        members: an ensemble [member, stage, row, column] beside `hazards`: the routes of any objective are
            counted in it, and with "survival" planned on it.
        probability: the chance of hazard [stage, row, column]; made from the ensemble if None. It is what
            survival is planned by, and with any objective reported from.
        blur_cells: blur of the share of members, in cells.
        abstain_below: the least chance to survive.

    Returns:
        One result a goal, in their order.

    Raises:
        PlannerError: for input that makes no sense; the message says what and what to give instead.
    """
    if objective not in OBJECTIVES:
        raise PlannerError(f"the objective {objective!r} is unknown; choose one of {', '.join(OBJECTIVES)}")
    if exact and objective != "score":
        raise PlannerError(f"exact applies to the objective 'score', not {objective!r}; leave it out")
    asked = MatrixProblem.checked(
        hazards,
        start,
        goals,
        survival=objective == "survival",
        steps_per_stage=steps_per_stage,
        step_s=step_s,
        weights=weights,
        occupancy=occupancy,
        members=members,
        probability=probability,
        blur_cells=blur_cells,
        abstain_below=abstain_below,
    )
    return plan_goals(asked, asked.goals, objective, asked.departure(depart_step), exact=exact)


@dataclass(frozen=True, slots=True)
class DeparturePlans:
    """One result a goal, each from the departure chosen for it, and the table that it was chosen from."""

    goals: list[GoalPlan]
    table: DepartureTable

    def to_dict(self) -> dict[str, Any]:
        """Both as plain numbers and lists, for JSON."""
        return {"goals": [goal.to_dict() for goal in self.goals], "departures": self.table.to_dict()}


def plan_departures(
    hazards: ArrayLike,
    start: Sequence[int],
    goals: Sequence[Sequence[int]],
    departures_min: tuple[float, float, float],
    *,
    best_by: BestBy | str = BestBy.ARRIVAL,
    distinct: bool = False,
    steps_per_stage: int = 30,
    step_s: float = 120.0,
    weights: Weights | None = None,
    occupancy: Occupancy | str = Occupancy.PAPER,
    members: ArrayLike | None = None,
    probability: ArrayLike | None = None,
    blur_cells: float = BLUR_CELLS,
    abstain_below: float = 0.0,
) -> DeparturePlans:
    """Search every departure slot on hazard matrices, and plan from the best one for each goal.

    Args:
        hazards: as for `plan`; an ensemble with `best_by` "survival".
        start: (row, column), counted from 0.
        goals: (row, column) of each goal.
        departures_min: first and last departure and the time between two, in minutes from step 0.
        best_by: "arrival", "flight" or "survival"; the routes are of earliest arrival, or the safest.
        distinct: one vehicle to each goal, no two in a slot, at the least total of flight minutes and 1440
            for each goal not reached; `best_by` then only says which routes are meant.
        steps_per_stage: steps that each matrix holds for.
        step_s: length of a step [s].
        weights: of equation (2), to score the routes.
        occupancy: "paper" or "strict".
        members: an ensemble beside `hazards`.
        probability: the chance of hazard [stage, row, column].
        blur_cells: blur of the share of members, in cells.
        abstain_below: the least chance to survive.

    Raises:
        PlannerError: for input that makes no sense; the message says what and what to give instead.
    """
    by = BestBy.named(best_by)
    safest = by is BestBy.SURVIVAL
    asked = MatrixProblem.checked(
        hazards,
        start,
        goals,
        survival=safest,
        steps_per_stage=steps_per_stage,
        step_s=step_s,
        weights=weights,
        occupancy=occupancy,
        members=members,
        probability=probability,
        blur_cells=blur_cells,
        abstain_below=abstain_below,
    )
    slots = slots_in_steps(*departures_min, asked.problem.clock)
    if safest and asked.probability is not None:
        searched = survival_by_departure(asked.probability, asked.closed, asked.start, asked.goals, slots)
    else:
        searched = search_departures(asked.closed, asked.start, asked.goals, slots)
    chosen = choose_slots(searched, by, distinct=distinct)
    names = tuple(f"{row},{column}" for row, column in asked.goals)
    table = DepartureTable(searched, by, distinct, chosen, names)
    return DeparturePlans(_from_chosen(asked, table), table)


def _from_chosen(asked: MatrixProblem, table: DepartureTable) -> list[GoalPlan]:
    """Each goal's plan from its slot; of a goal without one, why, from the first slot with a safe start."""
    objective: Objective = "survival" if table.best_by is BestBy.SURVIVAL else "earliest"
    fallback = first_safe_slot(asked.closed, asked.start, table.departures.slots)
    by_step: dict[int, list[int]] = {}
    for goal in range(len(asked.goals)):
        step = table.step_of(goal)
        by_step.setdefault(fallback if step is None else step, []).append(goal)
    plans: dict[int, GoalPlan] = {}
    for step, which in by_step.items():
        found = plan_goals(asked, [asked.goals[goal] for goal in which], objective, step)
        plans.update(zip(which, found, strict=True))
    return [
        GoalPlan(plan.goal, plan.step_s, None, table.no_slot_left)
        if plan.reachable and table.step_of(goal) is None
        else plan
        for goal, plan in sorted(plans.items())
    ]


def isochrones(
    hazards: ArrayLike,
    start: Sequence[int],
    *,
    steps_per_stage: int = 30,
    step_s: float = 120.0,
    occupancy: Occupancy | str = Occupancy.PAPER,
    depart_step: int = 0,
) -> NDArray[np.int32]:
    """The step at which each cell is first reached, shape [row, column], -1 where it never is.

    Args:
        hazards: [stage, row, column], anything but zero is hazard.
        start: (row, column), counted from 0.
        steps_per_stage: steps that each matrix holds for.
        step_s: length of a step [s].
        occupancy: "paper" or "strict".
        depart_step: the step of departure.

    Raises:
        PlannerError: for input that makes no sense; the message says what and what to give instead.
    """
    asked = MatrixProblem.checked(
        hazards,
        start,
        [start],
        survival=False,
        steps_per_stage=steps_per_stage,
        step_s=step_s,
        weights=None,
        occupancy=occupancy,
    )
    first_step = asked.departure(depart_step)
    return sweep_arrivals(asked.problem.ground, asked.start, first_step=first_step).field()
