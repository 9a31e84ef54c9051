"""What has to fit together where the wind differs by height: levels to choose among, and soundings."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from sim.errors import ScenarioError
from sim.weather_tables import Weather

if TYPE_CHECKING:
    from sim.scenario import Mission, PlannerTable

LEVELS_APART_M = 40.0
"""Between two levels at least: less is lost in gusts."""


def check_levels(mission: Mission, weather: Weather, planner: PlannerTable, source: str) -> None:
    """Whether the planner can choose among levels, if it is asked to.

    Raises:
        ScenarioError: naming the levels, what they do not go with and what to write instead.
    """
    if not mission.levels_m:
        return
    levels_m = mission.all_levels_m
    where = f"{source}: mission.levels_m ({', '.join(f'{level_m:g}' for level_m in mission.levels_m)})"
    for low_m, high_m in pairwise(levels_m):
        if high_m - low_m < LEVELS_APART_M:
            raise ScenarioError(
                f"{where} with mission.altitude_m has {low_m:g} and {high_m:g} m, which are less than "
                f"{LEVELS_APART_M:g} m apart; leave out one of them"
            )
    if len(levels_m) == 1:
        raise ScenarioError(f"{where} names no altitude but mission.altitude_m; add others, or leave it out")
    if planner.kind != "windaware":
        raise ScenarioError(
            f"{where} lets the planner choose among levels, which the {planner.kind} planner does not; set "
            'planner.kind = "windaware", or leave it out to fly at mission.altitude_m'
        )
    if planner.objective == "fuel":
        raise ScenarioError(
            f"{where} does not go with planner.objective 'fuel', since consumption is measured at one "
            "altitude and in level flight; choose earliest, score or survival, or leave it out"
        )
    if planner.replan != "never":
        raise ScenarioError(
            f"{where} does not go with planner.replan {planner.replan!r}, which plans anew at one altitude; "
            'set planner.replan = "never", or leave it out'
        )
    if weather.storm is not None or weather.calm:
        wind = f"the wind of the storm {weather.storm}" if weather.storm else "calm air"
        raise ScenarioError(
            f"{where} leaves nothing to choose: {wind} is the same at all heights; leave it out, or bring "
            "weather with heights as weather.file"
        )
    if weather.error.kind != "none":
        raise ScenarioError(
            f"{where} does not go with weather.error.kind {weather.error.kind!r}, whose forecasts err at one "
            "altitude; set it to none, or leave levels_m out"
        )


def check_sounding(weather: Weather, source: str) -> None:
    """Whether a sounding is in order, if there is one.

    Raises:
        ScenarioError: naming what to change.
    """
    for below, above in pairwise(weather.sounding):
        if not below.height_m < above.height_m:
            raise ScenarioError(
                f"{source}: weather.sounding goes from {below.height_m:g} to {above.height_m:g} m; "
                "let the heights rise"
            )
    if weather.sounding and weather.error.kind != "none":
        raise ScenarioError(
            f"{source}: weather.error.kind {weather.error.kind!r} is for storms and files, and the weather "
            "is a sounding; set it to none"
        )
