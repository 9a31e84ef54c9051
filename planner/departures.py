"""When to leave: every departure slot searched, and one vehicle to each goal at the least total."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from planner.arrivals import sweep_arrivals
from planner.errors import PlannerError
from planner.ground import Cell, Ground

UNREACHED_MIN = 1440.0
"""What a goal that no vehicle reaches counts as in an assignment [min]."""


@dataclass(frozen=True, slots=True)
class Departures:
    """The arrival against departure table.

    `slots`: the step of each departure. `arrival_step`: shape [slot, goal], -1 where a goal is not reached.
    """

    slots: tuple[int, ...]
    goals: tuple[Cell, ...]
    step_s: float
    arrival_step: NDArray[np.int32]

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


def slots_in_steps(first_min: float, last_min: float, every_min: float, step_s: float) -> tuple[int, ...]:
    """Departure slots in minutes, both ends included, as steps.

    Raises:
        PlannerError: if a slot does not fall on a step, or the slots make no sense.
    """
    if not (0.0 <= first_min <= last_min and every_min > 0.0 and np.isfinite(last_min + every_min)):
        raise PlannerError(
            f"departures {first_min}:{last_min}:{every_min} make no slots; give first:last:every in minutes"
        )
    minutes = first_min + every_min * np.arange(int((last_min - first_min) / every_min + 1e-9) + 1)
    steps = minutes * 60.0 / step_s
    if not np.allclose(steps, np.rint(steps), atol=1e-6):
        raise PlannerError(
            f"departures every {every_min} min from {first_min} min do not fall on steps of {step_s:g} s; "
            f"use multiples of {step_s / 60.0:g} min"
        )
    return tuple(int(step) for step in np.rint(steps))


def search_departures(ground: Ground, start: Cell, goals: Sequence[Cell], slots: Sequence[int]) -> Departures:
    """Find the earliest arrival at each goal for each departure.

    A slot in which the start is in hazard arrives nowhere.

    Args:
        ground: where and how one may move.
        start: where all slots depart.
        goals: the goals.
        slots: steps of departure, within the horizon.
    """
    steps = ground.clock.step_count
    for slot in slots:
        if not 0 <= slot < steps:
            raise PlannerError(f"departure at step {slot} is not within the horizon of {steps} steps")
    for goal in goals:
        ground.check_cell("goal", goal)
    table = np.full((len(slots), len(goals)), -1, dtype=np.int32)
    for row, slot in enumerate(slots):
        arrivals = sweep_arrivals(ground, start, first_step=slot)
        for column, goal in enumerate(goals):
            step = arrivals.step_at(goal)
            table[row, column] = -1 if step is None else step
    return Departures(tuple(slots), tuple(goals), ground.clock.step_s, table)


@dataclass(frozen=True, slots=True)
class Assignment:
    """One vehicle to each goal, no two in a slot: the slot's index for each goal, or None."""

    slot: tuple[int | None, ...]
    total_min: float


def assign_distinct(flight_min: NDArray[np.float64], unreached_min: float = UNREACHED_MIN) -> Assignment:
    """Give each goal a departure slot of its own at the least total.

    Args:
        flight_min: minutes of flight, shape [slot, goal], infinite where the goal is not reached.
        unreached_min: what a goal without a vehicle adds to the total.
    """
    slots, goals = flight_min.shape
    cost = np.where(np.isfinite(flight_min), flight_min, unreached_min)
    unserved = np.full((goals, goals), unreached_min)  # each goal may also stay without a vehicle
    rows, columns = linear_sum_assignment(np.vstack([cost, unserved]))
    chosen: list[int | None] = [None] * goals
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        if row < slots and np.isfinite(flight_min[row, column]):
            chosen[column] = row
    total = sum(
        unreached_min if row is None else float(flight_min[row, goal]) for goal, row in enumerate(chosen)
    )
    return Assignment(tuple(chosen), float(total))
