"""Plans made from wind: times, outcomes and reasons."""

import math
from dataclasses import replace

import numpy as np
import pytest

from planner.errors import OutsideGridError, PlannerError
from planner.grid import Grid, geodesic_m
from planner.hazards import StageClock
from planner.planning import Place, PlanningRequest, StagedMission, plan_staged
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


def test_every_goal_has_terms_and_the_best_so_far_of_each_stage():
    def wall_of_the_first_hour(east):
        east[0, :, 3] = 40.0

    for objective in ("earliest", "score", "survival"):
        request = replace(REQUEST, objective=objective, forecast_error_mps=3.0)
        outcome = plan_staged(wind(wall_of_the_first_hour), request).outcome
        terms = outcome.terms
        assert terms.clearance + terms.mean_clearance + terms.length + terms.time == outcome.score
        before, last = outcome.stages
        assert (before.stage, before.reachable, before.arrival_s) == (0, False, None)
        assert (last.stage, last.reachable) == (1, True)
        assert (last.arrival_s, last.score) == (outcome.arrival_s, outcome.score)
        assert outcome.nearest is None


def test_a_goal_without_a_way_says_how_near_and_until_when():
    def door_that_shuts(east):
        east[1:, :, 4] = 40.0

    request = replace(REQUEST, goals=(place("far", 6, 10),), goal="far", clock=StageClock(0.0, 2, 10, 360.0))
    request = replace(request, airspeed_min_mps=2.0)
    outcome = plan_staged(wind(door_that_shuts), request).outcome
    assert not outcome.reachable
    assert outcome.last_door_stage is None  # shut from the end of the first stage on, which belongs to it
    assert outcome.nearest.lon_deg == pytest.approx(-80.0 + 3 * STEP_DEG)
    assert outcome.nearest.lat_deg == pytest.approx(20.0 + 6 * STEP_DEG)
    assert outcome.nearest.arrival_s == 7 * 360.0
    assert outcome.nearest.distance_m == pytest.approx(
        geodesic_m(GRID.lat_rad[6], GRID.lon_rad[3], GRID.lat_rad[6], GRID.lon_rad[10])
    )
    in_time = plan_staged(wind(), replace(request, clock=StageClock(0.0, 1, 5, 360.0)))
    assert in_time.outcome.last_door_stage == 0  # time ran out


def breeze(east):
    """Ever windier northward, but nowhere hazardous; a gap of calm far east."""
    east[:] = 1.5 * np.arange(GRID.rows)[:, None]
    east[:, :, 9:] = 2.0


def test_survival_keeps_out_of_hazard_and_of_what_may_become_it():
    def storm(east):
        breeze(east)
        east[:, 4:6, 4:7] = 30.0

    request = replace(REQUEST, goals=(place("far", 6, 10),), goal="far", forecast_error_mps=2.0)
    plans = {
        objective: plan_staged(wind(storm), replace(request, objective=objective))
        for objective in ("earliest", "score", "survival")
    }
    chances = {objective: plan.outcome.survival for objective, plan in plans.items()}
    assert chances["survival"] > chances["earliest"]
    assert chances["survival"] >= chances["score"]
    problem = StagedMission.prepare(wind(storm), request).problem
    for plan in plans.values():
        assert plan.outcome.survival <= plan.outcome.survival_at_most <= 1.0
        assert plan.outcome.min_clearance_m > 0.0
        cells = [
            GRID.nearest_cell(math.radians(point.lat_deg), math.radians(point.lon_deg), "waypoint")
            for point in plan.waypoints
        ]
        assert not any(
            problem.hazard[point.stage][cell] for point, cell in zip(plan.waypoints, cells, strict=True)
        )
    same = plan_staged(wind(storm), replace(request, objective="score", forecast_error_mps=0.0))
    assert same.waypoints == plans["score"].waypoints
    assert (same.outcome.survival, same.outcome.abstained) == (None, False)


def test_survival_is_the_product_over_the_steps_of_the_normal_tail():
    request = replace(REQUEST, corridor_m=0.0, forecast_error_mps=4.0)
    plan = plan_staged(wind(breeze), request)
    assert len(plan.waypoints) == 5  # row 1: 1.5 m/s, 13.5 below the threshold
    safe = 0.5 * math.erfc(-(15.0 - 1.5) / 4.0 / math.sqrt(2.0))
    assert plan.outcome.survival == pytest.approx(safe**5)
    assert plan.outcome.survival_at_most == pytest.approx(safe)


def test_a_larger_error_survives_less_and_is_abstained_from():
    chances = [
        plan_staged(wind(breeze), replace(REQUEST, forecast_error_mps=error)).outcome.survival
        for error in (2.0, 4.0, 8.0)
    ]
    assert chances == sorted(chances, reverse=True)
    level = chances[1]
    for error, abstained in ((2.0, False), (4.0, False), (8.0, True)):
        plan = plan_staged(wind(breeze), replace(REQUEST, forecast_error_mps=error, abstain_below=level))
        assert plan.outcome.abstained == abstained
        assert plan.waypoints  # shown all the same


@pytest.mark.parametrize(("step_s", "word"), [(10.0, "3[0-9][0-9] m/s"), (3600.0, "1 m/s")])
def test_cells_that_cannot_be_flown_in_a_step_are_refused(step_s, word):
    clock = StageClock(0.0, stage_count=1, steps_per_stage=1, step_s=step_s)
    with pytest.raises(PlannerError, match=word):
        plan_staged(wind(), replace(REQUEST, clock=clock))


def test_bad_requests():
    with pytest.raises(PlannerError, match="no objective 'fuel'; choose earliest, score, survival"):
        plan_staged(wind(), replace(REQUEST, objective="fuel"))
    with pytest.raises(PlannerError, match="'nowhere'; there are near, far"):
        plan_staged(wind(), replace(REQUEST, goal="nowhere"))
    for missing in ({"objective": "survival"}, {"abstain_below": 0.5}):
        with pytest.raises(PlannerError, match="forecast_error_mps is 0"):
            plan_staged(wind(), replace(REQUEST, **missing))
    with pytest.raises(PlannerError, match="between 0 and 1"):
        plan_staged(wind(), replace(REQUEST, abstain_below=1.5, forecast_error_mps=1.0))
    with pytest.raises(PlannerError, match="error of -1"):
        plan_staged(wind(), replace(REQUEST, forecast_error_mps=-1.0))
    with pytest.raises(OutsideGridError, match="goal away"):
        plan_staged(wind(), replace(REQUEST, goals=(Place("away", 50.0, 0.0),), goal="away"))
