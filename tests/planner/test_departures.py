"""Departure slots and the assignment of vehicles to goals."""

import itertools
import math

import numpy as np
import pytest

from planner.arrivals import sweep_arrivals
from planner.departures import (
    Assignment,
    BestBy,
    Departures,
    assign_distinct,
    choose_slots,
    search_departures,
    slots_in_steps,
)
from planner.errors import PlannerError
from planner.ground import Ground
from planner.hazards import StageClock


def test_slots_are_steps_with_both_ends():
    clock = StageClock(0.0, 19, 30)
    assert slots_in_steps(0.0, 30.0, 10.0, clock) == (0, 5, 10, 15)
    assert slots_in_steps(4.0, 9.0, 4.0, clock) == (2, 4)
    assert len(slots_in_steps(0.0, 1080.0, 10.0, clock)) == 109
    assert slots_in_steps(0.0, 1080.0, 360.0, StageClock(0.0, 18, 30)) == (0, 180, 360)  # 540 is the end
    assert len(slots_in_steps(0.0, 0.3, 0.1, StageClock(0.0, 1, 10, 6.0))) == 4


@pytest.mark.parametrize(
    ("minutes", "says"),
    [
        ((0.0, 30.0, 0.0), "make no slots"),
        ((0.0, 30.0, -2.0), "make no slots"),
        ((30.0, 0.0, 10.0), "make no slots"),
        ((-10.0, 0.0, 10.0), "make no slots"),
        ((0.0, math.inf, 1.0), "make no slots"),
        ((math.nan, 10.0, 2.0), "make no slots"),
        ((0.0, 10.0, 5.0), "steps of 120 s; use multiples of 2 min"),
        ((1.0, 11.0, 2.0), "steps of 120 s"),
        ((0.0, 100.0, 1e-9), "steps of 120 s"),
        ((0.0, 1142.0, 2.0), "horizon, which ends at 1140 min"),
        ((1140.0, 1140.0, 2.0), "horizon, which ends at 1140 min"),
        ((0.0, 1e300, 2.0), "horizon"),
    ],
)
def test_slots_that_make_no_sense(minutes, says):
    with pytest.raises(PlannerError, match=says):
        slots_in_steps(*minutes, StageClock(0.0, 19, 30))


def test_the_safest_departure_is_the_first_to_arrive_of_equals():
    arrivals = np.array([[9], [7], [8], [-1]], dtype=np.int32)
    survival = np.array([[0.5], [0.9], [0.9], [0.0]])
    table = Departures((0, 1, 2, 3), ((0, 4),), 120.0, arrivals, survival)
    assert table.best(0, BestBy.SURVIVAL) == 1
    assert choose_slots(table, BestBy.SURVIVAL, distinct=False) == Assignment((1,), 12.0)
    blind = Departures((0,), ((0, 4),), 120.0, arrivals[:1])
    with pytest.raises(PlannerError, match="not searched for survival"):
        blind.best(0, BestBy.SURVIVAL)
    with pytest.raises(PlannerError, match="by 'luck'; choose arrival, flight, survival"):
        BestBy.named("luck")


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
