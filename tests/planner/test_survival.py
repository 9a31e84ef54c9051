"""Survival against the enumeration of every route, and probabilities from members and forecasts."""

import math

import numpy as np
import pytest

from planner.errors import BadFieldError
from planner.ground import Ground
from planner.hazards import StageClock
from planner.score import Weights
from planner.survival import (
    Survival,
    probability_from_forecast,
    probability_from_members,
    search_survival,
    survival_by_departure,
    survival_of,
)


@pytest.mark.parametrize("block", range(5))
def test_is_the_safest_of_every_route(block, small_world, enumeration):
    for seed in range(block * 40, block * 40 + 40):
        ground, start, goal = small_world(seed)
        random = np.random.default_rng(seed)
        p = random.choice([0.0, 0.1, 0.5, 0.9, 1.0], ground.hazard.shape, p=[0.3, 0.3, 0.2, 0.15, 0.05])
        closed = Ground(ground.hazard | (p == 1.0), ground.clock, ground.occupancy)
        best = {}
        for cells in enumeration.every_route(closed, start):
            if cells[-1] == goal:
                stages = [ground.clock.stage_of_step(step) for step in range(len(cells))]
                chance = math.prod(1.0 - p[(stage, *c)] for stage, c in zip(stages, cells, strict=True))
                best[len(cells) - 1] = max(chance, best.get(len(cells) - 1, 0.0))
        (found,) = search_survival(p, ground, start, [goal])
        assert bool(found.cells) == bool(best)
        if found.cells:
            assert found.chance.at_least == pytest.approx(max(best.values()), rel=1e-9)
            assert best[found.arrival_step] == pytest.approx(found.chance.at_least, rel=1e-9)


def test_goes_around_what_is_likely_and_counts_the_members():
    members = np.zeros((4, 1, 3, 5), dtype=bool)
    members[:3, 0, 0, 2] = True  # on the straight way
    members[:1, 0, 1, 2] = True
    p = probability_from_members(members, blur_cells=0.0)
    assert p[0, 0, 2] == pytest.approx(0.75)
    ground = Ground(np.zeros((1, 3, 5), dtype=bool), StageClock(0.0, 1, 9))
    (found,) = search_survival(p, ground, (0, 0), [(0, 4)], members=members)
    assert found.chance == Survival(pytest.approx(1.0), pytest.approx(1.0), 4, 4)
    assert (2, 2) in found.cells
    short = Ground(np.zeros((1, 3, 5), dtype=bool), StageClock(0.0, 1, 7))
    (hasty,) = search_survival(p, short, (0, 0), [(0, 4)], members=members, abstain_below=0.8)
    assert (hasty.chance.at_least, hasty.chance.members_survived, hasty.abstained) == (
        pytest.approx(0.75),
        3,
        True,
    )
    assert (1, 2) in hasty.cells
    (bold,) = search_survival(p, short, (0, 0), [(0, 4)], members=members, abstain_below=0.75)
    assert not bold.abstained


def test_of_equally_safe_arrivals_the_earliest_with_fewest_moves():
    ground = Ground(np.zeros((1, 3, 5), dtype=bool), StageClock(0.0, 1, 20))
    (found,) = search_survival(np.zeros((1, 3, 5)), ground, (0, 0), [(2, 4)])
    assert (found.arrival_step, found.chance.at_least) == (6, 1.0)


def test_a_route_survives_between_its_product_and_its_worst_step():
    p = np.zeros((2, 1, 3))
    p[0, 0, 1], p[1, 0, 1], p[1, 0, 2] = 0.2, 0.5, 0.1
    clock = StageClock(0.0, 2, 2)
    chance = survival_of([(0, 1), (0, 1), (0, 2)], 1, p, clock)
    assert chance == Survival(pytest.approx(0.8 * 0.5 * 0.9), pytest.approx(0.5))


