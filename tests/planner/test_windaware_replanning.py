"""Wind-aware plans under way against new forecasts: what they meet, what they are worth, what is better."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from planner.air import Chart
from planner.consumption import FuelFlow
from planner.grid import Grid
from planner.hazards import StageClock
from planner.legs import lay_legs
from planner.passage import around, lay_passage, spot_at
from planner.place import Place
from planner.planning import PlanningRequest
from planner.plans import Plan
from planner.revision import Branch, Purpose, Revision, choose, leave, same_ahead
from planner.score import Weights
from planner.track import Track
from planner.windaware import plan_windaware
from planner.windaware_replanning import WindawareOptions, WindawareProspect
from planner.windfield import WindField

STEP_DEG = 0.0324
GRID = Grid(math.radians(25.0), math.radians(-85.0), *[math.radians(STEP_DEG)] * 2, 18, 26)
FLOW = FuelFlow(
    (20.0, 23.0, 26.0, 29.0, 32.0, 35.0, 38.0), (2.6e-5, 3.2e-5, 4e-5, 5e-5, 6.3e-5, 7.7e-5, 9.4e-5)
)
CLOCK = StageClock(0.0, stage_count=5, steps_per_stage=10)
TIME_S = np.arange(13) * 600.0


def place(name: str, row: int, column: int) -> Place:
    return Place(name, 25.0 + row * STEP_DEG, -85.0 + column * STEP_DEG)


REQUEST = PlanningRequest(
    start=place("Here", 2, 2),
    goals=(place("There", 14, 22), place("Beside", 15, 3), place("Here", 2, 2)),
    goal="There",
    altitude_m=1000.0,
    clock=CLOCK,
    threshold_mps=15.0,
    corridor_m=1000.0,
    airspeed_min_mps=22.0,
    airspeed_max_mps=38.0,
    objective="earliest",
    cruise_mps=27.0,
    weights=Weights(clearance_cap_cells=8.0),
    forecast_error_mps=2.0,
    fuel_flow=FLOW,
)


def gales(*where: tuple[int, slice, slice], breeze_mps: complex = 0j) -> WindField:
    """A breeze, but for cells in a gale from the beginning of a stage on."""
    wind = np.full((TIME_S.size, *GRID.shape), breeze_mps)
    for stage, rows, columns in where:
        wind[2 * stage :, rows, columns] = 19.0
    return WindField(GRID, TIME_S.copy(), wind.real.copy(), wind.imag.copy())


def eddies(seed: int) -> WindField:
    """A few that drift, over a breeze."""
    random = np.random.default_rng(seed)
    rows, columns = np.indices(GRID.shape)
    wind = np.full((TIME_S.size, *GRID.shape), random.normal(0.0, 3.0, 2) @ [1.0, 1.0j])
    for _ in range(2):
        centre, drift = random.uniform([1.0, 9.0], [16.0, 17.0]), random.normal(0.0, 0.5, 2)
        for at in range(TIME_S.size):
            up, right = rows - centre[0] - at * drift[0], columns - centre[1] - at * drift[1]
            away = np.hypot(up, right) / 2.5
            wind[at] += 24.0 * away * np.exp(0.5 * (1.0 - away**2)) * 1j * np.exp(1j * np.arctan2(right, up))
    return WindField(GRID, TIME_S.copy(), wind.real.copy(), wind.imag.copy())


@cache
def in_calm(objective: str) -> Plan:
    return planned(gales(), objective=objective)


def prospect(wind: WindField, **changes: Any) -> WindawareProspect:
    return WindawareProspect.of(wind, replace(REQUEST, **changes))


def planned(wind: WindField, **changes: Any) -> Plan:
    return plan_windaware(wind, replace(REQUEST, **changes))


def options(
    found: WindawareProspect, plan: Plan, at: int, late_s: float = 0.0, until_s: float = 2400.0
) -> WindawareOptions:
    made = found.options(Branch(plan, at, plan.waypoints[at].time_s + late_s, False), until_s)
    assert made is not None
    return made


def decide(
    found: WindawareProspect,
    plan: Plan,
    at: int,
    first: Purpose = Purpose.WAIT,
    purpose: Purpose = Purpose.GOAL,
) -> Revision:
    return choose(options(found, plan, at), purpose, first, "Here")


def winds_met(plan: Plan, wind: WindField) -> np.ndarray[Any, Any]:
    """Dense, at the plan's times, by what the field says."""
    points = [np.array([p.time_s, *np.radians([p.lat_deg, p.lon_deg])]) for p in plan.waypoints]
    dense = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(points)])
    north, east, _ = wind.at_many(*dense.T)
    return np.hypot(north, east)


