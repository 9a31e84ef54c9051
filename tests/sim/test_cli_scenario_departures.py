"""Departures, survival and isochrones of a scenario, and what bad input says."""

import json
from pathlib import Path

import pytest

from planner.plans import Plan

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")
ERROR = ("--set", "hazard.forecast_error_mps=4")


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
