"""Departures, survival and isochrones on matrices of one's own, and what bad input says."""

import json
from pathlib import Path

import numpy as np
import pytest

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")
ERROR = ("--set", "hazard.forecast_error_mps=4")


@pytest.fixture
def door(tmp_path):
    """A wall whose door opens in the second of three stages of six steps, and a start that then closes."""
    hazards = np.zeros((3, 2, 5), dtype=np.int8)
    hazards[0, :, 2] = 1
    hazards[2, 0, 0] = 1
    path = tmp_path / "door.npy"
    np.save(path, hazards)
    return path


@pytest.fixture
def on_door(ran, door):
    def run(*more):
        return ran("plan", "--hazards", door, "--steps-per-stage", 6, "--start", "0,0", *more)

    return run


def test_the_best_departure_of_each_goal_with_its_route_and_the_table(on_door):
    code, out, err = on_door("--goal", "0,4", "--goal", "1,1", "--departures", "0:24:4")
    assert code == 0
    answer = json.loads(out)
    wall, near = answer["goals"]
    assert (wall["depart_min"], wall["arrival_min"], wall["flight_min"]) == (8.0, 16.0, 8.0)
    assert wall["route"][0] == [4, 0, 0]
    assert wall["route"][-1] == [8, 0, 4]
    assert (near["depart_step"], near["arrival_step"]) == (0, 2)
    table = answer["departures"]
    assert (table["best_by"], table["distinct"]) == ("arrival", False)
    assert [row["depart_min"] for row in table["table"]] == [0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0]
    assert table["table"][-1] == {"depart_min": 24.0, "arrival_min": [None, None], "flight_min": [None, None]}
    assert [choice["depart_min"] for choice in table["chosen"]] == [8.0, 0.0]
    assert "h:mm after step 0" in err
    assert "0,4: leave at 0:08, 0:08 h of flight" in err
    code, json_alone, err = on_door(
        "--goal", "0,4", "--goal", "1,1", "--departures", "0:24:4", "--json", "--best-by", "flight"
    )
    assert err == ""
    assert json.loads(json_alone)["departures"]["best_by"] == "flight"


def test_a_fleet_shares_no_slot(on_door):
    goals = ("--goal", "0,4", "--goal", "1,4", "--goal", "0,1")
    code, out, err = on_door(*goals, "--departures", "8:12:4", "--distinct")
    assert code == 1
    answer = json.loads(out)
    left = [goal["depart_min"] for goal in answer["goals"] if goal["reachable"]]
    assert sorted(left) == [8.0, 12.0]
    (missed,) = [goal for goal in answer["goals"] if not goal["reachable"]]
    assert "all 2 departure slots are better used" in missed["reason"]
    assert answer["departures"]["total_min"] == 1440.0 + sum(
        goal["flight_min"] for goal in answer["goals"] if goal["reachable"]
    )
    assert "1440 of them for each of 1 goals missed" in err


def test_a_goal_that_no_departure_reaches_says_why(ran, tmp_path):
    np.save(tmp_path / "wall.npy", np.tile([0, 0, 1, 0], (2, 3, 1)))
    code, out, err = ran(
        "plan",
        "--hazards",
        tmp_path / "wall.npy",
        "--start",
        "0,0",
        "--goal",
        "1,3",
        "--departures",
        "0:20:10",
    )
    assert code == 1
    answer = json.loads(out)
    assert answer["goals"][0]["nearest"] == [1, 1]
    assert answer["departures"]["chosen"] == [
        {"goal": "1,3", "depart_min": None, "arrival_min": None, "flight_min": None, "survival": None}
    ]
    assert "1,3: no departure reaches it" in err


