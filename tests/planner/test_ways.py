"""Each objective against the others on storms: none is beaten at its own measure, none is early or unsafe."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from planner.consumption import FuelFlow
from planner.errors import PlannerError
from planner.grid import Grid
from planner.hazards import StageClock
from planner.legs import are_safe, fly, lay_legs
from planner.planning import Place, PlanningRequest
from planner.score import Weights
from planner.windaware import plan_windaware, way_search
from planner.windfield import WindField

STEP_DEG = 0.0324
ROWS, COLUMNS = 18, 26
GRID = Grid(math.radians(25.0), math.radians(-85.0), *[math.radians(STEP_DEG)] * 2, ROWS, COLUMNS)
FLOW = FuelFlow(
    (20.0, 23.0, 26.0, 29.0, 32.0, 35.0, 38.0), (2.6e-5, 3.2e-5, 4e-5, 5e-5, 6.3e-5, 7.7e-5, 9.4e-5)
)
CLOCK = StageClock(0.0, stage_count=4, steps_per_stage=15)
SEEDS = (1, 2)
OBJECTIVES = ("earliest", "score", "survival", "fuel")


def place(name, row, column):
    return Place(name, 25.0 + row * STEP_DEG, -85.0 + column * STEP_DEG)


REQUEST = PlanningRequest(
    start=place("start", 2, 2),
    goals=(place("far", 15, 23), place("east", 3, 22), place("north", 16, 4)),
    goal="far",
    altitude_m=1000.0,
    clock=CLOCK,
    threshold_mps=15.0,
    corridor_m=1000.0,
    airspeed_min_mps=22.0,
    airspeed_max_mps=38.0,
    cruise_mps=27.0,
    weights=Weights(clearance_cap_cells=8.0),
    forecast_error_mps=2.0,
    fuel_flow=FLOW,
)


def storm(seed):
    """A few eddies that drift, every quarter of an hour, over a breeze."""
    random = np.random.default_rng(seed)
    time_s = np.arange(9) * 900.0
    rows, columns = np.indices(GRID.shape)
    wind = np.full((time_s.size, *GRID.shape), random.normal(0.0, 3.0, 2) @ [1.0, 1.0j])
    for _ in range(3):
        centre = random.uniform([3.0, 5.0], [15.0, 21.0])
        drift = random.normal(0.0, 0.5, 2)
        for at, sheet in enumerate(wind):
            apart = (rows - centre[0] - drift[0] * at) + 1j * (columns - centre[1] - drift[1] * at)
            near = np.abs(apart) / 2.5
            sheet += 20.0 * np.exp(0.5 * (1.0 - near**2)) * 1j * apart / 2.5
    north, east = np.ascontiguousarray(wind.real), np.ascontiguousarray(wind.imag)
    return WindField(GRID, time_s, north, east)


@cache
def planned(seed, objective):
    return plan_windaware(storm(seed), replace(REQUEST, objective=objective))


@pytest.mark.parametrize("seed", SEEDS)
def test_no_objective_is_beaten_by_the_earliest_way_at_its_own_measure(seed):
    soonest, score, survival, fuel = (planned(seed, objective).goals for objective in OBJECTIVES)
    assert any(outcome.reachable for outcome in soonest)
    for at, first in enumerate(soonest):
        others = score[at], survival[at], fuel[at]
        assert all(other.reachable for other in others) or not first.reachable
        if first.reachable:
            assert {other.earliest_arrival_s for other in others} == {first.arrival_s}
            assert min(score[at].arrival_s, survival[at].arrival_s) >= first.arrival_s - 0.3
            assert score[at].score >= first.score
            assert 1.0 >= survival[at].survival >= first.survival >= 0.0
            assert fuel[at].fuel_kg <= first.fuel_kg


def test_the_objectives_differ_where_there_is_something_to_gain():
    soonest, score, survival, fuel = (
        [goal for seed in SEEDS for goal in planned(seed, objective).goals if goal.reachable]
        for objective in OBJECTIVES
    )
    assert sum(goal.score for goal in score) > sum(goal.score for goal in soonest) + 0.5
    assert sum(goal.survival for goal in survival) > sum(goal.survival for goal in soonest) + 0.05
    assert sum(goal.fuel_kg for goal in fuel) < 0.95 * sum(goal.fuel_kg for goal in soonest)


@pytest.mark.parametrize("objective", ["survival", "fuel"])
def test_every_goals_way_is_safe_and_follows_on(objective):
    search = way_search(storm(1), replace(REQUEST, objective=objective))
    country = search.country
    for goal, (way, _) in zip(search.goals, search.ways(), strict=True):
        place_now, now_s = search.start, 0.0
        for leg in way:
            assert leg.start == place_now
            assert leg.leave_s == now_s or leg.leave_s - now_s >= REQUEST.wait_min_s - 1e-6
            assert REQUEST.airspeed_min_mps <= leg.airspeed_mps <= REQUEST.airspeed_max_mps
            laid = lay_legs(country.chart, leg.start, *(np.array([index]) for index in leg.end))
            time_s = fly(country, laid, leg.leave_s, leg.airspeed_mps)
            assert are_safe(country, laid, time_s)[0]
            assert time_s[0, -1] == pytest.approx(leg.arrive_s, abs=0.05)
            place_now, now_s = leg.end, leg.arrive_s
        assert place_now == goal


def calm(east_mps=0.0, gate_until_s=None):
    north, east = np.zeros((2, 9, *GRID.shape))
    east += east_mps
    if gate_until_s is not None:
        east[np.arange(9) * 900.0 < gate_until_s, :, 13] = 40.0
    return WindField(GRID, np.arange(9) * 900.0, north, east)


def outcome(wind, **changes):
    return plan_windaware(
        wind, replace(REQUEST, goals=(place("east", 2, 12),), goal="east", **changes)
    ).outcome


def test_the_measures_of_a_straight_flight_in_calm_air_are_analytic():
    found = outcome(calm(), objective="earliest")
    steps = found.length_m / 27.0 / 120.0
    assert found.arrival_s / 120.0 == pytest.approx(steps, rel=1e-4)
    assert found.fuel_kg == pytest.approx(float(FLOW.at(27.0)) * found.arrival_s)
    search = way_search(calm(), REQUEST)
    moves = found.length_m / search.appraisal.cell_m
    assert found.score == pytest.approx(8.0 + 8.0 - 0.1 * moves - 0.1 * steps, rel=1e-6)
    tail = 0.5 * math.erfc(15.0 / 2.0 / math.sqrt(2.0))
    assert found.survival == pytest.approx((1.0 - tail) ** steps, rel=1e-9)


def test_fuel_is_saved_by_flying_slower_and_against_the_wind_faster():
    slow, still = outcome(calm(), objective="fuel"), outcome(calm(), objective="earliest")
    assert slow.fuel_kg == pytest.approx(float(FLOW.at(22.0)) * slow.length_m / 22.0, rel=1e-3)
    assert slow.fuel_kg < 0.9 * still.fuel_kg
    against = outcome(calm(-14.0), objective="fuel")
    best = min(float(FLOW.at(speed)) / (speed - 14.0) for speed in np.linspace(22.0, 38.0, 200))
    assert against.fuel_kg == pytest.approx(best * against.length_m, rel=0.01)
    assert against.length_m / against.arrival_s > 22.0 - 14.0 + 0.5


def test_fuel_is_saved_by_coming_slowly_to_a_gate():
    request = replace(REQUEST, goals=(place("behind", 2, 15),), goal="behind")
    quick, thrifty = (
        plan_windaware(calm(gate_until_s=3600.0), replace(request, objective=objective)).outcome
        for objective in ("earliest", "fuel")
    )
    assert quick.waiting_s > thrifty.waiting_s > 0.0
    assert thrifty.fuel_kg < 0.9 * quick.fuel_kg


def test_a_plan_below_the_level_asked_for_is_marked():
    assert not planned(1, "survival").outcome.abstained
    assert outcome(calm(12.0), objective="earliest", abstain_below=0.99).abstained


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"objective": "fuel", "fuel_flow": None}, "needs the aircraft's fuel flow"),
        ({"objective": "survival", "forecast_error_mps": 0.0}, r"0\.0 m/s leaves no risk"),
        ({"objective": "best"}, "'best'; there are earliest, score, survival, fuel"),
    ],
)
def test_objectives_without_what_they_need_are_refused(changes, word):
    with pytest.raises(PlannerError, match=word):
        plan_windaware(calm(), replace(REQUEST, **changes))
