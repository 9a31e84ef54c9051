"""Departures, survival and isochrones from the command line, and what bad input says."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from planner.plans import Plan
from sim import cli

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")
ERROR = ("--set", "hazard.forecast_error_mps=4")


@pytest.fixture
def ran(capsys, monkeypatch):
    """Runs the command in this process: (*arguments) -> exit code, stdout, stderr."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["galeway", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        return stopped.value.code, printed.out, printed.err

    return run


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


def test_a_scenario_leaves_at_the_best_departure(ran, tmp_path):
    plan = ("plan", SHORT, "--departures", "4:40:12")
    code, out, _ = ran(*plan, "--json", "--out", tmp_path / "plan.json")
    assert code == 0
    answer = json.loads(out)
    saved = Plan.load(tmp_path / "plan.json")
    assert saved.departure_s == 1664409600.0 + 240.0
    assert saved.waypoints[0].time_s == 0.0
    assert answer["plans"][0]["departure_s"] == saved.departure_s
    (choice,) = answer["departures"]["chosen"]
    assert choice["depart_min"] == 4.0
    assert choice["flight_min"] * 60.0 == saved.outcome.arrival_s == saved.waypoints[-1].time_s
    assert [row["depart_min"] for row in answer["departures"]["table"]] == [4.0, 16.0, 28.0, 40.0]
    code, out, _ = ran(*plan, "--best-by", "survival", *ERROR)
    assert code == 0
    assert "arrival and survival against departure, h:mm after 2022-09-29T00:00Z" in out
    assert "(staged, by survival)" in out


def test_a_fleet_leaves_a_plan_for_each_goal(ran, tmp_path):
    goals = (
        'mission.goals=[{name="There", lat_deg=29.76, lon_deg=-90.45},'
        '{name="Over there", lat_deg=29.7, lon_deg=-90.5}]'
    )
    files = ("--out", tmp_path / "plan.json", "--export", tmp_path / "route.geojson")
    code, out, _ = ran("plan", SHORT, "--set", goals, "--departures", "0:10:10", "--distinct", *files)
    assert code == 0
    plans = [Plan.load(tmp_path / f"plan-{name}.json") for name in ("There", "Over-there")]
    assert {plan.departure_s - 1664409600.0 for plan in plans} == {0.0, 600.0}
    assert [plan.goal for plan in plans] == ["There", "Over there"]
    assert (tmp_path / "route-There.geojson").exists()
    assert out.count(" > ") == 2
    alike = goals.replace('"There"', '"Over-there"')
    code, _, err = ran(
        *("plan", SHORT, "--set", alike, "--goal", "Over there", "--departures", "0:10:10", "--distinct"),
        *files,
    )
    assert code == 2
    assert "share a name" in err


