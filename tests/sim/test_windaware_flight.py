"""Wind-aware plans flown on the real aircraft through changing wind: on time, and at the fuel foreseen."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from recordings.recorder import Outcome
from sim.closed_loop import fly
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import load_scenario
from sim.weather.source import MissionWeather, bring_weather

SHORT = Path(__file__).parent / "scenarios" / "short.toml"
CALM_AIR = ("turbulence.kind=none", "planner.kind=windaware", "stages.steps=5", "stages.count=6")


def flight(kept, *overrides):
    """Plan and fly the short mission while its wind veers and grows; the plan, the end, the samples."""
    loaded = load_scenario(str(SHORT), [*CALM_AIR, *overrides])
    aircraft = make_aircraft(loaded.scenario)
    wind = bring_weather(loaded).forecast
    time_s = wind.time_s[0] + np.arange(13) * 300.0
    turned = np.linspace(0.0, 2.0, time_s.size)[:, np.newaxis, np.newaxis]
    shear = np.linspace(2.0, 9.0, wind.grid.columns)
    north, east = np.sin(turned) * shear, np.cos(turned) * shear
    north, east = (np.broadcast_to(part, (13, *wind.grid.shape)).copy() for part in (north, east))
    wind = replace(wind, time_s=time_s, north_mps=north, east_mps=east)
    weather = MissionWeather(wind, wind)
    plan = make_plan(loaded.scenario, weather, aircraft)
    end = fly(prepare_flight(loaded, weather, plan, aircraft), kept, lambda _: None)
    assert end.outcome is Outcome.ARRIVED
    return plan, end


@pytest.mark.parametrize("objective", ["earliest", "survival"])
def test_the_arrival_is_met_within_half_a_per_cent(kept, objective):
    plan, end = flight(kept, f"planner.objective={objective}", "hazard.forecast_error_mps=3")
    assert end.time_s == pytest.approx(plan.outcome.arrival_s, rel=0.005)
    assert 0.0 < plan.outcome.survival < 1.0


def test_fuel_is_burned_as_planned_and_less_of_it_than_at_cruise(kept):
    plan, end = flight(kept, "planner.objective=fuel")
    burned_kg = [state.fuel_kg for state, _ in kept.samples if state.time_s >= 0.0]
    assert burned_kg[0] - burned_kg[-1] == pytest.approx(plan.outcome.fuel_kg, rel=0.05)
    assert end.time_s == pytest.approx(plan.outcome.arrival_s, rel=0.005)
    assert plan.outcome.arrival_s > plan.outcome.earliest_arrival_s


@pytest.mark.slow
@pytest.mark.parametrize("objective", ["earliest", "fuel"])
def test_ian_is_met_within_half_a_per_cent(galeway, tmp_path, objective):
    settings = ("turbulence.kind=none", f"planner.objective={objective}", "mission.goal=Havana")
    options = [word for setting in settings for word in ("--set", setting)]
    done = galeway("fly", "ian", "--planner", "windaware", *options, "--out", str(tmp_path))
    assert "arrived" in done.stdout, done.stdout + done.stderr
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["flight_time_s"] == pytest.approx(report["planned_time_s"], rel=0.005)
