"""What flights share is what each would make for itself."""

import inspect
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import sim.clock
import sim.hazards
import sim.weather
from sim.campaign import shared
from sim.campaign.shared import plan_of, plan_part, weather_of, weather_part
from sim.preparation import make_aircraft, make_plan, planning_request
from sim.weather.source import bring_weather

SAME_WEATHER = [
    ["turbulence.severity=0"],
    ["turbulence.severity=6"],
    ["flight.sensors=gps"],
    ['limits=["arrived == true"]'],
    ["planner.kind=windaware"],
    ["aircraft.turn_radius_m=300.0"],
]
OTHER_WEATHER = [
    ["mission.departure=2022-09-29T01:00:00Z"],
    ["mission.altitude_m=900.0"],
    ["grid.cell_m=800.0"],
    ["stages.count=2"],
    ["weather.storm=AL092021"],
    ["weather.truth.speed_factor=1.5"],
    ["weather.error.kind=growing"],
    ["hazard.threshold_mps=12.0"],
]


@pytest.mark.parametrize("overrides", SAME_WEATHER, ids=str)
def test_weather_is_shared_and_the_same(hop, overrides):
    first, second = hop(seed=1).load(), hop(*overrides, seed=2).load()
    kept = weather_of(first)
    assert weather_of(second) is kept
    own = bring_weather(second)
    for field in ("forecast", "truth"):
        for component in ("north_mps", "east_mps", "time_s"):
            assert np.array_equal(
                getattr(getattr(kept, field), component), getattr(getattr(own, field), component)
            )


@pytest.mark.parametrize("overrides", OTHER_WEATHER, ids=str)
def test_what_changes_the_weather_is_not_shared(hop, overrides):
    assert weather_part(hop().load().scenario) != weather_part(hop(*overrides).load().scenario)


def test_a_seed_is_other_weather_where_forecasts_err(hop):
    erring = [hop("weather.error.kind=growing", seed=seed).load() for seed in (1, 2)]
    first, second = (weather_of(loaded) for loaded in erring)
    assert first is not second
    assert not np.array_equal(first.forecast.north_mps, second.forecast.north_mps)
    assert np.array_equal(second.forecast.north_mps, bring_weather(erring[1]).forecast.north_mps)


def test_plans_are_shared_by_seeds_and_turbulence_alone(hop):
    plans = []
    for overrides in ((), ("turbulence.severity=6",), ("planner.kind=windaware",)):
        loaded = hop(*overrides, seed=len(plans)).load()
        aircraft = make_aircraft(loaded.scenario)
        plans.append(plan_of(loaded, weather_of(loaded), aircraft))
        own = make_plan(loaded.scenario, bring_weather(loaded), aircraft)
        assert plans[-1].to_json() == own.to_json()
    assert plans[0] is plans[1]
    assert plans[1] is not plans[2]
    for overrides in ("hazard.corridor_m=0.0", "planner.airspeed_margin_mps=3.0", "aircraft.model=c172p"):
        assert plan_part(hop(overrides).load().scenario) != plan_part(hop().load().scenario)


def test_nothing_is_made_of_what_is_left_out_of_its_part():
    """Of the modules that make weather, and the functions that plan, as they are written."""
    modules = [*Path(sim.weather.__path__[0]).glob("*.py"), *Path(sim.hazards.__path__[0]).glob("*.py")]
    weather = [path.read_text() for path in [*modules, Path(sim.clock.__file__)]]
    assert len(weather) > 20
    left_out = "name|description|limits|faults|flight|turbulence"
    assert not re.findall(rf"scenario\.(?:planner|aircraft|mission\.goal\b|{left_out})\b", "".join(weather))
    plan = "".join(map(inspect.getsource, (make_plan, planning_request)))
    assert "scenario.planner" in plan
    assert not re.findall(rf"scenario\.(?:seed|{left_out})\b", plan)


def test_only_the_last_weather_is_kept_and_so_many_plans(hop):
    kept = shared._Kept(2)
    made = []

    def make(number):
        made.append(number)
        return number

    for number in (1, 2, 1, 3, 1, 2):
        kept.get(number, lambda number=number: make(number))
    assert made == [1, 2, 3, 2]
    one, other = hop().load(), hop("mission.altitude_m=900.0").load()
    weather = [weather_of(loaded) for loaded in (one, other, one)]
    assert all(before is not after for before, after in pairwise(weather))
