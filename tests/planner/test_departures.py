"""Departure slots and the assignment of vehicles to goals."""

import itertools
import math

import numpy as np
import pytest

from planner.arrivals import sweep_arrivals
from planner.departures import assign_distinct, search_departures, slots_in_steps
from planner.errors import PlannerError
from planner.ground import Ground
from planner.hazards import StageClock


def test_slots_are_steps_with_both_ends():
    assert slots_in_steps(0.0, 30.0, 10.0, 120.0) == (0, 5, 10, 15)
    assert len(slots_in_steps(0.0, 1080.0, 10.0, 120.0)) == 109
    for bad in [(0.0, 30.0, 0.0), (30.0, 0.0, 10.0), (0.0, math.inf, 1.0), (0.0, 10.0, 5.0)]:
        with pytest.raises(PlannerError):
            slots_in_steps(*bad, 120.0)


def test_leaving_later_saves_the_wait_before_a_closed_door():
    hazard = np.zeros((3, 1, 5), dtype=bool)
    hazard[0, 0, 2] = True
    hazard[2, 0, 0] = True
    ground = Ground(hazard, StageClock(0.0, 3, 6))
    found = search_departures(ground, (0, 0), [(0, 4), (0, 1)], [0, 2, 4, 6, 12])
    assert found.arrival_step.tolist() == [[9, 1], [9, 3], [9, 5], [10, 7], [-1, -1]]
    assert found.flight_min()[:, 0].tolist() == [18.0, 14.0, 10.0, 8.0, math.inf]
    assert (found.best_arrival(0), found.best_flight(0)) == (2, 3)
    for slot, row in zip(found.slots, found.arrival_step, strict=True):
        step = sweep_arrivals(ground, (0, 0), first_step=slot).step_at((0, 4))
        assert row[0] == (-1 if step is None else step)


def test_a_goal_that_no_slot_reaches_has_no_best():
    hazard = np.zeros((1, 1, 3), dtype=bool)
    hazard[0, 0, 1] = True
    found = search_departures(Ground(hazard, StageClock(0.0, 1, 6)), (0, 0), [(0, 2)], [0, 1])
    assert (found.best_arrival(0), found.best_flight(0)) == (None, None)
    with pytest.raises(PlannerError, match="horizon of 6"):
        search_departures(Ground(hazard, StageClock(0.0, 1, 6)), (0, 0), [(0, 2)], [6])


@pytest.mark.parametrize("seed", range(20))
def test_assignment_is_the_least_total_of_all(seed):
    random = np.random.default_rng(seed)
    slots, goals = int(random.integers(1, 6)), int(random.integers(1, 5))
    flight = np.where(random.random((slots, goals)) < 0.3, np.inf, random.integers(10, 2000, (slots, goals)))
    choices = [*range(slots), *[None] * goals]
    least = min(
        sum(1440.0 if slot is None else flight[slot, goal] for goal, slot in enumerate(chosen))
        for chosen in itertools.permutations(choices, goals)
    )
    found = assign_distinct(flight)
    assert found.total_min == pytest.approx(least)
    used = [slot for slot in found.slot if slot is not None]
    assert len(used) == len(set(used))
