"""The survival objective planned on the ensemble that comes with a forecast of a storm."""

import numpy as np
import pytest

from planner.hazards import strongest_mps
from planner.survival import probability_from_members, survival_of
from sim.clock import make_clock
from sim.errors import HazardError
from sim.preparation import make_aircraft, make_plan
from sim.scenario import load_scenario
from sim.weather.source import bring_weather

COARSE = ["grid.cell_m=14400.0", "stages.step_s=450.0", "stages.steps=8", "hazard.corridor_m=1100.0"]
WRONG = ["weather.error.kind=growing", "weather.error.members=8"]
CHANCE = ['hazard.also=[{kind="ensemble", more_than=1.0, blur_cells=1.0}]', "seed=2"]


def planned(*overrides):
    loaded = load_scenario("henri", [*COARSE, *WRONG, *CHANCE, *overrides])
    weather = bring_weather(loaded)
    return loaded.scenario, weather, make_plan(loaded.scenario, weather, make_aircraft(loaded.scenario))


def test_the_chance_is_that_of_the_members_and_the_safest_way_has_the_best():
    scenario, weather, safest = planned("planner.objective=survival")
    _, _, earliest = planned("planner.objective=earliest")
    assert earliest.outcome.survival < safest.outcome.survival - 0.05
    clock, room_m = make_clock(scenario), scenario.hazard.corridor_m
    members = np.array(
        [
            strongest_mps(wind, clock, corridor_m=room_m) > scenario.hazard.threshold_mps
            for wind in weather.members(0)
        ]
    )
    chance = probability_from_members(members, blur_cells=1.0)
    for plan in (safest, earliest):
        cells = [
            weather.forecast.grid.nearest_cell(np.radians(w.lat_deg), np.radians(w.lon_deg))
            for w in plan.waypoints
        ]
        steps = np.rint([w.time_s / clock.step_s for w in plan.waypoints]).astype(int)
        every = [cells[np.searchsorted(steps, step, side="right") - 1] for step in range(steps[-1] + 1)]
        expected = survival_of(every, 0, chance, clock).at_least
        assert plan.outcome.survival == pytest.approx(expected, rel=1e-6)


def test_without_members_there_is_no_chance_to_survive():
    with pytest.raises(HazardError, match="the weather has none"):
        planned("weather.error.members=0")
