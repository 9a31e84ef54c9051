"""Hazard of several reasons: joined, never less than its parts, and never a help to anyone in a hurry."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.closures import Closures, MemberHazard, chance_of_hazard, joined, widened
from planner.errors import BadFieldError, PlannerError
from planner.grid import Grid
from planner.hazards import StageClock, hazard_stages
from planner.planning import Place, PlanningRequest, StagedMission, plan_staged
from planner.survival import probability_from_forecast
from planner.windaware import plan_windaware, way_search
from planner.windfield import WindField

STEP_DEG = 3600.0 / 111_000.0
GRID = Grid(math.radians(20.0), math.radians(-80.0), math.radians(STEP_DEG), math.radians(STEP_DEG), 8, 12)
CLOCK = StageClock(0.0, stage_count=2)
SHAPE = (2, *GRID.shape)


def place(name, row, column):
    return Place(name, 20.0 + row * STEP_DEG, -80.0 + column * STEP_DEG)


def wind(seed=0, strongest_mps=18.0):
    random = np.random.default_rng(seed)
    north, east = random.uniform(-strongest_mps, strongest_mps, (2, 3, *GRID.shape)) / math.sqrt(2.0)
    return WindField(GRID, np.array([0.0, 3600.0, 7200.0]), north, east)


REQUEST = PlanningRequest(
    start=place("start", 1, 1),
    goals=(place("near", 1, 5), place("far", 6, 10)),
    goal="far",
    altitude_m=800.0,
    clock=CLOCK,
    threshold_mps=15.0,
    corridor_m=300.0,
    airspeed_min_mps=20.0,
    airspeed_max_mps=48.0,
    objective="earliest",
    cruise_mps=30.0,
)


def cells(seed, share=0.15):
    closed = np.random.default_rng(seed).random(SHAPE) < share
    closed[:, 1, 1] = False
    return closed


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_planners_see_both_the_winds_hazard_and_the_closures(seed):
    field, closed = wind(seed), cells(seed + 1)
    request = replace(REQUEST, closures=Closures(closed))
    by_wind = hazard_stages(field, CLOCK, threshold_mps=15.0, corridor_m=300.0)
    np.testing.assert_array_equal(StagedMission.prepare(field, request).problem.hazard, by_wind | closed)
    np.testing.assert_array_equal(way_search(field, request).hazard, by_wind | closed)


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_another_hazard_never_brings_an_arrival_forward(seed):
    field = wind(seed, 12.0)
    some = cells(seed + 1)
    more = some | cells(seed + 2, 0.05)
    # Legs of any course are straightened one after the other, which may miss a second or two.
    for plan, spare in ((plan_staged, 1.0), (plan_windaware, 0.98)):
        found = [
            plan(field, replace(REQUEST, closures=closures))
            for closures in (None, Closures(some), Closures(more))
        ]
        for at in range(len(REQUEST.goals)):
            arrivals = [plan.goals[at].earliest_arrival_s or math.inf for plan in found]
            assert all(later >= spare * earlier for earlier, later in pairwise(arrivals))


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_no_waypoint_is_in_a_closed_cell(seed):
    closed = cells(seed)
    for plan in (plan_staged, plan_windaware):
        made = plan(wind(seed, 10.0), replace(REQUEST, closures=Closures(closed)))
        for point in made.waypoints:
            cell = GRID.nearest_cell(math.radians(point.lat_deg), math.radians(point.lon_deg))
            assert not closed[(CLOCK.stage_at(point.time_s), *cell)]


def test_an_ensemble_alone_tells_a_chance_and_survival_goes_around_it():
    calm = wind(strongest_mps=0.0)
    chance = np.zeros(SHAPE)
    chance[:, 0:4, 6] = 0.4
    request = replace(
        REQUEST, closures=Closures(np.zeros(SHAPE, dtype=bool), chance), goals=(place("far", 1, 10),)
    )
    for plan in (plan_staged, plan_windaware):
        quick, safe = (plan(calm, replace(request, objective=by)) for by in ("earliest", "survival"))
        assert quick.outcome.survival == pytest.approx(0.6, abs=0.1)
        assert safe.outcome.survival == pytest.approx(1.0)
        assert safe.outcome.arrival_s > quick.outcome.arrival_s
        risky = plan(calm, replace(request, abstain_below=0.99))
        assert risky.outcome.abstained
        with pytest.raises(PlannerError, match="ensemble"):
            plan(calm, replace(request, closures=None, objective="survival"))


@given(st.integers(0, 2**32 - 1))
def test_of_two_chances_the_larger_counts(seed):
    random = np.random.default_rng(seed)
    speed, chance = random.uniform(0.0, 30.0, SHAPE), random.random(SHAPE)
    closures = Closures(np.zeros(SHAPE, dtype=bool), chance)

    def asked(error_mps, closures):
        return chance_of_hazard(speed, threshold_mps=15.0, error_mps=error_mps, closures=closures)

    by_error = probability_from_forecast(speed, threshold_mps=15.0, error_mps=3.0)
    np.testing.assert_array_equal(asked(3.0, closures), np.maximum(by_error, chance))
    np.testing.assert_array_equal(asked(3.0, None), by_error)
    np.testing.assert_array_equal(asked(0.0, closures), chance)
    assert asked(0.0, None) is None
    assert asked(0.0, Closures(closures.closed)) is None


@pytest.mark.parametrize("corridor_m", [0.0, 1100.0, 1790.0, 2200.0, 3500.0])
def test_a_corridor_wider_than_half_a_cell_reaches_the_neighbours(corridor_m):
    closed = cells(5, 0.05)
    wide = widened(closed, GRID, corridor_m)
    expected = np.zeros_like(closed)
    for stage, row, column in np.argwhere(closed):
        for r in range(GRID.rows):
            near_row = r == row or (abs(r - row) == 1 and corridor_m > GRID.north_cell_m[r] / 2.0)
            for c in (column - 1, column, column + 1):
                near = c == column or corridor_m > GRID.east_cell_m[r] / 2.0
                if 0 <= c < GRID.columns and near_row and near:
                    expected[stage, r, c] = True
    np.testing.assert_array_equal(wide, expected)
    assert (wide.sum() > closed.sum()) == (corridor_m > 1700.0)


@pytest.mark.parametrize(
    ("closed", "chance", "message"),
    [
        (np.zeros((2, 3)), None, "give booleans"),
        (np.zeros((2, 3, 4)), None, "type float64"),
        (np.zeros((2, 3, 4), dtype=bool), np.zeros((2, 3, 5)), r"does not fit closures of \(2, 3, 4\)"),
        (np.zeros((2, 3, 4), dtype=bool), np.full((2, 3, 4), 1.5), "between 0 and 1"),
        (np.zeros((2, 3, 4), dtype=bool), np.full((2, 3, 4), np.nan), "between 0 and 1"),
    ],
)
def test_closures_that_make_no_sense_are_refused(closed, chance, message):
    with pytest.raises(BadFieldError, match=message):
        Closures(closed, chance)


def test_closures_of_another_grid_are_refused():
    with pytest.raises(BadFieldError, match="do not fit hazard of"):
        joined(np.zeros(SHAPE, dtype=bool), Closures(np.zeros((3, *GRID.shape), dtype=bool)))


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_members_that_a_route_survives_are_counted(seed, count):
    random = np.random.default_rng(seed)
    members = random.random((9, *SHAPE)) < 0.02
    packed = MemberHazard.packed(members)
    visited = [
        (int(stage), (int(row), int(column)))
        for stage, row, column in zip(
            random.integers(0, 2, count),
            random.integers(0, 8, count),
            random.integers(0, 12, count),
            strict=True,
        )
    ]
    expected = sum(not any(member[stage][cell] for stage, cell in visited) for member in members)
    assert packed.survivors(visited) == expected
    assert packed.bits.nbytes < members.nbytes / 4


def test_plans_say_how_many_members_they_survive_and_abstain_by_them():
    calm = wind(strongest_mps=0.0)
    members = np.zeros((10, *SHAPE), dtype=bool)
    members[:4, :, :, 6] = True  # a wall in four of ten
    closures = Closures(np.zeros(SHAPE, dtype=bool), members.mean(axis=0), MemberHazard.packed(members))
    request = replace(REQUEST, closures=closures, goals=(place("far", 1, 10),))
    for plan in (plan_staged, plan_windaware):
        outcome = plan(calm, request).outcome
        assert (outcome.members_survived, outcome.members) == (6, 10)
        assert not plan(calm, replace(request, abstain_below=0.6)).outcome.abstained
        assert plan(calm, replace(request, abstain_below=0.61)).outcome.abstained
