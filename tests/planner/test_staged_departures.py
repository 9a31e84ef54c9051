"""Departures through a wind field: the table, the plan that is chosen from it, and a fleet."""

import math
from dataclasses import replace

import numpy as np
import pytest

from planner.errors import PlannerError
from planner.grid import Grid
from planner.hazards import StageClock
from planner.planning import Place, PlanningRequest, plan_staged
from planner.staged_departures import plan_departures
from planner.windfield import WindField

STEP_DEG = 3600.0 / 111_000.0
GRID = Grid(math.radians(20.0), math.radians(-80.0), math.radians(STEP_DEG), math.radians(STEP_DEG), 8, 12)
HOUR_S = 3600.0


def place(name, row, column):
    return Place(name, 20.0 + row * STEP_DEG, -80.0 + column * STEP_DEG)


@pytest.fixture
def wind():
    """A wall across the way in the first hour, wind beyond it, and a storm over the start in the last."""
    east = np.zeros((4, *GRID.shape))
    east[0, :, 3] = 40.0
    east[:, 5:, 4:9] = 11.0
    east[3, :, :2] = 40.0
    return WindField(grid=GRID, time_s=np.arange(4) * HOUR_S, north_mps=np.zeros_like(east), east_mps=east)


REQUEST = PlanningRequest(
    start=place("start", 1, 1),
    goals=(place("near", 1, 7), place("far", 6, 10), place("here", 1, 2)),
    goal="near",
    altitude_m=800.0,
    clock=StageClock(0.0, stage_count=3),
    threshold_mps=15.0,
    corridor_m=300.0,
    airspeed_min_mps=15.0,
    airspeed_max_mps=48.0,
)


def test_the_chosen_departure_is_the_best_of_all_that_could_be_planned(wind):
    for by in ("arrival", "flight"):
        found = plan_departures(wind, REQUEST, (0.0, 100.0, 10.0), best_by=by)
        (plan,) = found.plans
        assert found.served
        assert plan.objective == "earliest"
        left = plan.departure_s
        arrive = {}
        for minutes in range(0, 101, 10):
            (one,) = plan_departures(wind, REQUEST, (minutes, minutes, 10.0)).plans
            if one.waypoints:
                assert one.departure_s == 60.0 * minutes
                arrive[one.departure_s] = one.departure_s + one.outcome.arrival_s
        earliest = min(arrive.values())
        if by == "arrival":
            assert left == max(leave for leave, at in arrive.items() if at == earliest)
            assert left > 0.0  # which saves the wait at the wall
        else:
            assert arrive[left] - left == min(at - leave for leave, at in arrive.items())
        assert left + plan.waypoints[-1].time_s == arrive[left]
        assert plan.waypoints[0].time_s == 0.0
        assert plan.waypoints[-1].stage == REQUEST.clock.stage_at(arrive[left])


def test_leaving_at_once_is_the_plan_without_departures(wind):
    (plan,) = plan_departures(wind, REQUEST, (0.0, 0.0, 2.0)).plans
    assert plan == plan_staged(wind, replace(REQUEST, objective="earliest"))


def test_a_start_in_hazard_leaves_nowhere_and_says_so(wind):
    found = plan_departures(wind, REQUEST, (150.0, 170.0, 10.0))
    assert not found.served
    assert found.plans[0].outcome.reason == "the start is in hazard at departure"
    assert found.table.to_dict()["chosen"][0]["depart_min"] is None


def test_a_fleet_has_a_plan_for_each_goal_and_a_slot_for_each_plan(wind):
    found = plan_departures(wind, REQUEST, (60.0, 80.0, 10.0), distinct=True)
    assert found.served
    assert [plan.goal for plan in found.plans] == ["near", "far", "here"]
    assert len({plan.departure_s for plan in found.plans}) == 3
    total_min = sum(plan.outcome.arrival_s for plan in found.plans) / 60.0
    assert found.table.chosen.total_min == pytest.approx(total_min)
    short = plan_departures(wind, REQUEST, (60.0, 70.0, 10.0), distinct=True)
    assert not short.served
    assert len(short.plans) == 2


def test_the_safest_departure(wind):
    request = replace(REQUEST, goal="far", forecast_error_mps=2.0)
    found = plan_departures(wind, request, (60.0, 100.0, 20.0), best_by="survival")
    (plan,) = found.plans
    table = found.table.departures
    assert plan.objective == "survival"
    chances = table.survival[:, 1]
    assert plan.outcome.survival == pytest.approx(chances.max(), rel=1e-6)
    slot = list(chances).index(chances.max())
    assert table.arrival_step[slot, 1] * 120.0 == plan.departure_s + plan.outcome.arrival_s
    with pytest.raises(PlannerError, match="forecast_error_mps is 0"):
        plan_departures(wind, REQUEST, (0.0, 20.0, 10.0), best_by="survival")
    with pytest.raises(PlannerError, match="'luck'"):
        plan_departures(wind, REQUEST, (0.0, 20.0, 10.0), best_by="luck")
    with pytest.raises(PlannerError, match="horizon"):
        plan_departures(wind, REQUEST, (0.0, 200.0, 10.0))