def test_survival_is_reported_and_a_plan_that_is_too_risky_is_not_flown(ran, tmp_path):
    risky = (*ERROR, "--set", "planner.abstain_below=0.999999", "--set", "hazard.threshold_mps=13")
    code, out, _ = ran("plan", SHORT, *ERROR, "--objective", "survival")
    assert code == 0
    assert "survives" in out
    code, out, err = ran("fly", SHORT, *risky, "--out", tmp_path)
    assert code == 1
    assert "abstained" in out
    assert "not to be flown" in err
    assert "planner.abstain_below is 100 %" in err
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]
    assert Plan.load(tmp_path / "plan.json").outcome.abstained
    code, _, err = ran("plan", SHORT, *risky, "--export", tmp_path / "route.gpx")
    assert code == 1
    assert "not to be flown" in err
    assert not (tmp_path / "route.gpx").exists()


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
        (["--key", "a"], ["one array", "'a'"]),
        (["--members", "a"], ["one array", "'a'"]),
        (["--steps-per-stage", "0"], ["must be positive"]),
        (["--steps-per-stage", "-2"], ["must be positive"]),
        (["--step-s", "0"], ["must be positive"]),
        (["--step-s", "nan"], ["finite"]),
        (["--gamma", "inf"], ["gamma", "inf"]),
        (["--beta", "-1"], ["beta", "not negative"]),
        (["--goal", "0,9"], ["(0, 9)", "2 rows and 5 columns"]),
        (["--goal", "x"], ["'x'", "ROW,COLUMN"]),
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


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--departures", "0:600:30"], ["horizon", "60 min"]),
        (["--departures", "0:x"], ["'0:x'"]),
        (["--departures", "0:20:10", "--planner", "windaware"], ["--departures", "--planner staged"]),
        (["--isochrones", "x.npy", "--planner", "windaware"], ["--isochrones", "--planner staged"]),
        (["--departures", "0:20:10", "--isochrones", "x.npy"], ["one departure"]),
        (["--departures", "0:20:10", "--best-by", "survival"], ["hazard.forecast_error_mps"]),
        (["--departures", "0:20:10", "--objective", "score"], ["--objective"]),
        (["--distinct"], ["--departures"]),
        (["--objective", "best"], ["planner.objective", "'best'"]),
        (["--objective", "fuel"], ["'fuel'", "windaware"]),
        (["--objective", "survival"], ["hazard.forecast_error_mps"]),
        (["--abstain-below", "0.5"], ["hazard.forecast_error_mps"]),
        (["--abstain-below", "7", *ERROR], ["abstain_below is 7"]),
        (["--set", "mission.start.lat_deg=50"], ["start Here"]),
        (["--set", "mission.goals=[{name='There', lat_deg=29.7, lon_deg=-70}]"], ["goal There"]),
        (["--set", "mission.goals=[]"], ["mission.goals"]),
        (["--set", "stages.steps=0"], ["stages.steps is 0"]),
        (["--set", "stages.count=-1"], ["stages.count is -1"]),
        (["--set", "stages.step_s=0"], ["stages.step_s is 0"]),
        (["--set", "planner.beta=inf"], ["planner.beta is inf", "finite"]),
        (["--set", "hazard.forecast_error_mps=nan"], ["forecast_error_mps is nan"]),
        (["--start", "0,0"], ["--start", "--hazards"]),
        (["--alpha", "2"], ["--alpha", "--set"]),
        (["--exact"], ["--exact"]),
        (["--goal", "a", "--goal", "b"], ["one --goal"]),
    ],
)
def test_bad_options_for_a_scenario_are_named(ran, more, words):
    code, out, err = ran("plan", SHORT, *more)
    assert code == 2, out
    assert all(word in err for word in words), err


def test_the_objective_has_a_short_name(ran):
    code, out, _ = ran("plan", SHORT, "--objective", "score", "--json")
    assert code == 0
    plan = json.loads(out)
    assert plan["objective"] == "score"
    (goal,) = plan["goals"]
    assert sum(goal["terms"].values()) == pytest.approx(goal["score"])
    assert goal["stages"] == [
        {"stage": 0, "reachable": True, "arrival_s": goal["arrival_s"], "score": goal["score"]}
    ]
    code, out, _ = ran("plan", SHORT, "--set", "stages.steps=3", "--json")
    assert code == 1
    (goal,) = json.loads(out)["goals"]
    assert 0.0 < goal["nearest"]["distance_m"] < 40_000.0
    assert goal["nearest"]["arrival_s"] == 240.0
    assert goal["last_door_stage"] == 0
    code, out, _ = ran("plan", SHORT, "--set", "stages.steps=3")
    assert "nearest 29." in out
    assert "last door in stage 0" in out


def test_a_horizon_of_one_step_reaches_the_cell_that_it_starts_in(ran):
    one_step = ("--set", "stages.steps=1", "--json")
    code, out, _ = ran("plan", SHORT, *one_step)
    assert code == 1
    assert json.loads(out)["goals"][0]["reason"] == "no safe way leads there within the horizon"
    here = "lat_deg=29.6, lon_deg=-90.6"
    twice = f'mission.goals=[{{name="There", {here}}}, {{name="Here too", {here}}}]'
    code, out, _ = ran("plan", SHORT, "--set", twice, *one_step)
    assert code == 0
    assert [goal["arrival_s"] for goal in json.loads(out)["goals"]] == [0.0, 0.0]
