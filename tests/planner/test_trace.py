"""Routes found again out of a sweep are those that its labels promised."""

from itertools import pairwise

import numpy as np
import pytest

from planner.clearance import capped_clearance
from planner.ground import Ground, Occupancy
from planner.hazards import OFFSETS, Move, StageClock
from planner.route import evaluate
from planner.score import Weights
from planner.staged import score_worth, scores_at
from planner.sweep import sweep
from planner.trace import routes

WEIGHTS = Weights(alpha=1.0, beta=2.0, gamma=0.3, delta=0.2, clearance_cap_cells=6.0)


def storm(seed, shape=(4, 23, 31)):
    random = np.random.default_rng(seed)
    hazard = random.random(shape) < 0.25
    hazard[:, 11, 15] = False
    flyable = random.random((shape[0], len(Move), *shape[1:])) < 0.8
    return hazard, flyable


@pytest.mark.parametrize("steps_per_stage", [1, 3, 10, 13])
@pytest.mark.parametrize("occupancy", list(Occupancy))
@pytest.mark.parametrize("with_flyable", [False, True])
@pytest.mark.parametrize("first_step", [0, 2])
def test_every_traced_route_keeps_the_rules_and_scores_what_its_label_says(
    steps_per_stage, occupancy, with_flyable, first_step
):
    hazard, flyable = storm(steps_per_stage)
    clock = StageClock(0.0, 4, steps_per_stage)
    ground = Ground(hazard, clock, occupancy, flyable if with_flyable else None)
    clearance = capped_clearance(hazard, 6.0)
    goals = [(int(row), int(column)) for row, column in np.ndindex(23, 31)]
    worth = score_worth(clearance, WEIGHTS)
    swept = sweep(ground, worth, (11, 15), goals, first_step=first_step)
    scores = scores_at(swept, clearance, WEIGHTS, goals)
    ends = [(goals[goal], int(step)) for step, goal in np.argwhere(np.isfinite(scores))][::17]
    assert ends
    for cells, (goal, step) in zip(routes(swept, ends), ends, strict=True):
        assert (cells[0], cells[-1], len(cells)) == ((11, 15), goal, step - first_step + 1)
        moved = {offset: move for move, offset in OFFSETS.items()}
        for at, (here, there) in enumerate(pairwise(cells)):
            move = moved[there[0] - here[0], there[1] - here[1]]
            assert ground.may_move(first_step + at + 1, here, move)
        route = evaluate(cells, clearance, clock, WEIGHTS, first_step)
        assert route.score == pytest.approx(scores[step, goals.index(goal)], abs=1e-7)
        assert route.arrival_step == step


def test_one_route_at_a_time_or_all_at_once_are_the_same():
    """The first way runs small windows, the second the whole grid."""
    hazard, flyable = storm(7, (3, 40, 50))
    ground = Ground(hazard, StageClock(0.0, 3, 20), Occupancy.STRICT, flyable)
    hazard[:, 20, 25] = False
    goals = [(20, 30), (25, 25), (15, 20)]
    swept = sweep(ground, score_worth(capped_clearance(hazard, 6.0), WEIGHTS), (20, 25), goals)
    reached = swept.at_goals >= 0
    ends = [(goals[goal], int(step)) for step, goal in np.argwhere(reached)]
    assert len(ends) > 60
    together = routes(swept, ends)
    for end, route in list(zip(ends, together, strict=True))[::5]:
        assert routes(swept, [end]) == [route]


def test_a_sweep_without_keeps_has_the_same_labels():
    hazard, _ = storm(3)
    ground = Ground(hazard, StageClock(0.0, 4, 9))
    worth = score_worth(capped_clearance(hazard, 6.0), WEIGHTS)
    kept, bare = (sweep(ground, worth, (11, 15), [(0, 0), (20, 30)], keep=keep) for keep in (True, False))
    assert np.array_equal(kept.at_goals, bare.at_goals)
    assert kept.keeps
    assert not bare.keeps