def test_a_passage_between_cell_centres_is_a_leg() -> None:
    chart = Chart.of(GRID)
    for first, last in (
        ((2, 3), (9, 8)),
        ((9, 8), (2, 3)),
        ((4, 1), (4, 7)),
        ((3, 3), (12, 3)),
        ((5, 5), (6, 6)),
    ):
        ours, theirs = (
            lay_passage(chart, first, last),
            lay_legs(chart, first, *(np.array([end]) for end in last)),
        )
        kept = np.append(np.diff(theirs.share[0]) > 1e-12, True)
        for name in ("share", "row", "column", "true_m"):
            np.testing.assert_allclose(
                getattr(ours, name)[0], getattr(theirs, name)[0][kept], atol=1e-5, err_msg=name
            )
        np.testing.assert_allclose(ours.course, theirs.course, atol=1e-9)
        assert ours.length_m.sum() == pytest.approx(theirs.length_m.sum(), rel=1e-9)


@given(st.tuples(*[st.floats(0.0, 17.0), st.floats(0.0, 25.0)] * 2))
def test_a_passage_is_cut_at_every_line_and_straight(ends: tuple[float, float, float, float]) -> None:
    chart, (first, last) = Chart.of(GRID), (ends[:2], ends[2:])
    if math.dist(first, last) < 1e-2:
        return
    laid = lay_passage(chart, first, last)
    for index, a, b in ((laid.row[0], first[0], last[0]), (laid.column[0], first[1], last[1])):
        assert index[0] == pytest.approx(a, abs=1e-4)
        assert index[-1] == pytest.approx(b, abs=1e-4)
        pieces = np.stack([index[:-2:2], index[2::2]])
        assert (np.floor(pieces.max(axis=0) - 1e-4) <= np.ceil(pieces.min(axis=0) + 1e-4)).all()
    north_m = np.interp(laid.row[0], np.arange(GRID.rows), chart.north_m)
    east_m = np.interp(laid.column[0], np.arange(GRID.columns), chart.east_m)
    off_m = np.imag((north_m - north_m[0] + 1j * (east_m - east_m[0])) * laid.course[0].conj())
    assert np.abs(off_m).max() < 0.1


def test_a_place_has_the_cells_around_it_that_its_wind_is_blended_of() -> None:
    chart = Chart.of(GRID)
    assert around((3.0, 4.0)) == [(3, 4)]
    assert around((3.0, 4.5)) == [(3, 4), (3, 5)]
    assert around((3.25, 4.5)) == [(3, 4), (3, 5), (4, 4), (4, 5)]
    assert spot_at(chart, GRID, 25.0 + 7 * STEP_DEG, -85.0 + 11 * STEP_DEG) == (7.0, 11.0)


@pytest.mark.parametrize("objective", ["earliest", "score", "survival", "fuel"])
def test_a_plan_has_no_trouble_in_its_own_forecast_and_the_worth_that_was_planned(objective: str) -> None:
    wind = eddies(1)
    plan, found = planned(wind, objective=objective), prospect(wind, objective=objective)
    whole = Track(found.search, wind, plan.waypoints)
    said = {
        "earliest": -plan.duration_s,
        "score": plan.outcome.score,
        "survival": math.log(plan.outcome.survival or 1.0),
        "fuel": -(plan.outcome.fuel_kg or 0.0),
    }
    assert whole.worth(objective) == pytest.approx(said[objective], rel=0.02, abs=0.04)
    for at in range(1, len(plan.waypoints) - 1):
        assert options(found, plan, at).trouble() == ""
    if objective != "score":  # whose mean clearance counts from here on, so that other ways may be better
        assert decide(found, plan, 5).reason == "unchanged"


def test_wind_that_a_schedule_cannot_be_flown_in_is_trouble() -> None:
    plan = in_calm("earliest")
    against = prospect(gales(breeze_mps=-12.0 - 8.0j))
    assert options(against, plan, 3).trouble().startswith("into wind that it cannot be flown in at 00:")
    revision = decide(against, plan, 3)
    assert revision.plan is not None
    assert "; a new one arrives at 0" in revision.reason


