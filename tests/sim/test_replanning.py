"""Flights whose forecasts turn out wrong: the plan changes on the way, without a jump, for a reason told."""

import math
from pathlib import Path

import numpy as np
import pytest

import recordings
from planner.windfield import WindField
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Layer, Outcome, Recorders
from recordings.rerun_writer import RerunRecorder
from recordings.tracking import track
from sim.closed_loop import fly
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import load_scenario
from sim.weather.source import MissionWeather, bring_weather

CROSSING = Path(__file__).parent / "scenarios" / "crossing.toml"
GALE_MPS, BREEZE_MPS = 18.0, 3.0


def ignore(_):
    pass


def nowhere(stage, lat_deg, lon_deg):
    return np.zeros_like(lat_deg, bool)


def barrier(stage, lat_deg, lon_deg):
    """From early in the second stage on, all across the way."""
    return (lon_deg > -90.38) & (lon_deg < -90.33) & (stage > 1.2)


def spur(stage, lat_deg, lon_deg):
    """The same, with a way round it in the north."""
    return barrier(stage, lat_deg, lon_deg) & (lat_deg < 29.45)


def aside(stage, lat_deg, lon_deg):
    """North of the way, now farther and now nearer."""
    return lat_deg > 29.37 + 0.1 * (stage % 1.0)


def passing(stage, lat_deg, lon_deg):
    """The barrier, gone in the fifth stage."""
    return barrier(stage, lat_deg, lon_deg) & (stage < 3.9)


def blowing(like, clock_s, stages, where):
    """A breeze to the east, and a gale in places."""
    time_s = like.time_s[0] + clock_s * np.arange(0.0, stages, 0.5)
    lat_deg, lon_deg = np.meshgrid(
        np.degrees(like.grid.lat_rad), np.degrees(like.grid.lon_rad), indexing="ij"
    )
    sheets = [
        np.where(where(stage, lat_deg, lon_deg), GALE_MPS, BREEZE_MPS)
        for stage in np.arange(0.0, stages, 0.5)
    ]
    return WindField(like.grid, time_s, np.zeros((len(time_s), *like.grid.shape)), np.stack(sheets))


@pytest.fixture(scope="module")
def misled():
    """A flight planned with the first of some forecasts: (forecasts, truth, overrides) -> setup."""

    def made(forecasts, truth, *overrides):
        loaded = load_scenario(str(CROSSING), ("turbulence.kind=none", *overrides))
        stages, aircraft = loaded.scenario.stages, make_aircraft(loaded.scenario)
        like, clock_s = bring_weather(loaded).forecast, stages.steps * stages.step_s
        winds = [blowing(like, clock_s, stages.count + 3, where) for where in forecasts]
        weather = MissionWeather(
            winds[0],
            blowing(like, clock_s, stages.count + 3, truth),
            issued=lambda stage: winds[min(stage, len(winds) - 1)],
        )
        return prepare_flight(loaded, weather, make_plan(loaded.scenario, weather, aircraft), aircraft)

    return made


@pytest.fixture
def flown(misled, tmp_path):
    """The end of such a flight and its report: (forecasts, truth, overrides) -> (end, report)."""

    def made(*case):
        path = tmp_path / "flight.mcap"
        end = fly(misled(*case), McapRecorder(path), ignore)
        return end, track(recordings.open(path))

    return made


@pytest.fixture(scope="module")
def crossed(misled, tmp_path_factory):
    """The MCAP file of a flight that goes round the spur, beside its Rerun file, and its end."""
    path = tmp_path_factory.mktemp("crossed") / "flight.mcap"
    both = Recorders([McapRecorder(path), RerunRecorder(path.with_suffix(".rrd"))])
    return path, fly(misled([nowhere, spur], spur), both, ignore)


def closely(report):
    """Nothing of a change is to be seen in how the references were followed."""
    return (
        report.cross_track_m.max < 2.0
        and report.altitude_error_m.max < 2.0
        and report.waypoint_time_error_s.max < 5.0
        and report.waypoints_missed == 0
    )


