"""Wind-aware plans: times, waits, limits, reasons, and the wind on every waypoint's leg."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from planner.errors import OutsideGridError, PlannerError
from planner.grid import Grid, geodesic_m
from planner.hazards import StageClock
from planner.planning import Place, PlanningRequest
from planner.windaware import plan_windaware
from planner.windfield import WindField

STEP_DEG = 3600.0 / 111_000.0
ROWS, COLUMNS = 16, 24
THRESHOLD_MPS = 15.0
CORRIDOR_M = 1100.0


def grid_of(finer=1):
    step_rad = math.radians(STEP_DEG) / finer
    return Grid(
        math.radians(20.0),
        math.radians(-80.0),
        step_rad,
        step_rad,
        (ROWS - 1) * finer + 1,
        (COLUMNS - 1) * finer + 1,
    )


GRID = grid_of()


def place(name, row, column):
    return Place(name, 20.0 + row * STEP_DEG, -80.0 + column * STEP_DEG)


REQUEST = PlanningRequest(
    start=place("start", 1, 1),
    goals=(place("near", 1, 5), place("far", 14, 22)),
    goal="far",
    altitude_m=800.0,
    clock=StageClock(0.0, stage_count=3),
    threshold_mps=THRESHOLD_MPS,
    corridor_m=CORRIDOR_M,
    airspeed_min_mps=22.0,
    airspeed_max_mps=39.0,
    objective="earliest",
    cruise_mps=27.0,
)


def wind_of(paint=lambda *_: None, grid=GRID):
    """Still air every half hour, painted over."""
    time_s = np.arange(7) * 1800.0
    north, east = np.zeros((2, time_s.size, *grid.shape))
    paint(north, east)
    return WindField(grid, time_s, north, east)


def eye(centre_row, centre_column, drift_columns_per_h, peak_mps=24.0, radius_cells=4.0, grid=GRID, finer=1):
    """A vortex that moves east."""

    def paint(north, east):
        rows, columns = np.indices(grid.shape) / finer
        for at in range(len(north)):
            up = rows - centre_row
            right = columns - centre_column - 0.5 * at * drift_columns_per_h
            distance = np.hypot(up, right) / radius_cells
            speed = peak_mps * distance * np.exp(0.5 * (1.0 - distance**2))
            angle = np.arctan2(right, up)
            north[at], east[at] = speed * -np.sin(angle), speed * np.cos(angle)

    return paint


def moving_legs(plan):
    """Pairs of waypoints that are not waits."""
    return [
        (before, after)
        for before, after in pairwise(plan.waypoints)
        if (before.lat_deg, before.lon_deg) != (after.lat_deg, after.lon_deg)
    ]


def flown(plan, wind, samples=25):
    """Along every leg, at the times of the plan: airspeed and wind speed, dense."""
    frame = wind.grid.frame
    airspeeds, winds = [], []
    share = np.linspace(0.0, 1.0, samples)
    for before, after in moving_legs(plan):
        lat_rad, lon_rad = np.radians([[w.lat_deg, w.lon_deg] for w in (before, after)]).T
        north_m, east_m = frame.to_plane(lat_rad, lon_rad)
        lat, lon = frame.to_geodetic(
            north_m[0] + share * np.diff(north_m), east_m[0] + share * np.diff(east_m)
        )
        took_s = after.time_s - before.time_s
        scale = np.array([frame.scale(float(value)) for value in lat])
        north, east, _ = wind.at_many(before.time_s + share * took_s, lat, lon)
        airspeeds.append(
            np.hypot(np.diff(north_m) / took_s / scale - north, np.diff(east_m) / took_s / scale - east)
        )
        winds.append(np.hypot(north, east))
    return np.concatenate(airspeeds), np.concatenate(winds)


def distance_m(start, goal, grid=GRID):
    return geodesic_m(*np.radians([start.lat_deg, start.lon_deg, goal.lat_deg, goal.lon_deg]))


def test_in_still_air_it_flies_straight_there_at_cruise():
    plan = plan_windaware(wind_of(), REQUEST)
    straight_m = distance_m(REQUEST.start, REQUEST.goals[1])
    assert (plan.planner, plan.objective, plan.goal) == ("windaware", "earliest", "far")
    assert plan.outcome.arrival_s == pytest.approx(straight_m / 27.0, rel=1e-4)
    assert plan.outcome.length_m == pytest.approx(straight_m, rel=1e-4)
    assert (plan.outcome.waiting_s, plan.outcome.min_clearance_m) == (0.0, None)
    assert plan.waypoints[-1].time_s == plan.outcome.arrival_s
    assert {waypoint.altitude_m for waypoint in plan.waypoints} == {800.0}
    spacing_s = np.diff([waypoint.time_s for waypoint in plan.waypoints])
    assert spacing_s == pytest.approx(spacing_s[0], rel=1e-6)
    assert 100.0 < spacing_s[0] < 140.0
    first, last = plan.waypoints[0], plan.waypoints[-1]
    assert (first.lat_deg, first.lon_deg) == pytest.approx((REQUEST.start.lat_deg, REQUEST.start.lon_deg))
    assert (last.lat_deg, last.lon_deg) == pytest.approx((REQUEST.goals[1].lat_deg, REQUEST.goals[1].lon_deg))


def test_without_a_cruise_it_takes_the_middle_of_the_envelope():
    plan = plan_windaware(wind_of(), replace(REQUEST, cruise_mps=None))
    assert flown(plan, wind_of())[0] == pytest.approx(30.5, rel=1e-3)


@pytest.mark.parametrize("wind_mps", [12.0, -12.0])
def test_constant_wind_gives_the_analytic_time(wind_mps):
    def blow(north, east):
        east += wind_mps

    plan = plan_windaware(wind_of(blow), replace(REQUEST, goals=(place("east", 1, 21),), goal="east"))
    straight_m = distance_m(REQUEST.start, place("east", 1, 21))
    assert plan.outcome.arrival_s == pytest.approx(straight_m / (27.0 + wind_mps), rel=1e-4)


@pytest.mark.parametrize(
    "storm",
    [
        eye(8, 12, 0.0),
        eye(13, 6, -4.0),
        eye(4, 20, -6.0),
        eye(10, 10, 2.0, 18.0, 5.0),
        eye(8, 12, 3.0, 40.0, 2.5),
    ],
)
@pytest.mark.parametrize("neighbours", [8, 16])
def test_plans_through_a_storm_are_safe_and_within_the_envelope(storm, neighbours):
    wind = wind_of(storm)
    plan = plan_windaware(wind, REQUEST, neighbours=neighbours)
    assert plan.outcome.reachable
    airspeeds, winds = flown(plan, wind)
    assert winds.max() <= THRESHOLD_MPS
    assert airspeeds.min() >= REQUEST.airspeed_min_mps - 0.3
    assert airspeeds.max() <= REQUEST.airspeed_max_mps
    waits = [
        after.time_s - before.time_s
        for before, after in pairwise(plan.waypoints)
        if (before.lat_deg, before.lon_deg) == (after.lat_deg, after.lon_deg)
    ]
    assert all(wait > REQUEST.wait_min_s - 1e-6 for wait in waits)
    assert plan.outcome.waiting_s == pytest.approx(sum(waits), abs=1e-6)
    assert (np.diff([waypoint.time_s for waypoint in plan.waypoints]) > 0.0).all()
    assert [w.stage for w in plan.waypoints] == [REQUEST.clock.stage_at(w.time_s) for w in plan.waypoints]
    assert plan.outcome.min_clearance_m > CORRIDOR_M


def test_it_loiters_until_the_wall_has_gone():
    def wall(north, east):
        east[:3, :, 10] = 40.0

    wind = wind_of(wall)
    plan = plan_windaware(wind, REQUEST)
    waits = [
        (before.time_s, after.time_s)
        for before, after in pairwise(plan.waypoints)
        if (before.lat_deg, before.lon_deg) == (after.lat_deg, after.lon_deg)
    ]
    assert len(waits) == 1
    assert waits[0][1] == 7200.0  # the wall fades from 3600 s to 5400 s: hazard until that hour ends
    assert plan.outcome.waiting_s == pytest.approx(waits[0][1] - waits[0][0])
    assert flown(plan, wind)[1].max() <= THRESHOLD_MPS


def test_arrivals_converge_on_finer_grids():
    arrivals_s = []
    for finer in (1, 2, 4):
        grid = grid_of(finer)
        wind = wind_of(eye(8, 9, 2.0, grid=grid, finer=finer), grid)
        arrivals_s.append(plan_windaware(wind, replace(REQUEST, corridor_m=300.0)).outcome.arrival_s)
    coarse, middle, fine = arrivals_s
    assert abs(fine - middle) < abs(middle - coarse)
    assert abs(fine - middle) < 0.01 * fine


def test_a_storm_more_never_brings_the_arrival_forward():
    def two(north, east):
        eye(8, 12, 0.0)(north, east)
        north[:, 2:5, 16:19] = east[:, 2:5, 16:19] = 30.0

    alone, both = (plan_windaware(wind_of(storm), REQUEST).outcome for storm in (eye(8, 12, 0.0), two))
    assert alone.arrival_s < both.arrival_s


def test_the_outcomes_of_all_goals():
    plan = plan_windaware(wind_of(eye(8, 12, 0.0)), REQUEST)
    near = next(outcome for outcome in plan.goals if outcome.name == "near")
    straight_m = distance_m(REQUEST.start, REQUEST.goals[0])
    assert near.length_m == pytest.approx(straight_m, rel=1e-4)
    assert near.arrival_s == near.earliest_arrival_s
    as_goal = plan_windaware(wind_of(eye(8, 12, 0.0)), replace(REQUEST, goal="near"))
    assert as_goal.outcome.arrival_s == pytest.approx(near.arrival_s, rel=1e-3)


@pytest.mark.parametrize(
    ("rows", "columns", "reason"),
    [
        (slice(1, 2), slice(1, 2), "the start is in hazard"),
        (slice(14, 15), slice(22, 23), "the goal is in hazard in every"),
        (slice(None), slice(12, 13), "no safe way leads there"),
    ],
)
def test_reasons(rows, columns, reason):
    def storm(north, east):
        east[:, rows, columns] = 30.0

    plan = plan_windaware(wind_of(storm), REQUEST)
    assert not plan.outcome.reachable
    assert plan.outcome.reason.startswith(reason)
    assert plan.waypoints == ()


def test_a_wait_that_cannot_be_flown_is_said():
    def door(north, east):
        east[[0, 3, 4, 5, 6], :, 4] = 40.0  # open from 600 s to 1200 s

    clock = StageClock(0.0, stage_count=6, steps_per_stage=5)
    time_s = np.arange(7) * clock.stage_s
    wind = replace(wind_of(door), time_s=time_s)
    request = replace(REQUEST, clock=clock, goals=(place("behind", 1, 7),), goal="behind", corridor_m=300.0)
    plan = plan_windaware(wind, request)
    assert plan.outcome.arrival_s > 600.0
    assert plan.outcome.waiting_s > 120.0
    never = plan_windaware(wind, replace(request, wait_min_s=2000.0))
    assert "not with waits that can be flown" in never.outcome.reason
    assert never.waypoints == ()


def test_the_goal_at_the_start_is_reached_at_once():
    plan = plan_windaware(wind_of(), replace(REQUEST, goals=(place("here", 1, 1),), goal="here"))
    assert (plan.outcome.arrival_s, plan.outcome.length_m) == (0.0, 0.0)
    assert len(plan.waypoints) == 1


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (2, 2)])
def test_narrow_grids(shape):
    grid = replace(GRID, rows=shape[0], columns=shape[1])
    last = place("last", shape[0] - 1, shape[1] - 1)
    request = replace(REQUEST, start=place("start", 0, 0), goals=(last,), goal="last")
    plan = plan_windaware(wind_of(grid=grid), request, neighbours=16)
    assert plan.outcome.arrival_s == pytest.approx(distance_m(request.start, last) / 27.0, rel=1e-4)


def test_across_the_date_line():
    grid = replace(GRID, west_rad=math.radians(179.8))
    goal = Place("there", 20.2, -179.6)
    request = replace(REQUEST, start=Place("start", 20.0, 179.8), goals=(goal,), goal="there")
    plan = plan_windaware(wind_of(grid=grid), request)
    longitudes = [waypoint.lon_deg for waypoint in plan.waypoints]
    assert longitudes == sorted(longitudes)
    assert longitudes[-1] == pytest.approx(180.4, abs=STEP_DEG)
    assert len(plan.waypoints) == round(plan.outcome.arrival_s / 120.0) + 1


@pytest.mark.slow
def test_a_thousand_goals_at_once():
    goals = tuple(
        place(f"{row}-{column}-{again}", row, column)
        for row in range(ROWS)
        for column in range(COLUMNS)
        for again in range(3)
    )
    wind = wind_of(eye(8, 12, 0.0))
    plan = plan_windaware(wind, replace(REQUEST, goals=goals, goal="14-22-0"))
    assert plan.outcome.arrival_s == plan_windaware(wind, REQUEST).outcome.arrival_s
    outcomes = {outcome.name: outcome for outcome in plan.goals}
    assert len(outcomes) == len(goals)
    assert outcomes["1-1-2"].arrival_s == 0.0
    assert outcomes["5-5-1"].arrival_s == outcomes["5-5-2"].arrival_s


def test_wind_that_leaves_the_slowest_airspeed_no_headway_counts_as_hazard():
    def blow(north, east):
        east -= 21.0

    plan = plan_windaware(wind_of(blow), replace(REQUEST, threshold_mps=25.0))
    assert plan.outcome.reason.startswith("the start is in hazard")


def test_bad_requests():
    with pytest.raises(PlannerError, match="'nowhere'; there are near, far"):
        plan_windaware(wind_of(), replace(REQUEST, goal="nowhere"))
    with pytest.raises(OutsideGridError, match="goal away"):
        plan_windaware(wind_of(), replace(REQUEST, goals=(Place("away", 50.0, 0.0),), goal="away"))
    with pytest.raises(PlannerError, match=r"cruise of 50\.0 m/s does not lie within .* 22\.0 to 39\.0"):
        plan_windaware(wind_of(), replace(REQUEST, cruise_mps=50.0))