def test_an_ensemble_counts_its_members_and_abstains(ran, tmp_path):
    members = np.zeros((4, 1, 3, 5), dtype=bool)
    members[:2, 0, :, 2] = True
    members[0, 0, 1, 3] = True
    np.save(tmp_path / "members.npy", members)
    plan = (
        "plan",
        "--hazards",
        tmp_path / "members.npy",
        "--start",
        "0,0",
        "--goal",
        "0,4",
        "--blur-cells",
        0,
    )
    code, out, _ = ran(*plan, "--objective", "survival")
    (found,) = json.loads(out)
    assert (code, found["members_survived"], found["members"], found["abstained"]) == (0, 2, 4, False)
    assert found["survival"] == pytest.approx(0.5)
    assert found["survival_at_most"] == pytest.approx(0.5)
    code, out, _ = ran(*plan, "--objective", "survival", "--abstain-below", "0.6")
    assert code == 1
    assert json.loads(out)[0]["abstained"]
    code, out, err = ran(*plan, "--departures", "0:20:10", "--best-by", "survival")
    answer = json.loads(out)
    assert answer["departures"]["table"][2]["survival"] == [pytest.approx(0.5)]
    assert answer["goals"][0]["members_survived"] == 2
    assert "50 %" in err
    code, _, err = ran(*plan)
    assert code == 2  # a blur of nothing


def test_isochrones_hold_the_arrival_step_of_every_cell(on_door, ran, tmp_path):
    code, _, _ = on_door("--goal", "0,4", "--isochrones", tmp_path / "steps.npy")
    assert code == 0
    field = np.load(tmp_path / "steps.npy")
    assert field.tolist() == [[0, 1, 6, 7, 8], [1, 2, 6, 7, 8]]
    code, out, _ = ran("plan", SHORT, "--isochrones", tmp_path / "short.npy", "--json")
    assert code == 0
    steps = np.load(tmp_path / "short.npy")
    row, column = (round(at) for at in ((29.76 - 29.0) / 1.5 * 46, (91.5 - 90.45) / 2.0 * 54))
    (goal,) = json.loads(out)["goals"]
    assert steps[row, column] * 120.0 == goal["earliest_arrival_s"]
    assert (steps == 0).sum() == 1
    assert steps.max() == 29  # the last step of the horizon


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--departures", "0-20"], ["'0-20'", "FIRST:LAST:EVERY"]),
        (["--departures", "0:20"], ["'0:20'"]),
        (["--departures", "0:20:x"], ["'0:20:x'"]),
        (["--departures", "0:20:0"], ["make no slots"]),
        (["--departures", "20:0:4"], ["make no slots"]),
        (["--departures", "nan:20:4"], ["make no slots"]),
        (["--departures", "0:20:5"], ["multiples of 2 min"]),
        (["--departures", "0:600:30"], ["horizon", "36 min"]),
        (["--departures", "0:20:10", "--best-by", "luck"], ["'luck'", "survival"]),
        (["--departures", "0:20:10", "--distinct", "--best-by", "flight"], ["--distinct", "--best-by"]),
        (["--departures", "0:20:10", "--objective", "score"], ["--best-by", "--objective"]),
        (["--departures", "0:20:10", "--exact"], ["--exact"]),
        (["--departures", "0:20:10", "--isochrones", "x.npy"], ["one departure"]),
        (["--distinct"], ["--distinct", "--departures"]),
        (["--best-by", "flight"], ["--best-by", "--departures"]),
        (["--isochrones", "x.txt"], ["x.npy"]),
        (["--isochrones", "missing/x.npy"], ["cannot write"]),
        (["--isochrones", "x.npy", "--objective", "survival"], ["certain"]),
        (["--blur-cells", "2"], ["--objective survival"]),
        (["--blur-cells", "-1", "--objective", "survival"], ["blur of -1"]),
        (["--abstain-below", "0.5"], ["chance to survive", "'survival'"]),
        (["--abstain-below", "2", "--objective", "survival"], ["between 0 and 1"]),
        (["--seed", "3"], ["--seed", "--hazards"]),
        (["--out", "plan.json"], ["--out", "--hazards"]),
        (["--export", "route.kml"], ["--export"]),
        (["--key", "a"], ["one array", "leave out --key 'a'"]),
        (["--members", "a"], ["one array", "leave out --members 'a'"]),
        (["--steps-per-stage", "0"], ["must be positive"]),
        (["--steps-per-stage", "-2"], ["must be positive"]),
        (["--step-s", "0"], ["must be positive"]),
        (["--step-s", "nan"], ["finite"]),
        (["--gamma", "inf"], ["gamma", "inf"]),
        (["--beta", "-1"], ["beta", "not negative"]),
        (["--goal", "0,9"], ["(0, 9)", "2 rows and 5 columns"]),
        (["--goal", "x"], ["--goal 'x'", "ROW,COLUMN"]),
        (["--objective", "fuel"], ["'fuel'", "survival"]),
    ],
)
def test_bad_options_for_matrices_are_named(on_door, more, words):
    code, out, err = on_door("--goal", "0,4", *more)
    assert code == 2, out
    assert all(word in err for word in words), err


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.zeros((0, 4, 5)), ["empty"]),
        (np.zeros((2, 4, 0)), ["empty"]),
        (np.full((1, 1, 5), np.nan), ["nan"]),
        (np.zeros((4, 5)), ["[stage, row, column]"]),
        (np.zeros((2, 1, 4, 5)), ["--index"]),
        (np.float64(3.0), ["[stage, row, column]"]),
        (np.array([["a"]]), ["numbers"]),
    ],
)
def test_matrices_that_are_none_are_named(ran, tmp_path, array, words):
    np.save(tmp_path / "given.npy", array)
    plan = ("plan", "--hazards", tmp_path / "given.npy", "--start", "0,0", "--goal", "0,4")
    code, _, err = ran(*plan)
    assert code == 2
    assert all(word.removeprefix("--") in err for word in words), err
    code, _, _ = ran(*plan, "--index", 7)
    assert code == 2


