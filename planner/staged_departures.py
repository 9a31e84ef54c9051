"""When to leave through a wind field: the staged planner from every departure slot."""

from __future__ import annotations

from dataclasses import dataclass, replace

from planner.departure_table import DepartureTable
from planner.departures import BestBy, choose_slots, first_safe_slot, search_departures, slots_in_steps
from planner.planning import PlanningRequest, StagedMission
from planner.plans import Plan
from planner.survival import survival_by_departure
from planner.windfield import WindField


@dataclass(frozen=True, slots=True)
class StagedDepartures:
    """The plans from the departures chosen, and the table that they were chosen from.

    `plans`: that to the request's goal; or, of a fleet, one to each goal that a vehicle is sent to. `served`:
    whether every goal that was to be reached is.
    """

    plans: tuple[Plan, ...]
    table: DepartureTable
    served: bool


def plan_departures(
    wind: WindField,
    request: PlanningRequest,
    departures_min: tuple[float, float, float],
    *,
    best_by: BestBy | str = BestBy.ARRIVAL,
    distinct: bool = False,
) -> StagedDepartures:
    """Search every departure slot, and plan from the best one.

    Slots count from the departure of the request's clock, whose stages and horizon stay where they are: a
    later departure flies through the same hours of weather, and has less time.

    Args:
        wind: two-dimensional forecast whose grid is the planner's.
        request: start, goals, times and limits; its objective gives way to what `best_by` asks for.
        departures_min: first and last departure and the time between two, in minutes from the clock's.
        best_by: "arrival" or "flight", with routes of earliest arrival, or "survival", with the safest.
        distinct: one vehicle to each goal, no two in a slot, at the least total of flight minutes and 1440
            for each goal not reached.

    Raises:
        PlannerError: for input that makes no sense; the message says what and what to give instead.
    """
    by = BestBy.named(best_by)
    slots = slots_in_steps(*departures_min, request.clock)
    objective = "survival" if by is BestBy.SURVIVAL else "earliest"
    mission = StagedMission.prepare(wind, replace(request, objective=objective))
    ground, start, goals = mission.problem.ground, mission.start, mission.goals
    if by is BestBy.SURVIVAL and mission.probability is not None:
        searched = survival_by_departure(mission.probability, ground, start, goals, slots)
    else:
        searched = search_departures(ground, start, goals, slots)
    names = tuple(goal.name for goal in request.goals)
    table = DepartureTable(searched, by, distinct, choose_slots(searched, by, distinct=distinct), names)
    leaving = {name: table.step_of(goal) for goal, name in enumerate(names)}
    if distinct:
        sent = tuple(
            mission.plan(goal=name, first_step=step) for name, step in leaving.items() if step is not None
        )
        return StagedDepartures(sent, table, len(sent) == len(names))
    step = leaving[request.goal]
    first_step = first_safe_slot(ground, start, slots) if step is None else step
    return StagedDepartures((mission.plan(first_step=first_step),), table, step is not None)
