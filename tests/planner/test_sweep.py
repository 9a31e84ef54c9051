"""What the sweep promises whatever its labels mean: turned worlds, more hazard, no precision lost."""

import numpy as np
import pytest

from planner.arrivals import sweep_arrivals
from planner.clearance import capped_clearance
from planner.ground import Ground, Occupancy
from planner.hazards import StageClock
from planner.labels import FixedPoint
from planner.score import Weights
from planner.staged import StagedProblem, score_worth, search
from planner.sweep import sweep

# Irregular weights, so that no two different routes score the same but by turning.
WEIGHTS = Weights(alpha=0.913, beta=2.717, gamma=0.3179, delta=0.2113, clearance_cap_cells=5.3)


def problem(hazard):
    return StagedProblem(hazard, StageClock(0.0, len(hazard), 9), WEIGHTS, Occupancy.STRICT)


TURNS = {
    "east for west": (lambda sheet: np.flip(sheet, 2), lambda cell, n: (cell[0], n - 1 - cell[1])),
    "north for south": (lambda sheet: np.flip(sheet, 1), lambda cell, n: (n - 1 - cell[0], cell[1])),
    "a quarter turn": (
        lambda sheet: np.rot90(sheet, axes=(1, 2)),
        lambda cell, n: (n - 1 - cell[1], cell[0]),
    ),
}


@pytest.mark.parametrize("turn", TURNS)
def test_turned_worlds_give_the_same_scores_and_turned_routes(turn):
    turn_sheet, turn_cell = TURNS[turn]
    side, unique, routes = 12, 0, 0
    for seed in range(25):
        hazard = np.random.default_rng(seed).random((3, side, side)) < 0.3
        hazard[:, 5, 6] = False
        goals = [(1, 2), (9, 10), (3, 8)]
        here = search(problem(hazard), (5, 6), goals)
        turned_goals = [turn_cell(goal, side) for goal in goals]
        there = search(problem(turn_sheet(hazard).copy()), turn_cell((5, 6), side), turned_goals)
        for one, other in zip(here, there, strict=True):
            assert (one.best is None) == (other.best is None)
            if one.best and other.best:
                assert other.best.score == pytest.approx(one.best.score, abs=1e-9)
                assert other.best.arrival_step == one.best.arrival_step
                assert other.earliest.arrival_step == one.earliest.arrival_step
                assert other.best.waits == one.best.waits
                routes += 1
                unique += other.best.cells == tuple(turn_cell(cell, side) for cell in one.best.cells)
    assert routes > 40
    assert unique > routes / 3  # the rest are equals, told apart by the order of moves


def test_each_stage_s_best_so_far_never_falls_and_ends_with_the_best():
    hazard = np.random.default_rng(4).random((6, 12, 12)) < 0.25
    hazard[:, 5, 6] = False
    for entry in search(problem(hazard), (5, 6), [(1, 2), (9, 10), (5, 6)]):
        scores = [-np.inf if end.best is None else end.best.score for end in entry.stages]
        assert scores == sorted(scores)
        assert [end.stage for end in entry.stages] == list(range(6))
        assert entry.stages[-1].best == entry.best
        for end in entry.stages:
            assert end.best is None or end.best.arrival_step < 9 * (end.stage + 1)
            if entry.earliest:
                assert (end.best is not None) == (entry.earliest.arrival_step < 9 * (end.stage + 1))


def test_a_later_departure_counts_time_from_there():
    hazard = np.zeros((4, 5, 9), dtype=bool)
    (now,) = search(problem(hazard), (2, 0), [(2, 8)])
    (later,) = search(problem(hazard), (2, 0), [(2, 8)], first_step=7)
    assert later.best.arrival_step == now.best.arrival_step + 7
    assert later.best.score == pytest.approx(now.best.score, abs=1e-9)
    assert later.best.steps[0] == (7, 2, 0)
    assert [end.stage for end in later.stages] == [0, 1, 2, 3]


@pytest.mark.parametrize("largest", [1e-12, 1.0, 61_614.0, 1e9])
@pytest.mark.parametrize("steps", [1, 540, 10_000])
def test_labels_hold_the_largest_value_with_all_its_waits(largest, steps):
    point = FixedPoint.for_values(largest, steps)
    label = point.whole(largest) + steps
    assert 0 <= label < 2**59
    assert point.values(np.array([label]))[0] == pytest.approx(largest, rel=1e-7, abs=1e-15)
    assert point.waits(np.array([label]))[0] == steps


@pytest.mark.parametrize("seed", range(6))
def test_regions_that_shrink_and_grow_again_stay_what_the_arrivals_say(seed):
    """Long storms push unreached labels down in every step; none may come round as a reached one."""
    random = np.random.default_rng(seed)
    shares = [0.2, 0.85, 0.95, 0.3, 0.9, 0.1, 0.97, 0.2, 0.1]
    hazard = np.stack([random.random((30, 9)) < share for share in shares])
    hazard[:, 15, 4] = False
    clock = StageClock(0.0, len(hazard), 17)
    ground = Ground(hazard, clock, random.choice(list(Occupancy)))
    cells = list(np.ndindex(30, 9))
    swept = sweep(ground, score_worth(capped_clearance(hazard, 3.0), WEIGHTS), (15, 4), cells)
    arrivals = sweep_arrivals(ground, (15, 4))
    reached = np.stack([arrivals.occupied(step).ravel() for step in range(clock.step_count)])
    assert np.array_equal(swept.at_goals >= 0, reached)