def test_the_smallest_worlds_and_a_start_in_hazard_are_answers(ran, tmp_path):
    def plan(array, *more):
        np.save(tmp_path / "given.npy", np.array(array))
        code, out, _ = ran("plan", "--hazards", tmp_path / "given.npy", "--start", "0,0", *more)
        return code, json.loads(out)

    code, (here, again) = plan([[[0]]], "--goal", "0,0", "--goal", "0,0", "--steps-per-stage", 1)
    assert code == 0
    assert here == again
    assert (here["arrival_step"], here["route"]) == (0, [[0, 0, 0]])
    code, (there,) = plan([[[0, 0]]], "--goal", "0,1", "--steps-per-stage", 1)
    assert (code, there["reachable"], there["nearest"]) == (1, False, [0, 0])
    code, (shut,) = plan([[[1, 0]]], "--goal", "0,1")
    assert (code, shut["reason"]) == (1, "the start is in hazard at departure")
    code, (shut,) = plan([[[0, 1]]], "--goal", "0,1")
    assert (code, shut["reason"]) == (1, "the goal is in hazard in every stage")


def test_ten_thousand_goals_share_three_departures(ran, tmp_path):
    np.save(tmp_path / "calm.npy", np.zeros((1, 10, 40), dtype=bool))
    goals = [word for at in range(10_000) for word in ("--goal", f"{at % 10},{at // 10 % 40}")]
    fleet = ("--departures", "0:20:10", "--distinct", "--json")
    code, out, _ = ran("plan", "--hazards", tmp_path / "calm.npy", "--start", "0,0", *goals, *fleet)
    found = json.loads(out)["goals"]
    assert code == 1
    assert sorted(goal["depart_min"] for goal in found if goal["reachable"]) == [0.0, 10.0, 20.0]
    assert [goal["flight_min"] for goal in found if goal["reachable"]] == [
        0.0,
        0.0,
        0.0,
    ]  # the start, repeated
