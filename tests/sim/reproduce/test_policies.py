from dataclasses import replace

import numpy as np
import pytest

from planner.ground import Ground, Occupancy
from planner.hazards import StageClock
from planner.peers import breadth_first
from sim.reproduce.ensembles import MatrixEnsemble
from sim.reproduce.judged import judge_policies
from sim.reproduce.judging import Fate, first_hazard
from sim.reproduce.outlook import Case, Outlook, Window
from sim.reproduce.policies import POLICIES, problem
from sim.reproduce.replanned import replanned
from sim.reproduce.tuning import TUNED_SMALL as DIALS

FLOWN = (Fate.SAFE, Fate.LOST)


def knowing(case):
    """The same case with forecasts that are right."""
    outlook = Outlook(lambda: case.truth.hazard, MatrixEnsemble(case.truth.hazard[None]), case.truth.clock)
    return replace(case, outlook=outlook, later=lambda _: outlook, _found={})


def test_routes_lead_from_the_start_to_their_goals_by_single_moves(cases):
    for case in cases:
        for policy in POLICIES.values():
            for goal, (way, _) in zip(case.goals, policy.plan(case, DIALS), strict=True):
                if way is not None:
                    assert way[0] == case.start
                    assert way[-1] == goal
                    assert np.abs(np.diff(way, axis=0)).sum(axis=1).max() <= 1
                    assert len(way) <= case.truth.clock.step_count


def test_the_oracle_is_safe_and_nobody_arrives_where_or_before_it_does_not(cases):
    safe = 0
    for case in cases:
        found = judge_policies(case, tuple(POLICIES), DIALS)
        assert all(row["fate"] in (Fate.SAFE, Fate.NO_ROUTE) for row in found["oracle"])
        for rows in found.values():
            for row, best in zip(rows, found["oracle"], strict=True):
                if row["fate"] == Fate.SAFE:
                    assert best["fate"] == Fate.SAFE
                    assert row["steps"] >= best["steps"]
        safe += sum(row["fate"] == Fate.SAFE for row in found["oracle"])
    assert safe


def test_with_forecasts_that_are_right_all_but_plain_bfs_are_safe(cases):
    fates = {name: [] for name in POLICIES}
    for case in cases:
        sharp = replace(DIALS, blur_cells=0.0)
        for name, rows in judge_policies(knowing(case), tuple(POLICIES), sharp).items():
            fates[name] += [row["fate"] for row in rows]
    assert Fate.LOST in fates.pop("bfs")
    for name, its in fates.items():
        assert Fate.LOST not in its, name
        assert its.count(Fate.SAFE) == fates["oracle"].count(Fate.SAFE), name


def test_plain_bfs_is_as_long_as_the_peer(cases):
    case = cases[0]
    asked = problem(case.outlook, DIALS.weights)
    for goal, (way, _) in zip(case.goals, POLICIES["bfs"].plan(case, DIALS), strict=True):
        peer = breadth_first.find(asked, case.start, goal)
        assert (way is None) == (peer.cells is None)
        assert way is None or len(way) == len(peer.cells)


def test_abstaining_is_surviving_in_too_few_members(cases):
    told = 0
    for case in cases:
        found = judge_policies(case, ("survival", "abstain"), replace(DIALS, abstain_below=0.7))
        for flown, asked in zip(found["survival"], found["abstain"], strict=True):
            if flown["fate"] != Fate.NO_ROUTE:
                assert (asked["fate"] == Fate.ABSTAINED) == (flown["members_survived"] < 0.7)
                assert asked["would_be"] == flown["fate"]
                told += asked["fate"] == Fate.ABSTAINED
    assert told


def test_margins_keep_their_distance_where_they_can():
    hazard = np.zeros((1, 15, 15), dtype=bool)
    hazard[0, 6:9, 4:11] = True
    case = matrix_case(hazard, start=(7, 0), goals=((7, 14),), steps=60)
    ((way, _),) = POLICIES["margins"].plan(case, replace(DIALS, margin_cells=3.0))
    apart = min(np.hypot(*(np.argwhere(hazard[0]) - cell).T).min() for cell in way)
    assert apart > 3.0
    ((tight, _),) = POLICIES["margins"].plan(case, replace(DIALS, margin_cells=7.0))
    assert tight is not None  # half of it


def matrix_case(hazard, start, goals, steps):
    clock = StageClock(0.0, len(hazard), steps)
    outlook = Outlook(lambda: hazard, MatrixEnsemble(hazard[None]), clock)
    return Case(start, goals, Ground(hazard, clock, Occupancy.PAPER), outlook)


def test_a_route_is_lost_at_its_first_step_in_hazard():
    hazard = np.zeros((2, 3, 5), dtype=bool)
    hazard[1, 1, 2] = True
    clock = StageClock(0.0, 2, 3)
    along = tuple((1, column) for column in range(5))
    assert first_hazard(along, Ground(hazard, clock, Occupancy.PAPER)) is None  # passed at step 2, stage 0
    assert first_hazard(along[:1] + along, Ground(hazard, clock, Occupancy.PAPER)) == 3
    strict = Ground(hazard, clock, Occupancy.STRICT)
    assert first_hazard(along, strict) == 2  # left in the move that touches stage 1


def test_replanning_leaves_what_a_new_forecast_closes():
    """At departure the straight way is clear in the forecast; at stage 1 it is known to close, and does."""
    calm = np.zeros((3, 9, 21), dtype=bool)
    storm = calm.copy()
    storm[1:, 2:9, 14] = True
    clock = StageClock(0.0, 3, 12)
    seen = {0: calm, 1: storm, 2: storm}

    def outlook(stage):
        return Outlook(lambda: seen[stage], MatrixEnsemble(seen[stage][None]), clock)

    case = Case((4, 0), ((4, 19),), Ground(storm, clock, Occupancy.PAPER), outlook(0), outlook)
    sharp = replace(DIALS, blur_cells=0.0)
    ((old, _),) = POLICIES["survival"].plan(case, sharp)
    assert first_hazard(old, case.truth) is not None
    ((new, _),) = POLICIES["replan"].plan(case, sharp)
    assert new[:13] == old[:13]
    assert new[-1] == (4, 19)
    assert first_hazard(new, case.truth) is None
    assert replanned(case, [None], sharp) == [None]


@pytest.mark.parametrize("blur_cells", [0.0, 2.0])
def test_a_window_of_the_probability_is_part_of_it(cases, blur_cells):
    ensemble = cases[0].outlook.ensemble
    window = Window(slice(1, 3), slice(5, 30), slice(0, 12))
    whole = ensemble.probability(blur_cells, Window.whole())
    np.testing.assert_allclose(ensemble.probability(blur_cells, window), whole[window], atol=1e-12)
    assert 0.0 <= whole.min() <= whole.max() <= 1.0
