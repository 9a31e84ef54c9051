"""The scenarios of storms that ship: in each the storm's motion decides the route.

Planned on coarse cells, for speed; the same storm is planned through as it stood at departure, and that plan
is held against the storm as it moved.
"""

from dataclasses import replace
from typing import NamedTuple

import msgspec
import numpy as np
import pytest

from planner.plans import Plan
from planner.windfield import WindField
from sim.preparation import make_aircraft, make_plan
from sim.scenario import load_scenario
from sim.weather.source import MissionWeather, bring_weather

HOUR_S = 3600.0
COARSE = ["grid.cell_m=10800.0", "stages.step_s=360.0", "stages.steps=10"]


class Planned(NamedTuple):
    moving: Plan
    frozen: Plan
    truth: WindField


@pytest.fixture(scope="module")
def planned():
    """Plans a scenario through its storm and through the storm as it stands at departure."""
    return {name: plan_both(name) for name in ("fiona", "henri", "ida")}


def plan_both(name):
    loaded = load_scenario(name, COARSE)
    mission = loaded.scenario.mission
    only = tuple(goal for goal in mission.goals if goal.name == mission.goal)
    scenario = msgspec.structs.replace(loaded.scenario, mission=msgspec.structs.replace(mission, goals=only))
    aircraft, weather = make_aircraft(scenario), bring_weather(loaded)
    stood = frozen(weather.truth)
    return Planned(
        make_plan(scenario, weather, aircraft),
        make_plan(scenario, MissionWeather(stood, stood), aircraft),
        weather.truth,
    )


def frozen(wind):
    """The wind of departure for good."""
    north, east = (np.repeat(part[:1], len(wind.time_s), axis=0) for part in (wind.north_mps, wind.east_mps))
    return replace(wind, north_mps=north, east_mps=east)


def strongest_on_the_way(plan, wind):
    """The highest wind that an aircraft on time would meet at its waypoints and between them [m/s]."""
    time_s, lat_deg, lon_deg = np.transpose([(w.time_s, w.lat_deg, w.lon_deg) for w in plan.waypoints])
    often_s = np.arange(0.0, time_s[-1], 60.0)
    north, east, _ = wind.at_many(
        plan.departure_s + often_s,
        np.radians(np.interp(often_s, time_s, lat_deg)),
        np.radians(np.interp(often_s, time_s, lon_deg)),
    )
    return float(np.hypot(north, east).max())


@pytest.mark.parametrize("name", ["fiona", "henri", "ida"])
def test_the_plan_is_safe_in_the_storm_as_it_moves(planned, name):
    assert planned[name].moving.waypoints
    assert strongest_on_the_way(planned[name].moving, planned[name].truth) < 15.0


def test_fiona_opens_bermuda_by_leaving_it(planned):
    assert not planned["fiona"].frozen.waypoints
    assert planned["fiona"].moving.outcome.earliest_arrival_s < 13 * HOUR_S


@pytest.mark.parametrize(("name", "costs_h"), [("henri", 1.5), ("ida", 2.0)])
def test_the_storm_comes_first_and_has_to_be_waited_for(planned, name, costs_h):
    moving, stood, truth = planned[name]
    assert moving.outcome.arrival_s > stood.outcome.arrival_s + costs_h * HOUR_S
    assert moving.outcome.waiting_s > costs_h * HOUR_S
    assert stood.outcome.waiting_s == 0.0
    assert strongest_on_the_way(stood, truth) > 15.0  # the storm would have been in the way


def test_henri_is_passed_on_its_other_side(planned):
    """Behind it, out at sea, where the standing storm would have been passed along the coast."""

    def middle_deg(plan):
        """The longitude at which the route crosses 39 degrees north."""
        lat_deg, lon_deg = np.transpose([(w.lat_deg, w.lon_deg) for w in plan.waypoints])
        return float(np.interp(39.0, lat_deg, lon_deg))

    assert middle_deg(planned["henri"].moving) > -71.0 > -72.5 > middle_deg(planned["henri"].frozen)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fiona", "henri", "ida"])
def test_it_is_flown_and_passes_its_own_limits(name, galeway, tmp_path):
    done = galeway("fly", name, "--out", str(tmp_path / name))
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("PASS") == 5


def test_they_are_listed(galeway):
    listed = galeway("scenarios").stdout
    for name, storm in (("fiona", "Fiona"), ("henri", "Henri"), ("ian", "Ian"), ("ida", "Ida")):
        assert f"{name:10s} Hurricane {storm}, " in listed
