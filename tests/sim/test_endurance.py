"""A plan that the tanks do not suffice for is told before the flight; others are not."""

from dataclasses import replace

import pytest

from aircraft.description import load_aircraft
from aircraft.own_models import envelope_of
from sim.endurance import short_of_fuel

ALTITUDE_M = 1000.0


@pytest.fixture(params=["aerosonde", "c172p"])
def aircraft(request):
    return load_aircraft(request.param)


def lasting(plan, duration_s):
    """The plan with its last waypoint at another time."""
    *before, last = plan.waypoints
    return replace(plan, waypoints=(*before, replace(last, time_s=duration_s)))


def told(plan, aircraft):
    return short_of_fuel(plan, aircraft, envelope_of(aircraft).cruise_mps, ALTITUDE_M)


def test_endurance_decides(ready, aircraft):
    plan = ready().header.plan
    endurance_h = {"aerosonde": 31.9, "c172p": 10.8}[aircraft.name]
    assert told(plan, aircraft) is None
    assert told(lasting(plan, (endurance_h - 0.1) * 3600.0), aircraft) is None
    text = told(lasting(plan, (endurance_h + 0.1) * 3600.0), aircraft)
    assert text.startswith(f"the way to {plan.goal} takes")
    assert aircraft.name in text
    assert f"enough for {int(endurance_h)}:" in text


def test_what_a_plan_says_it_burns_decides(ready, aircraft):
    plan = ready().header.plan
    goal = replace(plan.outcome, fuel_kg=1000.0)
    goals = tuple(goal if other.name == goal.name else other for other in plan.goals)
    assert "about 1000.0 kg" in told(replace(plan, goals=goals), aircraft)


def test_without_a_route_nothing_is_told(ready, aircraft):
    assert told(replace(lasting(ready().header.plan, 1e6), waypoints=()), aircraft) is None


def test_it_is_told_with_the_plan(galeway, tmp_path):
    thirsty = (
        "--set",
        "aircraft.model=c172p",
        "--set",
        "grid.cell_m=6000",
        "--set",
        "hazard.corridor_m=2000",
    )
    done = galeway("plan", "ian", "--goal", "Miami", *thirsty)
    assert done.returncode == 0
    assert "c172p holds 167.0 kg, enough for 10:" in " ".join(done.stderr.split())
