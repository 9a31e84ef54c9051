"""Plans made from wind: times, outcomes and reasons."""

import math
from dataclasses import replace

import numpy as np
import pytest

from planner.errors import OutsideGridError, PlannerError
from planner.grid import Grid, geodesic_m
from planner.hazards import StageClock
from planner.planning import Place, PlanningRequest, plan_staged
from planner.windfield import WindField

STEP_DEG = 3600.0 / 111_000.0
GRID = Grid(math.radians(20.0), math.radians(-80.0), math.radians(STEP_DEG), math.radians(STEP_DEG), 8, 12)


def place(name, row, column):
    return Place(name, 20.0 + row * STEP_DEG, -80.0 + column * STEP_DEG)


def wind(paint=np.copy):
    east = np.zeros((3, *GRID.shape))
    paint(east)
    return WindField(
        grid=GRID, time_s=np.array([0.0, 3600.0, 7200.0]), north_mps=np.zeros_like(east), east_mps=east
    )


REQUEST = PlanningRequest(
    start=place("start", 1, 1),
    goals=(place("near", 1, 5), place("far", 6, 10)),
    goal="near",
    altitude_m=800.0,
    clock=StageClock(0.0, stage_count=2),
    threshold_mps=15.0,
    corridor_m=300.0,
    airspeed_min_mps=20.0,
    airspeed_max_mps=42.0,
    objective="earliest",
)


def test_a_calm_plan_goes_there_one_cell_a_step():
    plan = plan_staged(wind(), REQUEST)
    assert [waypoint.time_s for waypoint in plan.waypoints] == [0.0, 120.0, 240.0, 360.0, 480.0]
    assert {waypoint.altitude_m for waypoint in plan.waypoints} == {800.0}
    last = plan.waypoints[-1]
    assert (last.lat_deg, last.lon_deg) == pytest.approx((REQUEST.goals[0].lat_deg, REQUEST.goals[0].lon_deg))
    outcome = plan.outcome
    assert (outcome.earliest_arrival_s, outcome.waiting_s, outcome.min_clearance_m) == (480.0, 0.0, None)
    expected_m = sum(
        geodesic_m(GRID.lat_rad[1], GRID.lon_rad[c], GRID.lat_rad[1], GRID.lon_rad[c + 1])
        for c in range(1, 5)
    )
    assert outcome.length_m == pytest.approx(expected_m)


def test_a_wait_keeps_its_two_ends():
    def wall_of_the_first_hour(east):
        east[0, :, 3] = 40.0

    plan = plan_staged(wind(wall_of_the_first_hour), REQUEST)
    assert plan.outcome.waiting_s
    positions = [(waypoint.lat_deg, waypoint.lon_deg) for waypoint in plan.waypoints]
    assert all(len({*positions[at : at + 3]}) > 1 for at in range(len(positions) - 2))
    assert plan.outcome.earliest_arrival_s == plan.waypoints[-1].time_s
    assert plan.waypoints[-1].time_s > 3600.0


def test_head_wind_beyond_the_envelope_is_not_flown_into():
    def strong_easterlies(east):
        east[:] = -14.0  # below the threshold, but 30 m/s over ground against it asks for 44 m/s

    plan = plan_staged(wind(strong_easterlies), REQUEST)
    assert plan.outcome.reason == "every safe way there asks for airspeeds that the aircraft does not have"
    assert plan.waypoints == ()
    faster = plan_staged(wind(strong_easterlies), replace(REQUEST, airspeed_max_mps=50.0))
    assert faster.outcome.reachable


@pytest.mark.parametrize(
    ("cell", "reason"), [((1, 1), "the start is in hazard"), ((1, 5), "the goal is in hazard in every")]
)
def test_reasons(cell, reason):
    def storm(east):
        east[:, cell[0], cell[1]] = 30.0

    plan = plan_staged(wind(storm), REQUEST)
    assert not plan.outcome.reachable
    assert plan.outcome.reason.startswith(reason)


def test_a_closed_door_is_not_blamed_on_the_airspeed():
    def wall(east):
        east[:, :, 3] = 40.0

    plan = plan_staged(wind(wall), REQUEST)
    assert plan.outcome.reason == "no safe way leads there within the horizon"


@pytest.mark.parametrize(("step_s", "word"), [(10.0, "3[0-9][0-9] m/s"), (3600.0, "1 m/s")])
def test_cells_that_cannot_be_flown_in_a_step_are_refused(step_s, word):
    clock = StageClock(0.0, stage_count=1, steps_per_stage=1, step_s=step_s)
    with pytest.raises(PlannerError, match=word):
        plan_staged(wind(), replace(REQUEST, clock=clock))


def test_bad_requests():
    with pytest.raises(PlannerError, match="no objective 'fuel'; choose earliest or score"):
        plan_staged(wind(), replace(REQUEST, objective="fuel"))
    with pytest.raises(PlannerError, match="'nowhere'; there are near, far"):
        plan_staged(wind(), replace(REQUEST, goal="nowhere"))
    with pytest.raises(OutsideGridError, match="goal away"):
        plan_staged(wind(), replace(REQUEST, goals=(Place("away", 50.0, 0.0),), goal="away"))