def test_never_flies_into_the_hazard_that_each_stage_goes_round(flown, crossed):
    end, report = flown([nowhere, spur], spur, "planner.replan=never")
    assert end.outcome is Outcome.ARRIVED
    assert report.hazard_exposure_s > 20.0
    assert (report.forecasts, report.plan_changes, report.replanning) == (0, 0, ())
    path, end = crossed
    report = track(recordings.open(path))
    assert (end.outcome, end.detail) == (Outcome.ARRIVED, "passed There")
    assert report.arrived
    assert report.destination == report.goal == "There"
    assert report.hazard_exposure_s == 0.0
    assert report.min_clearance_m > 3000.0
    assert report.plan_changes == 1
    first, *others = report.replanning
    assert first.startswith(
        "forecast of 00:08 UTC, stage 1: the old plan ran into hazard at 00:14 UTC; a new one arrives at 00:"
    )
    assert others == [
        f"forecast of 00:{8 * stage:02d} UTC, stage {stage}: unchanged"
        for stage in range(2, report.forecasts + 1)
    ]
    assert "plan changed         1 ×, at" in report.summary()
    assert report.flight_time_s > report.planned_time_s + 600.0
    assert closely(report)
    assert report.holds == 0


def test_a_goal_out_of_reach_is_given_up_for_another_one(flown):
    end, report = flown([nowhere, barrier], barrier, "planner.if_unreachable=alternate")
    assert end.outcome is Outcome.DIVERTED
    assert end.detail == "diverted to Beside: no route to There after the forecast of 00:08 UTC"
    assert not report.arrived
    assert (report.goal, report.destination) == ("There", "Beside")
    assert "diverted to Beside" in report.replanning[0]
    assert "did not arrive at There" in report.summary()
    assert closely(report)


@pytest.mark.slow
def test_a_goal_out_of_reach_is_given_up_for_the_start(flown):
    end, report = flown([nowhere, barrier], barrier, "planner.if_unreachable=return")
    assert end.outcome is Outcome.RETURNED
    assert end.detail == "returned to Here: no route to There after the forecast of 00:08 UTC"
    assert not report.arrived
    assert report.destination == "Here"
    assert closely(report)


def test_it_waits_until_a_way_to_the_goal_opens_and_leaves_its_circle_then(flown, tmp_path):
    end, report = flown([nowhere, barrier, barrier, barrier, passing], passing, "planner.if_unreachable=wait")
    assert (end.outcome, end.detail) == (Outcome.ARRIVED, "passed There")
    assert report.arrived
    assert report.plan_changes == 2
    assert "no route to There" in report.replanning[0]
    assert report.replanning[0].endswith("waiting where it is safe")
    assert report.replanning[3].endswith("stage 4: a way to There has opened")
    assert report.hazard_exposure_s == 0.0
    assert report.holds == 0
    assert closely(report)
    events = [event.text for event in recordings.open(tmp_path / "flight.mcap").events]
    assert events.count("loiter begins") == events.count("loiter ends") == 1


@pytest.mark.slow
def test_a_wait_that_comes_to_nothing_ends_when_the_forecast_does(flown):
    end, report = flown([nowhere, barrier], barrier, "stages.count=3")
    assert end.outcome is Outcome.NO_ROUTE
    assert end.detail == "waited until 00:22 UTC: no route to There after the forecast of 00:08 UTC"
    assert not report.arrived
    assert report.hazard_exposure_s == 0.0