BARRIER = (1, slice(None), slice(14, 15))
ROUND = (1, slice(0, 15), slice(14, 15))


@pytest.mark.parametrize(
    ("objective", "at"), [("earliest", 3), ("earliest", 6), ("score", 4), ("survival", 5), ("fuel", 6)]
)
def test_a_plan_that_runs_into_hazard_gives_way_from_where_and_when_it_is_left(
    objective: str, at: int
) -> None:
    plan, truth = in_calm(objective), gales(ROUND)
    found = prospect(truth, objective=objective)
    revision = decide(found, plan, at)
    assert revision.purpose is Purpose.GOAL
    assert revision.reason.startswith("the old plan ran into hazard at 00:")
    new = revision.plan
    assert new is not None
    assert new.waypoints[0] == plan.waypoints[at]
    assert new.outcome.arrival_s == new.duration_s > plan.duration_s
    assert winds_met(plan, truth).max() > 15.0
    assert winds_met(new, truth).max() < 15.0
    assert Track(found.search, truth, new.waypoints).trouble() is None
    assert decide(found, new, 2).reason == "unchanged"


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), late_s=st.floats(0.0, 90.0))
def test_from_anywhere_and_at_any_time_a_new_plan_is_safe_and_not_worse(seed: int, late_s: float) -> None:
    wind = eddies(seed)
    plan, found = planned(wind), prospect(wind)
    assume(len(plan.waypoints) > 4)
    at = seed % (len(plan.waypoints) - 3) + 1
    made = options(found, plan, at, late_s)
    new = made.plan("There")
    assert made.begin_s == pytest.approx(plan.waypoints[at].time_s + late_s)
    if new.waypoints:
        assert (new.waypoints[0].lat_deg, new.waypoints[0].time_s) == (
            plan.waypoints[at].lat_deg,
            made.begin_s,
        )
        assert all(a.time_s <= b.time_s for a, b in pairwise(new.waypoints))
        assert winds_met(new, wind).max() < 15.0
    if late_s == 0.0 and new.waypoints:
        assert new.duration_s < plan.duration_s + 120.0  # the passage to a cell's centre is no way at all


def test_a_wait_is_left_as_soon_as_a_way_opens() -> None:
    shut, plan = gales((0, slice(None), slice(14, 15))), in_calm("earliest")
    waits = decide(prospect(shut), plan, 4)
    assert (waits.purpose, waits.reason[-26:]) == (Purpose.WAIT, ", waiting where it is safe")
    assert waits.plan is not None
    *_, begin, end = waits.plan.waypoints
    assert (begin.lat_deg, begin.lon_deg) == (end.lat_deg, end.lon_deg)
    assert end.time_s == CLOCK.step_count * CLOCK.step_s - CLOCK.step_s
    found, last = prospect(gales()), len(waits.plan.waypoints) - 1
    branch = Branch(waits.plan, last, 2000.3, True)
    opened = found.options(branch, 2400.0)
    assert opened is not None
    revision = choose(opened, Purpose.WAIT, Purpose.WAIT, "Here")
    assert revision.reason == "a way to There has opened"
    assert revision.plan is not None
    assert revision.plan.waypoints[0] == replace(end, time_s=2000.3, stage=1)
    assert found.options(branch._replace(from_s=end.time_s + 1.0), 2400.0) is None
    still = prospect(shut).options(branch, 2400.0)
    assert still is not None
    assert choose(still, Purpose.WAIT, Purpose.WAIT, "Here").reason.startswith(
        "unchanged: still no route to There"
    )


@pytest.mark.parametrize(
    ("first", "told", "goal"),
    [
        (Purpose.ALTERNATE, "diverted to Beside", "Beside"),
        (Purpose.RETURN, "back to Here", "Here"),
        (Purpose.WAIT, "waiting where it is safe", "There"),
    ],
)
def test_what_is_done_where_no_route_is_left(first: Purpose, told: str, goal: str) -> None:
    plan, truth = in_calm("earliest"), gales(BARRIER)
    revision = decide(prospect(truth), plan, 4, first)
    assert revision.purpose is first
    assert revision.reason.startswith("the old plan ran into hazard at 00:")
    assert revision.reason.endswith(told)
    assert revision.plan is not None
    assert revision.plan.goal == goal
    assert revision.plan.waypoints[0] == plan.waypoints[4]
    assert winds_met(revision.plan, truth).max() < 15.0


