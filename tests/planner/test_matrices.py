"""Planning on a user's own matrices: what comes back, and what bad input says."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest

import planner
from planner.errors import BadFieldError, OutsideGridError, PlannerError
from planner.plans import Plan
from planner.score import Weights

CLEAR = np.zeros((2, 4, 5), dtype=np.uint8)


def test_the_package_offers_the_call_and_stays_light():
    assert Plan.__name__ == "Plan"
    assert callable(planner.plan)
    script = "import planner, sys; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


@pytest.mark.parametrize("objective", ["earliest", "score", "survival"])
def test_every_objective_answers_in_the_order_of_the_goals(objective):
    goals = [(3, 4), (0, 0), (3, 4), (0, 2)]
    found = planner.plan(CLEAR, (0, 0), goals, steps_per_stage=10, objective=objective)
    assert [entry.goal for entry in found] == goals
    assert [entry.route.arrival_step for entry in found] == [7, 0, 7, 2]
    for entry in found:
        answer = json.loads(json.dumps(entry.to_dict()))
        assert answer["reachable"]
        assert answer["arrival_min"] == 2.0 * answer["arrival_step"]
        assert answer["route"][0] == [0, 0, 0]
        assert answer["route"][-1] == [answer["arrival_step"], *entry.goal]
        assert sum(answer["terms"].values()) == pytest.approx(answer["score"])
    assert found[0] == found[2]


def test_any_number_but_zero_is_hazard_and_paper_occupancy_is_the_default():
    hazards = np.zeros((2, 1, 3))
    hazards[0, 0, 1] = -0.5
    (paper,) = planner.plan(hazards, [0, 0], [[0, 2]], steps_per_stage=5)
    (strict,) = planner.plan(hazards, [0, 0], [[0, 2]], steps_per_stage=5, occupancy="strict")
    assert (paper.route.arrival_step, paper.route.waits) == (6, 4)
    assert strict.route.arrival_step == 7
    assert paper.to_dict()["min_clearance_cells"] == 1.0


def test_stages_report_the_best_route_so_far():
    (found,) = planner.plan(CLEAR, (0, 0), [(3, 4)], steps_per_stage=5, objective="score")
    first, second = found.to_dict()["stages"]
    assert first == {"stage": 0, "reachable": False, "arrival_step": None, "score": None}
    assert (second["reachable"], second["arrival_step"]) == (True, 7)
    assert second["route"] == found.to_dict()["route"]
    assert found.stages[1].best == found.route


@pytest.mark.parametrize("objective", ["earliest", "score", "survival"])
def test_a_stage_repeats_no_route(objective):
    (found,) = planner.plan(CLEAR, (0, 0), [(0, 2)], steps_per_stage=5, objective=objective)
    first, second = found.to_dict()["stages"]
    assert first["route"][-1] == [2, 0, 2]
    assert second == {name: value for name, value in first.items() if name != "route"} | {"stage": 1}
    (late,) = planner.plan(CLEAR, (0, 0), [(0, 2)], steps_per_stage=5, objective=objective, depart_step=6)
    assert [end.stage for end in late.stages] == [1]


def test_exact_reports_a_closed_gap():
    hazards = np.random.default_rng(3).random((3, 9, 9)) < 0.2
    hazards[:, 0, 0] = hazards[:, 8, 8] = False
    goals = [(8, 8), (2, 3)]
    plain = planner.plan(hazards, (0, 0), goals, steps_per_stage=12, objective="score")
    exact = planner.plan(hazards, (0, 0), goals, steps_per_stage=12, objective="score", exact=True)
    for one, other in zip(plain, exact, strict=True):
        assert one.reachable == other.reachable
        if other.route:
            assert other.gap == 0.0
            assert other.route.score >= one.route.score - 1e-9


def test_a_goal_without_a_way_says_why_how_near_and_until_when():
    hazards = np.zeros((3, 1, 6), dtype=bool)
    hazards[1:, 0, 3] = True  # the door shuts after the first stage
    hazards[0, 0, 1] = True  # which is spent waiting
    for objective in ("earliest", "score"):
        (found,) = planner.plan(hazards, (0, 0), [(0, 5)], steps_per_stage=4, objective=objective)
        answer = found.to_dict()
        assert answer["reason"] == "no safe way leads there within the horizon"
        assert (answer["nearest"], answer["nearest_distance_cells"]) == ([0, 2], 3.0)
        assert answer["nearest_step"] == 5
        assert answer["last_door_stage"] is None
    hazards[0, 0, 1] = False
    hazards[:, 0, 4] = [False, True, True]
    (late,) = planner.plan(hazards, (0, 0), [(0, 5)], steps_per_stage=4)
    assert late.dead_end.last_door_stage == 0
    (horizon,) = planner.plan(CLEAR, (0, 0), [(3, 4)], steps_per_stage=2)
    assert horizon.dead_end.last_door_stage == 1
    assert horizon.dead_end.nearest_step == 3


@pytest.mark.parametrize("objective", ["earliest", "score", "survival"])
def test_a_start_in_hazard_and_a_goal_in_hazard_are_answers(objective):
    hazards = np.zeros((2, 2, 3), dtype=bool)
    hazards[:, 1, 2] = True
    options = {"steps_per_stage": 5, "objective": objective, "blur_cells": 0.0}
    (goal,) = planner.plan(hazards, (0, 0), [(1, 2)], **options)
    (start,) = planner.plan(hazards, (1, 2), [(0, 0)], **options)
    assert not goal.reachable
    assert not start.reachable
    if objective != "survival":
        assert goal.reason == "the goal is in hazard in every stage"
        assert start.reason == "the start is in hazard at departure"
    assert goal.to_dict()["reason"]


def test_survival_takes_an_ensemble_or_probabilities():
    members = np.zeros((4, 1, 3, 5), dtype=bool)
    members[:2, 0, 0, 2] = True
    options = {"steps_per_stage": 9, "objective": "survival", "blur_cells": 0.0}
    (found,) = planner.plan(members, (0, 0), [(0, 4)], **options)
    answer = found.to_dict()
    assert (answer["survival"], answer["members_survived"], answer["members"]) == (1.0, 4, 4)
    assert not answer["abstained"]
    (given,) = planner.plan(
        members[0], (0, 0), [(0, 4)], **options, probability=np.full((1, 3, 5), 0.5), abstain_below=0.9
    )
    assert given.chance.at_least == pytest.approx(0.5**5)
    assert given.abstained


def test_other_objectives_report_the_survival_that_a_probability_gives():
    p = np.full(CLEAR.shape, 0.1)
    for objective in ("earliest", "score"):
        (found,) = planner.plan(
            CLEAR, (0, 0), [(0, 2)], objective=objective, probability=p, abstain_below=0.8
        )
        assert (found.chance.at_least, found.chance.at_most) == (pytest.approx(0.9**3), pytest.approx(0.9))
        assert found.abstained
    hazards = CLEAR.copy()
    hazards[:, :, 3] = 1
    (missed,) = planner.plan(hazards, (0, 0), [(0, 4)], probability=p)
    assert missed.chance is None


@pytest.mark.parametrize("objective", ["earliest", "score", "survival"])
def test_routes_of_every_objective_are_counted_in_an_ensemble_beside_the_forecast(objective):
    members = np.zeros((5, 1, 2, 4), dtype=bool)
    members[:2, 0, :, 2] = True
    options = {"objective": objective, "members": members, "blur_cells": 0.0}
    (found,) = planner.plan(np.zeros((1, 2, 4)), (0, 0), [(0, 3)], **options, abstain_below=0.6)
    answer = found.to_dict()
    assert (answer["members_survived"], answer["members"], answer["abstained"]) == (3, 5, False)
    assert answer["survival"] == pytest.approx(0.6)
    (timid,) = planner.plan(np.zeros((1, 2, 4)), (0, 0), [(0, 3)], **options, abstain_below=0.61)
    assert timid.abstained


def test_a_goal_that_certain_hazard_shuts_off_says_how_near():
    members = np.zeros((3, 2, 1, 5), dtype=bool)
    members[:, :, 0, 3] = True
    (found,) = planner.plan(members, (0, 0), [(0, 4)], objective="survival", blur_cells=0.0)
    assert found.reason == "no safe way leads there within the horizon"
    assert (found.dead_end.nearest, found.dead_end.last_door_stage) == ((0, 2), None)


def test_isochrones_are_the_arrivals_at_every_cell():
    hazards = np.random.default_rng(5).random((3, 6, 7)) < 0.3
    hazards[:, 0, 0] = False
    for occupancy in ("paper", "strict"):
        steps = planner.isochrones(hazards, (0, 0), steps_per_stage=6, occupancy=occupancy, depart_step=3)
        goals = list(np.ndindex(6, 7))
        found = planner.plan(hazards, (0, 0), goals, steps_per_stage=6, occupancy=occupancy, depart_step=3)
        assert [-1 if entry.earliest_step is None else entry.earliest_step for entry in found] == (
            steps.ravel().tolist()
        )
    with pytest.raises(PlannerError, match="horizon of 18"):
        planner.isochrones(hazards, (0, 0), steps_per_stage=6, depart_step=18)


@pytest.mark.parametrize("seed", range(12))
def test_departures_are_planned_as_one_by_one(seed):
    random = np.random.default_rng(seed)
    hazards = random.random((3, 5, 5)) < 0.3
    goals = [tuple(cell) for cell in random.integers(0, 5, (4, 2)).tolist()]
    slots = range(0, 12, 2)
    alone = {
        slot: planner.plan(hazards, (2, 2), goals, steps_per_stage=5, depart_step=slot) for slot in slots
    }
    for by in ("arrival", "flight"):
        found = planner.plan_departures(hazards, (2, 2), goals, (0, 20, 4), best_by=by, steps_per_stage=5)
        for at, entry in enumerate(found.goals):
            reached = {slot: plans[at].route.arrival_step for slot, plans in alone.items() if plans[at].route}
            assert entry.reachable == bool(reached)
            if reached:
                worth = {slot: step - (slot if by == "flight" else 0) for slot, step in reached.items()}
                assert worth[entry.route.first_step] == min(worth.values())
                assert entry == alone[entry.route.first_step][at]
    fleet = planner.plan_departures(hazards, (2, 2), goals, (0, 20, 4), distinct=True, steps_per_stage=5)
    left = [entry.route.first_step for entry in fleet.goals if entry.route]
    assert len(left) == len(set(left))
    total = sum(
        1440.0 if entry.route is None else 2.0 * (entry.route.arrival_step - entry.route.first_step)
        for entry in fleet.goals
    )
    assert fleet.table.chosen.total_min == total
    assert json.loads(json.dumps(fleet.to_dict())) == fleet.to_dict()


def test_departures_by_survival_take_an_ensemble():
    members = np.random.default_rng(2).random((5, 3, 4, 4)) < 0.25
    members[:, :, 0, 0] = False
    options = {"steps_per_stage": 4, "blur_cells": 0.5}
    found = planner.plan_departures(members, (0, 0), [(3, 3)], (0, 10, 2), best_by="survival", **options)
    chances = [
        planner.plan(members, (0, 0), [(3, 3)], objective="survival", depart_step=slot, **options)[0].chance
        for slot in range(6)
    ]
    (goal,) = found.goals
    assert goal.chance.members == 5
    known = [0.0 if chance is None else chance.at_least for chance in chances]
    assert goal.chance.at_least == pytest.approx(max(known))
    assert found.table.departures.survival[:, 0] == pytest.approx(known, abs=1e-9)


def test_the_smallest_worlds():
    (here,) = planner.plan([[[0]]], (0, 0), [(0, 0)], steps_per_stage=1, objective="score", exact=True)
    assert here.route.cells == ((0, 0),)
    (there,) = planner.plan([[[0, 0]]], (0, 0), [(0, 1)], steps_per_stage=1)
    assert not there.reachable  # a horizon of one step is step 0 alone
    (last,) = planner.plan([[[0, 0]]], (0, 0), [(0, 1)], steps_per_stage=2, depart_step=0)
    assert last.route.arrival_step == 1


@pytest.mark.parametrize("objective", ["earliest", "score", "survival"])
def test_ten_thousand_goals(objective):
    goals = [(row % 25, row // 25 % 40) for row in range(10_000)]
    hazards = np.zeros((2, 25, 40), dtype=bool)
    found = planner.plan(hazards, (0, 0), goals, steps_per_stage=40, objective=objective)
    assert len(found) == 10_000
    assert all(entry.route.arrival_step == sum(goal) for entry, goal in zip(found, goals, strict=True))


@pytest.mark.parametrize("objective", ["earliest", "score"])
def test_ten_thousand_goals_out_of_reach(objective):
    hazards = np.zeros((2, 25, 40), dtype=bool)
    hazards[:, :, 20] = True
    goals = [(row % 25, 20 + row // 25 % 20) for row in range(10_000)]
    found = planner.plan(hazards, (0, 0), goals, steps_per_stage=40, objective=objective)
    assert [entry.dead_end.nearest for entry in found] == [(goal[0], 19) for goal in goals]
    in_wall = [entry.reason.startswith("the goal is in hazard") for entry in found]
    assert in_wall == [column == 20 for _, column in goals]


@pytest.mark.parametrize(
    ("options", "error", "says"),
    [
        ({"hazards": [[[0, 1]], [[0]]]}, BadFieldError, "disagree in shape"),
        ({"hazards": np.zeros((4, 5))}, BadFieldError, r"give \[stage, row, column\]"),
        ({"hazards": np.zeros((2, 3, 4, 5))}, BadFieldError, "pick one by its index"),
        ({"hazards": np.zeros((0, 4, 5))}, BadFieldError, "empty"),
        ({"hazards": np.zeros((2, 0, 5))}, BadFieldError, "empty"),
        ({"hazards": np.full((2, 4, 5), np.nan)}, BadFieldError, r"\(0, 0, 0\) is nan"),
        ({"hazards": np.full((2, 4, 5), np.inf)}, BadFieldError, "is inf"),
        ({"hazards": np.full((2, 4, 5), "storm")}, BadFieldError, "numbers or booleans"),
        ({"start": (4, 0)}, OutsideGridError, "start .4, 0. lies off the grid of 4 rows and 5 columns"),
        ({"start": (-1, 0)}, OutsideGridError, "count from 0"),
        ({"goals": [(0, 0), (0, 5)]}, OutsideGridError, "goal .0, 5."),
        ({"goals": []}, PlannerError, "no goal"),
        ({"goals": [(1,)]}, PlannerError, r"not a \(row, column\)"),
        ({"goals": [(0.5, 1)]}, PlannerError, "not a whole number"),
        ({"start": 3}, PlannerError, r"not a \(row, column\)"),
        ({"steps_per_stage": 0}, BadFieldError, "must be positive"),
        ({"steps_per_stage": -3}, BadFieldError, "must be positive"),
        ({"steps_per_stage": 2.5}, PlannerError, "not a whole number"),
        ({"step_s": 0.0}, BadFieldError, "must be positive"),
        ({"step_s": math.nan}, BadFieldError, "finite"),
        ({"objective": "fastest"}, PlannerError, "earliest, score, survival"),
        ({"occupancy": "loose"}, PlannerError, "paper or strict"),
        ({"exact": True}, PlannerError, "objective 'score'"),
        ({"abstain_below": 0.5}, PlannerError, "chance to survive"),
        ({"members": np.zeros((3, 2, 4, 4))}, BadFieldError, "do not fit"),
        ({"members": np.zeros((4, 5))}, BadFieldError, "member, stage, row, column"),
        ({"probability": np.full((2, 4, 5), np.nan)}, BadFieldError, "0 and 1"),
        ({"depart_step": 60}, PlannerError, "horizon of 60 steps"),
        ({"depart_step": -1}, PlannerError, "horizon"),
        ({"objective": "survival", "abstain_below": 1.5}, BadFieldError, "between 0 and 1"),
        ({"objective": "survival", "blur_cells": -1.0}, BadFieldError, "blur"),
        ({"objective": "survival", "probability": np.zeros((1, 4, 5))}, BadFieldError, "do not fit"),
        ({"objective": "survival", "probability": np.full((2, 4, 5), 1.5)}, BadFieldError, "0 and 1"),
    ],
)
def test_bad_input_says_what_and_what_instead(options, error, says):
    given = {"hazards": CLEAR, "start": (0, 0), "goals": [(3, 4)], **options}
    with pytest.raises(error, match=says):
        planner.plan(given.pop("hazards"), given.pop("start"), given.pop("goals"), **given)


@pytest.mark.parametrize("name", ["alpha", "beta", "gamma", "delta", "clearance_cap_cells"])
def test_weights_that_are_not_finite_are_errors(name):
    with pytest.raises(BadFieldError, match=name):
        planner.plan(CLEAR, (0, 0), [(3, 4)], weights=Weights(**{name: math.inf}))


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="nothing"):
        _ = planner.nothing