@pytest.mark.parametrize("objective", ["score", pytest.param("survival", marks=pytest.mark.slow)])
def test_forecasts_that_say_the_truth_change_nothing(misled, kept, objective):
    overrides = (f"planner.objective={objective}", "hazard.forecast_error_mps=3", "stages.count=4")
    never, each = kept, type(kept)()
    fly(misled([aside], aside, *overrides, "planner.replan=never"), never, ignore)
    fly(misled([aside] * 4, aside, *overrides), each, ignore)
    assert each.samples == never.samples
    assert each.end == never.end
    assert each.references == []
    assert [issue.changed for issue in each.plans] == [False] * len(each.plans)
    assert len(each.plans) == int(each.end[0] // 480.0) >= 2


@pytest.mark.slow
def test_without_forecasts_of_its_own_a_scenario_replans_on_that_of_departure(ready, kept):
    setup = ready("planner.replan=each_stage", "stages.count=3", "stages.steps=5")
    assert fly(setup, kept, ignore).outcome is Outcome.ARRIVED
    assert len(kept.plans) >= 1
    assert all(issue.reason.endswith("unchanged") and not issue.changed for issue in kept.plans)


@pytest.mark.slow
def test_the_same_forecasts_give_the_same_file(misled, crossed, tmp_path):
    again = tmp_path / "again.mcap"
    fly(misled([nowhere, spur], spur), McapRecorder(again), ignore)
    assert again.read_bytes() == crossed[0].read_bytes()


def test_the_recording_holds_every_plan_and_each_forecast_at_its_time(crossed):
    path, _ = crossed
    found = recordings.open(path)
    first, second, *others = found.plans
    assert first.plan == found.header.plan
    assert (second.time_s, second.changed) == (480.0, True)
    assert all(not issue.changed and issue.plan is second.plan for issue in others)
    assert [issue.time_s for issue in others] == [480.0 * stage for stage in range(2, 2 + len(others))]
    flown = found.first_waypoints[1]
    assert second.plan.waypoints[: flown + 1] == first.plan.waypoints[: flown + 1]
    assert second.plan.waypoints != first.plan.waypoints
    assert second.plan.departure_s == first.plan.departure_s
    assert second.plan.outcome.arrival_s == second.plan.duration_s
    assert [goal.name for goal in second.plan.goals] == ["There", "Beside"]
    forecasts = [sheet for sheet in found.hazards if sheet.layer is Layer.FORECAST]
    assert [sheet.stage for sheet in forecasts] == list(range(len(forecasts)))
    assert not forecasts[1].hazard.any() or forecasts[1].time_s == 480.0
    assert forecasts[2].hazard.any()
    without_a_jump(found)
    other = recordings.open(path.with_suffix(".rrd"))
    assert other.plans == found.plans
    assert track(other).to_json() == track(found).to_json()


def without_a_jump(recording, change=0):
    """Where a reference takes over from another it is where that one is, and so is what guidance saw."""
    (_, old), (time_s, new) = recording.references[change : change + 2]
    path_m = old.path_at_time(time_s)
    was, now = old.at(path_m), new.at(new.path_at_time(time_s))
    assert math.dist(was[:3], now[:3]) < 1e-3
    assert math.remainder(was.course_rad - now.course_rad, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    seen = recording.guidance
    near = seen[np.abs(seen["time_s"] - time_s) < 0.35]
    assert len(near) == 7
    for name, most in (("cross_track_m", 0.05), ("altitude_error_m", 0.1), ("time_error_s", 0.05)):
        assert np.ptp(near[name]) < most, name
    assert np.abs(np.diff(near["command_roll_rad"])).max() < 0.02


WINDAWARE = "planner.kind=windaware"


def test_the_wind_aware_planner_goes_round_what_never_flies_into(flown, tmp_path):
    end, report = flown([nowhere, spur], spur, WINDAWARE, "planner.replan=never")
    assert end.outcome is Outcome.ARRIVED
    assert report.hazard_exposure_s > 20.0
    end, report = flown([nowhere, spur], spur, WINDAWARE)
    assert (end.outcome, end.detail) == (Outcome.ARRIVED, "passed There")
    assert report.hazard_exposure_s == 0.0
    assert report.plan_changes == 1
    assert closely(report)
    first, *others = report.replanning
    assert first.startswith("forecast of 00:08 UTC, stage 1: the old plan ran into hazard at 00:1")
    assert all(other.endswith("unchanged") for other in others)
    found = recordings.open(tmp_path / "flight.mcap")
    before, after, *_ = found.plans
    assert (after.time_s, after.changed, after.plan.planner) == (480.0, True, "windaware")
    flown_by_then = found.first_waypoints[1]
    left = after.plan.waypoints[flown_by_then]
    assert after.plan.waypoints[: flown_by_then + 1] == before.plan.waypoints[: flown_by_then + 1]
    assert 480.0 < left.time_s < 800.0
    assert left.time_s % 120.0 > 1.0  # at any time, not at a step
    assert after.plan.outcome.arrival_s == after.plan.duration_s
    without_a_jump(found)


def test_the_wind_aware_planner_waits_until_a_way_opens(flown):
    forecasts = [nowhere, barrier, barrier, barrier, passing]
    end, report = flown(forecasts, passing, WINDAWARE, "planner.if_unreachable=wait")
    assert (end.outcome, end.detail) == (Outcome.ARRIVED, "passed There")
    assert report.plan_changes == 2
    assert report.replanning[0].endswith("waiting where it is safe")
    assert report.replanning[3].endswith("stage 4: a way to There has opened")
    assert report.hazard_exposure_s == 0.0
    assert closely(report)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("instead", "outcome", "where"),
    [("alternate", Outcome.DIVERTED, "Beside"), ("return", Outcome.RETURNED, "Here")],
)
def test_the_wind_aware_planner_gives_up_a_goal_out_of_reach(flown, instead, outcome, where):
    end, report = flown([nowhere, barrier], barrier, WINDAWARE, f"planner.if_unreachable={instead}")
    assert end.outcome is outcome
    assert report.destination == where
    assert end.detail.endswith(f"to {where}: no route to There after the forecast of 00:08 UTC")
    assert report.hazard_exposure_s == 0.0
    assert closely(report)


@pytest.mark.parametrize(
    "objective",
    ["earliest", *(pytest.param(name, marks=pytest.mark.slow) for name in ("score", "survival", "fuel"))],
)
def test_forecasts_that_say_the_truth_change_nothing_for_the_wind_aware_planner(misled, kept, objective):
    overrides = (f"planner.objective={objective}", "hazard.forecast_error_mps=3", "stages.count=4", WINDAWARE)
    never, each = kept, type(kept)()
    fly(misled([aside], aside, *overrides, "planner.replan=never"), never, ignore)
    fly(misled([aside] * 4, aside, *overrides), each, ignore)
    assert each.samples == never.samples
    assert each.end == never.end
    assert each.references == []
    assert len(each.plans) == int(each.end[0] // 480.0) >= 2
    assert not any(issue.changed for issue in each.plans)


def overrun(stage, lat_deg, lon_deg):
    """The barrier, and from the fourth stage on a gale over the country west of it, but for the south."""
    gale = (lon_deg > -90.72) & (lat_deg > 29.22) & (lon_deg < -90.33) & (stage > 3.2)
    return barrier(stage, lat_deg, lon_deg) | gale


LATE = [nowhere, barrier, barrier, barrier, overrun]
LEAVES = "forecast of 00:32 UTC, stage 4: the way ahead is in hazard: leaves it toward the "


@pytest.mark.parametrize(
    ("kind", "outcome", "told"),
    [
        ("staged", Outcome.NO_ROUTE, "south, 11 km, then waiting where it is safe: no route to There ("),
        ("windaware", Outcome.ARRIVED, "east, 11 km, then on to There, arriving at 00:43 UTC"),
    ],
)
def test_a_wait_that_hazard_overruns_is_left(flown, tmp_path, kind, outcome, told):
    planner = f"planner.kind={kind}"
    _, kept = flown(LATE[:4], overrun, planner)  # the last forecast knows nothing of the gale
    end, report = flown(LATE, overrun, planner)
    assert end.outcome is outcome
    assert report.replanning[3].startswith(LEAVES + told)
    assert report.plan_changes == 2
    assert report.hazard_exposure_s < 0.55 * kept.hazard_exposure_s
    assert closely(report)
    found = recordings.open(tmp_path / "flight.mcap")
    without_a_jump(found, change=1)