def test_where_nothing_is_safe_the_old_plan_is_kept() -> None:
    plan = in_calm("earliest")
    made = options(prospect(gales((1, slice(None), slice(None)))), plan, 8)
    assert made.in_hazard
    revision = choose(made, Purpose.GOAL, Purpose.ALTERNATE, "Here")
    assert revision.plan is None
    assert revision.reason.endswith("no way out is known, the old plan is kept")
    assert leave(made, Purpose.GOAL, Purpose.ALTERNATE, "Here") is None


OVERRUN = (0, slice(2, 14), slice(4, 13))


@pytest.mark.parametrize(
    ("shut", "first", "told", "goal"),
    [
        (False, Purpose.WAIT, "on to There, arriving at 0", "There"),
        (True, Purpose.ALTERNATE, "diverted to Beside: no route to There (", "Beside"),
        (True, Purpose.RETURN, "back to Here: no route to There (", "Here"),
        (True, Purpose.WAIT, "waiting where it is safe: no route to There (", "There"),
    ],
)
@pytest.mark.parametrize("at", [3, 5])
def test_a_place_that_hazard_overruns_is_left_and_planned_on_from(
    shut: bool, first: Purpose, told: str, goal: str, at: int
) -> None:
    truth, plan = gales(OVERRUN, *[(0, slice(None), slice(16, 17))] * shut), in_calm("earliest")
    found = prospect(truth)
    made = options(found, plan, at)
    assert made.in_hazard
    revision = leave(made, Purpose.WAIT, first, "Here")
    assert revision is not None
    assert revision.reason.startswith("the way ahead is in hazard: leaves it toward the ")
    assert f" km, then {told}" in revision.reason
    new = revision.plan
    assert new is not None
    assert (new.goal, new.waypoints[0]) == (goal, plan.waypoints[at])
    assert all(a.time_s < b.time_s for a, b in pairwise(new.waypoints))
    rest = next(
        rest
        for rest in (new.waypoints[index:] for index in range(len(new.waypoints)))
        if Track(found.search, truth, rest).trouble() is None
    )
    out_s = rest[0].time_s - new.waypoints[0].time_s
    assert out_s < 4.0 * 3600.0 / 22.0  # three cells and a passage at the most
    assert winds_met(replace(new, waypoints=rest), truth).max() < 15.0
    if new.outcome.reachable:
        assert new.outcome.arrival_s == new.duration_s


def test_a_plan_that_is_out_of_hazard_as_soon_is_kept() -> None:
    plan, at = in_calm("earliest"), 5
    found = prospect(gales(OVERRUN))
    leaving = leave(options(found, plan, at), Purpose.WAIT, Purpose.WAIT, "Here")
    assert leaving is not None
    assert leaving.plan is not None
    kept = leave(options(found, leaving.plan, 0), Purpose.GOAL, Purpose.WAIT, "Here")
    assert kept is not None
    assert kept.plan is None
    assert kept.reason == "the way ahead is in hazard, and the old plan leaves it the nearest way"


def test_a_plan_is_kept_unless_the_new_one_is_better_by_more_than_a_trifle() -> None:
    round_about = planned(gales(ROUND))
    revision = decide(prospect(gales()), round_about, 3)
    assert revision.plan is not None
    assert revision.reason.startswith("a better one, ")
    assert revision.reason.endswith(" min earlier")
    assert decide(prospect(gales(breeze_mps=0.05 + 0j)), in_calm("earliest"), 3).reason == "unchanged"


def test_forecasts_are_the_same_if_they_are_from_now_on() -> None:
    calm, again = prospect(gales()), prospect(gales())
    late = prospect(gales((3, slice(0, 2), slice(0, 2))))
    windier = prospect(gales(breeze_mps=1.0 + 0j))
    assert same_ahead(calm, again, 0.0)
    assert not same_ahead(calm, late, 1300.0)
    assert not same_ahead(calm, windier, 0.0)
    assert not same_ahead(calm, prospect(gales(), forecast_error_mps=3.0), 0.0)
    early = gales()
    changed = early.north_mps.copy()
    changed[0] = 3.0
    assert same_ahead(calm, prospect(replace(early, north_mps=changed)), 1300.0)