def test_the_safest_so_far_grows_from_stage_to_stage(small_world):
    improved = 0
    for seed in range(40):
        ground, start, goal = small_world(seed, steps=9)
        p = np.random.default_rng(seed).random(ground.hazard.shape) * 0.5
        (found,) = search_survival(p, ground, start, [goal], by_stage=True)
        if not found.cells:
            assert found.by_stage == ()
            continue
        assert len(found.by_stage) == ground.clock.stage_count
        assert found.by_stage[-1] == found.cells
        chances = []
        for stage, cells in enumerate(found.by_stage):
            assert len(cells) <= (stage + 1) * ground.clock.steps_per_stage
            chances.append(survival_of(cells, 0, p, ground.clock).at_least if cells else 0.0)
        assert chances == sorted(chances)
        improved += len(set(chances)) > 1
        route, ends = found.evaluated(p, ground.clock, Weights())
        assert route.cells == found.cells
        assert [end.best.cells if end.best else () for end in ends] == list(found.by_stage)
    assert improved > 3


def test_blur_spreads_and_keeps_probabilities():
    members = np.zeros((1, 2, 21, 21), dtype=bool)
    members[0, 0, 10, 10] = True
    p = probability_from_members(members, blur_cells=2.0)
    assert p[0, 10, 12] > p[0, 10, 14] > 0.0
    assert p[0].sum() == pytest.approx(1.0, abs=1e-3)
    assert not p[1].any()  # stages are not blurred into one another


def test_a_forecast_with_an_error_gives_the_normal_tail():
    p = probability_from_forecast(np.array([[[15.0, 11.0, 40.0]]]), threshold_mps=15.0, error_mps=4.0)
    assert p[0, 0] == pytest.approx([0.5, 0.158655, 1.0], abs=1e-6)


def test_bad_input():
    ground = Ground(np.zeros((1, 2, 2), dtype=bool), StageClock(0.0, 1, 3))
    with pytest.raises(BadFieldError, match="between 0 and 1"):
        search_survival(np.full((1, 2, 2), np.nan), ground, (0, 0), [(1, 1)])
    with pytest.raises(BadFieldError, match="do not fit"):
        search_survival(np.zeros((2, 2, 2)), ground, (0, 0), [(1, 1)])
    with pytest.raises(BadFieldError, match="abstain"):
        search_survival(np.zeros((1, 2, 2)), ground, (0, 0), [(1, 1)], abstain_below=2.0)
    with pytest.raises(BadFieldError, match="blur"):
        probability_from_members(np.zeros((1, 1, 2, 2), dtype=bool), blur_cells=math.nan)
    with pytest.raises(BadFieldError, match="member"):
        probability_from_members(np.zeros((1, 2, 2), dtype=bool))
    with pytest.raises(BadFieldError, match="error of 0"):
        probability_from_forecast(np.zeros((1, 2, 2)), threshold_mps=15.0, error_mps=0.0)


def test_a_start_certain_to_be_in_hazard_has_no_route():
    p = np.zeros((1, 1, 2))
    p[0, 0, 0] = 1.0
    ground = Ground(np.zeros((1, 1, 2), dtype=bool), StageClock(0.0, 1, 3))
    (found,) = search_survival(p, ground, (0, 0), [(0, 1)])
    assert (found.cells, found.arrival_step, found.abstained) == ((), None, True)


def test_each_departure_has_the_survival_of_its_own_search(small_world):
    reached = 0
    for seed in range(30):
        ground, start, goal = small_world(seed)
        p = np.random.default_rng(seed).random(ground.hazard.shape) * 0.5
        slots = range(ground.clock.step_count)
        goals = [goal, start]
        table = survival_by_departure(p, ground, start, goals, slots)
        reached += int((table.survival > 0.0).sum())
        for slot, row, arrivals in zip(slots, table.survival, table.arrival_step, strict=True):
            found = search_survival(p, ground, start, goals, first_step=slot)
            assert row == pytest.approx(
                [entry.chance.at_least if entry.chance else 0.0 for entry in found], abs=1e-9
            )
            steps = [entry.arrival_step for entry in found]
            assert arrivals.tolist() == [-1 if step is None else step for step in steps]
    assert reached > 100
