"""What many flights share, made once a process: the weather of the last one, and plans.

Two flights share weather if their scenarios differ in nothing but what `weather_part` leaves out; likewise
their plans. Whatever is not known to make no difference, makes one.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

import msgspec

from aircraft.jsbsim_aircraft import JsbsimAircraft
from planner.plans import Plan
from sim.preparation import make_plan
from sim.scenario import AircraftTable, Flight, LoadedScenario, PlannerTable, Scenario, TurbulenceTable
from sim.weather.source import MissionWeather, bring_weather

MOST_PLANS = 64
"""Kept at once; a plan takes some hundred kilobytes at most."""

Made = TypeVar("Made")


def plan_part(scenario: Scenario) -> Scenario:
    """The scenario without what its plan has nothing to do with.

    The seed stays where forecasts err, since it decides how.
    """
    seed = scenario.seed if depends_on_seed(scenario) else 0
    return msgspec.structs.replace(
        scenario,
        name="plan",
        description="",
        seed=seed,
        limits=(),
        faults=(),
        flight=Flight(),
        turbulence=TurbulenceTable(),
    )


def weather_part(scenario: Scenario) -> Scenario:
    """The scenario without what its weather has nothing to do with."""
    return msgspec.structs.replace(
        plan_part(scenario),
        mission=msgspec.structs.replace(scenario.mission, goal=""),
        planner=PlannerTable(),
        aircraft=AircraftTable(),
    )


def depends_on_seed(scenario: Scenario) -> bool:
    """Whether another seed is other weather."""
    return scenario.weather.error.kind != "none"


class _Kept(Generic[Made]):
    """The last few of what was made, by what it was made from."""

    def __init__(self, most: int) -> None:
        self._most, self._made = most, OrderedDict[Hashable, Made]()

    def get(self, key: Hashable, make: Callable[[], Made]) -> Made:
        if key not in self._made:
            while len(self._made) >= self._most:  # before the next one is made: there may be no room for both
                self._made.popitem(last=False)
            self._made[key] = make()
        self._made.move_to_end(key)
        return self._made[key]

    def clear(self) -> None:
        """Keep nothing."""
        self._made.clear()


_weather = _Kept[MissionWeather](1)
_plans = _Kept[Plan](MOST_PLANS)


def forget() -> None:
    """Have the next flight make everything itself."""
    _weather.clear()
    _plans.clear()


def weather_of(loaded: LoadedScenario) -> MissionWeather:
    """The scenario's weather, that of an earlier flight if it is the same.

    Raises:
        SimError: see `bring_weather`.
    """
    return _weather.get((loaded.folder, weather_part(loaded.scenario)), lambda: bring_weather(loaded))


def plan_of(loaded: LoadedScenario, weather: MissionWeather, aircraft: JsbsimAircraft) -> Plan:
    """The scenario's plan, that of an earlier flight if it is the same.

    Raises:
        PlannerError: see `make_plan`.
    """
    key = (loaded.folder, plan_part(loaded.scenario))
    return _plans.get(key, lambda: make_plan(loaded.scenario, weather, aircraft))
