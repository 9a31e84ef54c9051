"""A storm forecast as wrong as such forecasts are: what `never` leads into, `each_stage` leads round."""

import json
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from planner.revision import Branch, Purpose, choose
from planner.windaware_replanning import WindawareProspect
from sim.preparation import make_aircraft, make_plan, planning_request
from sim.scenario import load_scenario
from sim.weather.source import bring_weather

WRONG = ("weather.error.kind=growing", "seed=2")  # at the published mean errors
COARSE = ("grid.cell_m=16200.0", "stages.step_s=600.0", "stages.steps=6")
THRESHOLD_MPS = 15.0


@pytest.fixture(scope="module")
def misled():
    """Ida with her errors, on large cells, to Mobile: request, weather, plan of departure."""
    loaded = load_scenario("ida", [*COARSE, *WRONG])
    mission = loaded.scenario.mission
    only = tuple(goal for goal in mission.goals if goal.name == mission.goal)
    scenario = msgspec.structs.replace(loaded.scenario, mission=msgspec.structs.replace(mission, goals=only))
    aircraft, weather = make_aircraft(scenario), bring_weather(loaded)
    request = planning_request(scenario, weather, aircraft)
    return request, weather, make_plan(scenario, weather, aircraft)


def is_wait(plan, place):
    before, point = plan.waypoints[place - 1], plan.waypoints[place]
    return (before.lat_deg, before.lon_deg) == (point.lat_deg, point.lon_deg)


def branch_after(plan, time_s):
    """The next waypoint that an aircraft on time can leave the plan at; a wait some laps after it began."""
    for place, point in list(enumerate(plan.waypoints))[1:]:
        if is_wait(plan, place):
            from_s = max(plan.waypoints[place - 1].time_s, time_s) + 300.0
            if from_s < point.time_s:
                return Branch(plan, place, from_s, True)
        elif point.time_s > time_s + 60.0:
            return Branch(plan, place, 0.0, False)
    return None


def replanned(request, weather, plan):
    """The plan that is flown if each stage's forecast is planned on, and what was said of each."""
    clock, purpose, told = request.clock, Purpose.GOAL, []
    for stage in range(1, clock.stage_count):
        branch = branch_after(plan, stage * clock.stage_s)
        if branch is None:
            break
        prospect = WindawareProspect.of(replace(weather.issued(stage), hold=True), request)
        options = prospect.options(branch, (stage + 1) * clock.stage_s)
        assert options is not None
        revision = choose(options, purpose, Purpose.WAIT, request.start.name)
        told.append(revision.reason)
        if revision.plan is not None:
            flown = plan.waypoints[: branch.place]
            plan, purpose = (
                replace(revision.plan, waypoints=(*flown, *revision.plan.waypoints)),
                revision.purpose,
            )
    return plan, told


def strongest_mps(plan, wind):
    """The highest wind that an aircraft on time meets."""
    time_s, lat_deg, lon_deg = np.transpose([(w.time_s, w.lat_deg, w.lon_deg) for w in plan.waypoints])
    often_s = np.arange(0.0, time_s[-1], 30.0)
    north, east, _ = wind.at_many(
        plan.departure_s + often_s,
        np.radians(np.interp(often_s, time_s, lat_deg)),
        np.radians(np.interp(often_s, time_s, lon_deg)),
    )
    return float(np.hypot(north, east).max())


def test_the_plan_of_departure_leads_into_hazard_and_the_one_of_each_stage_round_it(misled):
    request, weather, plan = misled
    assert strongest_mps(plan, weather.forecast) < THRESHOLD_MPS < strongest_mps(plan, weather.truth)
    home = replace(request, goals=(*request.goals, request.start))
    final, told = replanned(home, weather, plan)
    assert final.goal == "Mobile"
    assert final.duration_s > plan.duration_s + 3600.0
    assert strongest_mps(final, weather.truth) < THRESHOLD_MPS
    assert sum("the old plan ran into hazard at" in reason for reason in told) >= 3


@pytest.mark.slow
def test_flown_too(galeway, tmp_path):
    reports = {}
    for replan in ("never", "each_stage"):
        folder = tmp_path / replan
        options = [word for change in (*WRONG, f"planner.replan={replan}") for word in ("--set", change)]
        done = galeway("fly", "ida", *options, "--out", str(folder))
        assert "arrived" in done.stdout, done.stdout + done.stderr
        reports[replan] = json.loads((folder / "report.json").read_text())
    assert reports["never"]["hazard_exposure_s"] > 60.0
    assert reports["each_stage"]["hazard_exposure_s"] < 0.1 * reports["never"]["hazard_exposure_s"]
    assert reports["each_stage"]["plan_changes"] >= 3
    assert reports["each_stage"]["arrived"]
