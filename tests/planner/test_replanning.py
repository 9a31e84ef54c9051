"""A plan under way against new forecasts: what is trouble, what is better, what is done instead."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.closures import Closures
from planner.grid import Grid
from planner.ground import Cell, Ground
from planner.hazards import StageClock
from planner.place import Place
from planner.planning import PlanningRequest, StagedMission
from planner.refuge import stay
from planner.replanning import StagedOptions, StagedProspect, Trouble, UnderWay, cells_by_step, trouble
from planner.revision import Purpose, Revision, choose, leave, same_ahead
from planner.windfield import WindField

CLOCK = StageClock(1664409600.0, stage_count=4, steps_per_stage=5, step_s=120.0)
GRID = Grid.covering(*np.radians([29.0, 29.32, -90.0, -89.63]).tolist(), rows=11, columns=11)
GALE_MPS = 20.0


def place(name: str, row: int, column: int) -> Place:
    lat_rad, lon_rad = GRID.south_rad + row * GRID.north_step_rad, GRID.west_rad + column * GRID.east_step_rad
    return Place(name, *np.degrees([lat_rad, lon_rad]).tolist())


HERE, THERE, BESIDE = place("Here", 5, 0), place("There", 5, 10), place("Beside", 8, 2)


def mission(
    *gales: tuple[int, slice, slice],
    objective: str = "earliest",
    gale_mps: float = GALE_MPS,
    **changes: Any,
) -> StagedMission:
    """Still air but for cells in a gale from a stage on."""
    east = np.zeros((CLOCK.stage_count + 1, *GRID.shape))
    for stage, rows, columns in gales:
        east[stage + 1 :, rows, columns] = gale_mps
    time_s = CLOCK.departure_s + CLOCK.stage_s * np.arange(len(east))
    request = PlanningRequest(
        start=HERE,
        goals=(THERE, BESIDE, HERE),
        goal="There",
        altitude_m=1000.0,
        clock=CLOCK,
        threshold_mps=15.0,
        corridor_m=0.0,
        airspeed_min_mps=15.0,
        airspeed_max_mps=40.0,
        objective=objective,
        **changes,
    )
    return StagedMission.prepare(WindField(GRID, time_s, np.zeros_like(east), east), request)


EVERYWHERE = slice(None)
STRAIGHT: tuple[Cell, ...] = tuple((5, column) for column in range(11))
BARRIER = (0, EVERYWHERE, slice(7, 8))


def under_way(step: int, cells: tuple[Cell, ...] = STRAIGHT) -> UnderWay:
    return UnderWay(step, cells[step:])


def at(found: StagedMission, old: UnderWay) -> StagedMission:
    return replace(found, start=old.cells[0])


def decide(
    found: StagedMission, old: UnderWay, first: Purpose = Purpose.WAIT, purpose: Purpose = Purpose.GOAL
) -> Revision:
    return choose(StagedOptions(at(found, old), old, needed_until=12), purpose, first, "Here")


def same_forecast(old: StagedMission, new: StagedMission, first_step: int) -> bool:
    return same_ahead(StagedProspect(old), StagedProspect(new), first_step * CLOCK.step_s)


def test_a_plan_that_can_still_be_flown_and_is_best_is_kept() -> None:
    for objective in ("earliest", "score"):
        revision = decide(mission(objective=objective), under_way(3))
        assert (revision.plan, revision.reason) == (None, "unchanged")


def test_a_plan_that_runs_into_hazard_gives_way_to_one_that_does_not() -> None:
    revision = decide(mission((0, slice(0, 8), slice(7, 8))), under_way(3))
    assert revision.purpose is Purpose.GOAL
    assert revision.plan is not None
    cells = cells_by_step(revision.plan.waypoints, GRID, CLOCK.step_s)
    assert cells[0] == (5, 3)
    assert cells[-1] == (5, 10)
    assert revision.reason == "the old plan ran into hazard at 00:14 UTC; a new one arrives at 00:32 UTC"
    assert round(revision.plan.duration_s / CLOCK.step_s) == len(cells) - 1 == 16 - 3


def test_a_better_plan_is_told_with_by_how_much() -> None:
    round_about = ((5, 3), (6, 3), (7, 3), *((7, column) for column in range(4, 11)), (6, 10), (5, 10))
    old = UnderWay(3, round_about)
    revision = decide(mission(), old)
    assert revision.plan is not None
    assert revision.reason == "a better one, 8 min earlier"
    scored = decide(mission(objective="score"), old)
    assert scored.plan is not None
    assert scored.reason.startswith("a better one, 8 min earlier, score ")


def test_by_survival_the_safer_plan_is_the_better_one() -> None:
    near_gale = 0, slice(5, 6), slice(4, 8)
    risky = mission(near_gale, gale_mps=13.0, objective="survival", forecast_error_mps=3.0)
    old = under_way(3)
    revision = decide(risky, old)
    assert revision.plan is not None
    assert revision.reason == "a better one, survival 1 instead of 0.312"
    again = UnderWay(3, cells_by_step(revision.plan.waypoints, GRID, CLOCK.step_s))
    assert decide(risky, again).plan is None


@pytest.mark.parametrize(
    ("first", "told"),
    [
        (Purpose.ALTERNATE, "diverted to Beside"),
        (Purpose.RETURN, "back to Here"),
        (Purpose.WAIT, "waiting where it is safe"),
    ],
)
def test_what_is_done_where_no_route_is_left(first: Purpose, told: str) -> None:
    revision = decide(mission(BARRIER), under_way(3), first)
    assert revision.purpose is first
    assert revision.plan is not None
    assert revision.reason.startswith("the old plan ran into hazard at 00:14 UTC; no route to There (")
    assert revision.reason.endswith(told)
    assert revision.plan.goal == {"ALTERNATE": "Beside", "RETURN": "Here", "WAIT": "There"}[first.name]
    assert revision.plan.outcome.reachable == (first is not Purpose.WAIT)
    cells = cells_by_step(revision.plan.waypoints, GRID, CLOCK.step_s)
    assert trouble(mission(BARRIER).problem.ground, cells, 3) is None
    if first is Purpose.WAIT:
        assert cells == ((5, 3),) * (CLOCK.step_count - 3)
    kept = UnderWay(4, cells[1:])
    still = decide(mission(BARRIER), kept, first, first)
    assert still.plan is None
    assert still.reason.startswith("unchanged: still no route to There")
    opened = decide(mission(), kept, first, first)
    assert (opened.purpose, opened.reason) == (Purpose.GOAL, "a way to There has opened")


def test_where_one_thing_cannot_be_done_the_next_is() -> None:
    shut_in = (0, slice(6, 7), EVERYWHERE), (0, EVERYWHERE, slice(1, 2)), BARRIER
    revision = decide(mission(*shut_in), under_way(3), Purpose.ALTERNATE)
    assert revision.purpose is Purpose.WAIT
    later = (1, slice(4, 7), slice(2, 7))  # no place there to wait beyond the first stage
    doomed = decide(mission(*shut_in, later, (1, EVERYWHERE, EVERYWHERE)), under_way(3), Purpose.ALTERNATE)
    assert doomed.plan is None
    assert doomed.reason.endswith("no way out is known, the old plan is kept")


def test_too_high_a_risk_is_no_reason_to_leave_a_plan_that_is_safe_by_the_forecast() -> None:
    risky = mission((0, slice(0, 8), slice(0, 11)), objective="survival", forecast_error_mps=6.0)
    calm = mission(objective="survival", forecast_error_mps=9.0, abstain_below=0.999)
    revision = decide(calm, under_way(3))
    assert revision.plan is None
    assert revision.reason == "unchanged, though the risk is too high"
    assert trouble(risky.problem.ground, STRAIGHT[3:], 3) == Trouble(3, hazard=True)


def closed_for(*where: tuple[int, slice, slice]) -> StagedMission:
    """Calm, with cells closed from a stage on."""
    closed = np.zeros((CLOCK.stage_count, *GRID.shape), dtype=np.bool_)
    for stage, rows, columns in where:
        closed[stage:, rows, columns] = True
    return mission(closures=Closures(closed))


AROUND = (0, slice(3, 8), slice(2, 5))  # the place where it is in the following


def overrun(found: StagedMission, old: UnderWay, first: Purpose, purpose: Purpose) -> Revision | None:
    options = StagedOptions(at(found, old), old, needed_until=12)
    assert options.in_hazard
    return leave(options, purpose, first, "Here")


def flown(revision: Revision, found: StagedMission, old: UnderWay) -> tuple[Cell, ...]:
    """The cells of a plan that begins in hazard: those out of it, and from there on a safe way."""
    assert revision.plan is not None
    cells = cells_by_step(revision.plan.waypoints, GRID, CLOCK.step_s)
    ground = found.problem.ground
    assert cells[0] == old.cells[0]
    outside = next(
        at
        for at, cell in enumerate(cells)
        if not ground.hazard[CLOCK.stage_of_step(old.first_step + at)][cell]
    )
    assert trouble(ground, cells[outside:], old.first_step + outside) is None
    assert all(abs(a[0] - b[0]) + abs(a[1] - b[1]) <= 1 for a, b in pairwise(cells))
    return cells


def test_a_place_that_hazard_overruns_is_left_the_nearest_way_and_planned_on_from_to_the_goal() -> None:
    found, old = closed_for(AROUND), UnderWay(3, ((5, 3),) * 15)
    revision = overrun(found, old, Purpose.WAIT, Purpose.WAIT)
    assert revision is not None
    assert flown(revision, found, old) == STRAIGHT[3:]
    assert revision.purpose is Purpose.GOAL
    assert revision.reason == (
        "the way ahead is in hazard: leaves it toward the east, 7 km, then on to There, arriving at 00:20 UTC"
    )
    assert revision.plan is not None
    outcome = revision.plan.outcome
    assert outcome.arrival_s == outcome.earliest_arrival_s == revision.plan.duration_s == 7 * CLOCK.step_s
    assert outcome.length_m == pytest.approx(7 * float(GRID.east_cell_m[5]), rel=1e-3)
    assert revision.plan.departure_s == CLOCK.departure_s + 3 * CLOCK.step_s


@pytest.mark.parametrize(
    ("first", "told", "end"),
    [
        (Purpose.ALTERNATE, "diverted to Beside", (8, 2)),
        (Purpose.RETURN, "back to Here", (5, 0)),
        (Purpose.WAIT, "waiting where it is safe", (5, 5)),
    ],
)
def test_where_the_goal_is_out_of_reach_it_goes_elsewhere_from_there(
    first: Purpose, told: str, end: Cell
) -> None:
    found, old = closed_for(AROUND, BARRIER), UnderWay(3, ((5, 3),) * 15)
    revision = overrun(found, old, first, Purpose.WAIT)
    assert revision is not None
    cells = flown(revision, found, old)
    assert (cells[:3], cells[-1]) == (((5, 3), (5, 4), (5, 5)), end)
    assert revision.purpose is first
    assert revision.reason == (
        f"the way ahead is in hazard: leaves it toward the east, 7 km, then {told}: no route to There "
        "(no safe way leads there within the horizon)"
    )
    if first is Purpose.WAIT:
        assert 3 + len(cells) == CLOCK.step_count


def test_where_hazard_has_no_way_out_there_is_nothing_to_do() -> None:
    old = UnderWay(3, ((5, 3),) * 15)
    assert overrun(closed_for((0, EVERYWHERE, EVERYWHERE)), old, Purpose.WAIT, Purpose.WAIT) is None


def test_hazard_that_passes_is_waited_for_where_it_is() -> None:
    closed = np.zeros((CLOCK.stage_count, *GRID.shape), dtype=np.bool_)
    closed[0] = True
    found, old = mission(closures=Closures(closed)), UnderWay(3, ((5, 3),) * 15)
    revision = overrun(found, old, Purpose.WAIT, Purpose.WAIT)
    assert revision is not None
    assert revision.reason.startswith(
        "the way ahead is in hazard: waits there until it has passed, then on to There"
    )
    assert flown(revision, found, old)[:3] == ((5, 3),) * 3


def test_an_old_plan_that_is_out_of_hazard_as_soon_is_kept() -> None:
    found, old = closed_for(AROUND), under_way(3)
    kept = overrun(found, old, Purpose.WAIT, Purpose.GOAL)
    assert kept is not None
    assert kept.plan is None
    assert kept.reason == "the way ahead is in hazard, and the old plan leaves it the nearest way"
    slower = UnderWay(3, ((5, 3), *STRAIGHT[3:]))
    changed = overrun(found, slower, Purpose.WAIT, Purpose.GOAL)
    assert changed is not None
    assert changed.plan is not None
    again = overrun(closed_for(AROUND, (0, EVERYWHERE, slice(8, 9))), old, Purpose.WAIT, Purpose.GOAL)
    assert again is not None
    assert again.plan is not None  # further on it is in hazard once more


def test_trouble_is_hazard_wind_or_the_end_of_the_forecast() -> None:
    clear = mission().problem.ground
    assert trouble(clear, STRAIGHT, 0) is None
    assert trouble(clear, STRAIGHT, 12) == Trouble(CLOCK.step_count, hazard=False)
    gale = mission((0, slice(5, 6), slice(4, 5))).problem.ground
    assert trouble(gale, STRAIGHT, 0) == Trouble(4, hazard=True)
    assert clear.flyable is not None
    becalmed = replace(clear, flyable=np.zeros_like(clear.flyable))
    assert trouble(becalmed, STRAIGHT, 0) == Trouble(1, hazard=False)


def test_forecasts_are_the_same_if_they_are_from_now_on() -> None:
    calm, late = mission(), mission((2, slice(0, 2), slice(0, 2)))
    assert same_forecast(calm, mission(), 0)
    assert not same_forecast(calm, late, 12)
    early = replace(late, problem=replace(late.problem, hazard=late.problem.hazard.copy()))
    early.problem.hazard[0, 9, 9] = True
    assert same_forecast(late, early, 5)
    assert not same_forecast(late, early, 4)
    unsure = mission(forecast_error_mps=2.0)
    assert not same_forecast(calm, unsure, 0)
    assert same_forecast(unsure, mission(forecast_error_mps=2.0), 0)


def test_a_plan_is_read_as_a_cell_a_step_with_its_waits() -> None:
    found = replace(mission((0, slice(5, 6), slice(3, 4))), start=(5, 2))
    plan = found.plan(first_step=2)
    assert cells_by_step(plan.waypoints, GRID, CLOCK.step_s)[0] == (5, 2)
    waiting = [replace(plan.waypoints[0], time_s=120.0 * step) for step in (0, 3)]
    onward = replace(plan.waypoints[1], time_s=480.0)
    assert cells_by_step([*waiting, onward], GRID, CLOCK.step_s)[:4] == ((5, 2),) * 4


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 6))
def test_nobody_stays_safe_longer_or_moves_less(seed: int, first_step: int) -> None:
    random = np.random.default_rng(seed)
    clock = StageClock(0.0, stage_count=5, steps_per_stage=3, step_s=120.0)
    hazard = random.random((5, 5, 5)) < random.uniform(0.1, 0.5)
    ground = Ground(hazard, clock)
    cells = stay(ground, (2, 2), first_step=first_step)
    fewest = {(2, 2): 0} if not hazard[clock.stage_of_step(first_step), 2, 2] else {}
    if not fewest:
        assert cells is None
        return
    for step in range(first_step + 1, clock.step_count):  # by hand: where one can be, and with how few moves
        onward: dict[Cell, int] = {}
        for (row, column), moves in fewest.items():
            for north, east in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)):
                there = row + north, column + east
                stages = {clock.stage_of_step(step), clock.stage_of_step(step - 1)}
                if not (0 <= there[0] < 5 and 0 <= there[1] < 5) or any(
                    hazard[stage][cell] for stage in stages for cell in ((row, column), there)
                ):
                    continue
                onward[there] = min(onward.get(there, 99), moves + (there != (row, column)))
        if not onward:
            break
        fewest, last = onward, step
    assert cells is not None
    assert len(cells) - 1 == (last - first_step if len(cells) > 1 else 0)
    assert trouble(ground, cells, first_step) is None
    near = min(abs(row - 2) + abs(column - 2) for row, column in fewest)
    assert abs(cells[-1][0] - 2) + abs(cells[-1][1] - 2) == near
    assert sum(a != b for a, b in pairwise(cells)) == fewest[cells[-1]]
