"""When to leave: every departure slot searched, and one vehicle to each goal at the least total."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from planner.arrivals import NEVER, sweep_arrivals
from planner.errors import PlannerError
from planner.ground import Cell, Ground
from planner.hazards import StageClock

UNREACHED_MIN = 1440.0
"""What a goal that no vehicle reaches counts as in an assignment [min]."""


class BestBy(StrEnum):
    """Which departure is best: the earliest to arrive, the shortest flight, the likeliest to survive."""

    ARRIVAL = "arrival"
    FLIGHT = "flight"
    SURVIVAL = "survival"

    @classmethod
    def named(cls, name: str) -> BestBy:
        """The one of that name.

        Raises:
            PlannerError: if there is none.
        """
        try:
            return cls(name)
        except ValueError:
            raise PlannerError(f"departures are not compared by {name!r}; choose {', '.join(cls)}") from None


@dataclass(frozen=True, slots=True)
class Departures:
    """The arrival against departure table.

    `slots`: the step of each departure. `arrival_step`: shape [slot, goal], -1 where a goal is not reached.
    `survival`: of the same shape, 0 where a goal is not reached; with it the arrivals are those of the routes
    that are likeliest to survive, without it (None) the earliest.
    """

    slots: tuple[int, ...]
    goals: tuple[Cell, ...]
    step_s: float
    arrival_step: NDArray[np.int32]
    survival: NDArray[np.float64] | None = None

    def flight_min(self) -> NDArray[np.float64]:
        """Minutes from departure to arrival, shape [slot, goal], infinite where not reached."""
        flown = (self.arrival_step - np.array(self.slots)[:, None]) * self.step_s / 60.0
        return np.where(self.arrival_step < 0, np.inf, flown)

    def best_arrival(self, goal: int) -> int | None:
        """Index of the slot that arrives first, of equal ones the latest departure; None if none arrives."""
        arrivals = self.arrival_step[:, goal]
        reached = np.flatnonzero(arrivals >= 0)
        if not reached.size:
            return None
        return int(reached[arrivals[reached] == arrivals[reached].min()][-1])

    def best_flight(self, goal: int) -> int | None:
        """Index of the slot of the shortest flight, of equal ones the first; None if none arrives."""
        flight = self.flight_min()[:, goal]
        best = int(flight.argmin())
        return best if np.isfinite(flight[best]) else None

    def best_survival(self, goal: int) -> int | None:
        """Index of the slot of the greatest chance to survive, of equal ones the first to arrive.

        Raises:
            PlannerError: if the table has no survival.
        """
        if self.survival is None:
            raise PlannerError(
                "the departures were not searched for survival; search with survival_by_departure"
            )
        arrivals, chance = self.arrival_step[:, goal], self.survival[:, goal]
        reached = np.flatnonzero(arrivals >= 0)
        if not reached.size:
            return None
        safest = reached[chance[reached] == chance[reached].max()]
        return int(safest[arrivals[safest].argmin()])

    def best(self, goal: int, by: BestBy) -> int | None:
        """Index of the best slot for a goal, or None if no slot reaches it."""
        pick = {
            BestBy.ARRIVAL: self.best_arrival,
            BestBy.FLIGHT: self.best_flight,
            BestBy.SURVIVAL: self.best_survival,
        }
        return pick[by](goal)


def slots_in_steps(first_min: float, last_min: float, every_min: float, clock: StageClock) -> tuple[int, ...]:
    """Departure slots in minutes, both ends included, as steps; none at the very end of the horizon.

    Args:
        first_min: the first departure, counted from step 0.
        last_min: the last departure.
        every_min: between two departures.
        clock: whose steps the slots fall on.

    Raises:
        PlannerError: if a slot does not fall on a step of the horizon, or the slots make no sense.
    """
    given = f"departures {first_min:g}:{last_min:g}:{every_min:g}"
    if not (0.0 <= first_min <= last_min and every_min > 0.0 and np.isfinite(last_min + every_min)):
        raise PlannerError(f"{given} make no slots; give first:last:every in minutes, such as 0:600:30")
    horizon_min = clock.step_count * clock.step_s / 60.0
    if first_min >= horizon_min or last_min > horizon_min:
        raise PlannerError(
            f"{given} reach beyond the horizon, which ends at {horizon_min:g} min; leave earlier"
        )
    first, every = (minutes * 60.0 / clock.step_s for minutes in (first_min, every_min))
    if round(every) < 1 or any(abs(steps - round(steps)) > 1e-6 for steps in (first, every)):
        raise PlannerError(
            f"{given} do not fall on steps of {clock.step_s:g} s; "
            f"use multiples of {clock.step_s / 60.0:g} min"
        )
    last = min(int(last_min * 60.0 / clock.step_s + 1e-6), clock.step_count - 1)
    return tuple(range(round(first), last + 1, round(every)))


def search_departures(ground: Ground, start: Cell, goals: Sequence[Cell], slots: Sequence[int]) -> Departures:
    """Find the earliest arrival at each goal for each departure.

    A slot in which the start is in hazard arrives nowhere.

    Args:
        ground: where and how one may move.
        start: where all slots depart.
        goals: the goals.
        slots: steps of departure, within the horizon.
    """
    ground.check_departures(start, goals, slots)
    table = np.full((len(slots), len(goals)), NEVER, dtype=np.int32)
    for row, slot in enumerate(slots):
        table[row] = sweep_arrivals(ground, start, first_step=slot).steps_at(goals)
    return Departures(tuple(slots), tuple(goals), ground.clock.step_s, table)


def first_safe_slot(ground: Ground, start: Cell, slots: Sequence[int]) -> int:
    """The first departure that does not find the start in hazard, or simply the first."""
    hazard, clock = ground.hazard, ground.clock
    return next((slot for slot in slots if not hazard[clock.stage_of_step(slot)][start]), slots[0])


def choose_slots(departures: Departures, by: BestBy, *, distinct: bool) -> Assignment:
    """The departure of each goal: the best one, or with `distinct` a slot of its own at the least total."""
    flight_min = departures.flight_min()
    if distinct:
        return assign_distinct(flight_min)
    chosen = tuple(departures.best(goal, by) for goal in range(len(departures.goals)))
    return Assignment(chosen, _total_min(flight_min, chosen, UNREACHED_MIN))


@dataclass(frozen=True, slots=True)
class Assignment:
    """The slot's index for each goal, or None; and the minutes of all flights and goals unreached."""

    slot: tuple[int | None, ...]
    total_min: float


def assign_distinct(flight_min: NDArray[np.float64], unreached_min: float = UNREACHED_MIN) -> Assignment:
    """Give each goal a departure slot of its own at the least total.

    Args:
        flight_min: minutes of flight, shape [slot, goal], infinite where the goal is not reached.
        unreached_min: what a goal without a vehicle adds to the total.
    """
    goals = flight_min.shape[1]
    saved = np.minimum(flight_min, unreached_min) - unreached_min  # a goal may also stay without a vehicle
    chosen: list[int | None] = [None] * goals
    for row, column in zip(*map(np.ndarray.tolist, linear_sum_assignment(saved)), strict=True):
        if flight_min[row, column] <= unreached_min:
            chosen[column] = row
    return Assignment(tuple(chosen), _total_min(flight_min, chosen, unreached_min))


def _total_min(flight_min: NDArray[np.float64], chosen: Sequence[int | None], unreached_min: float) -> float:
    return sum(
        unreached_min if row is None else float(flight_min[row, goal]) for goal, row in enumerate(chosen)
    )
