"""A day to be flown: the mission within an aircraft's limits, and the scenario around it."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from aircraft.envelope import Envelope
from planner.ground import Cell, Ground, Occupancy
from planner.hazards import flyable_moves, strongest_mps
from planner.plans import GoalOutcome, Plan
from planner.route import evaluate
from planner.score import Weights
from planner.staged_outcome import waypoints
from planner.windfield import WindField
from sim.reproduce.forecasts import DayForecasts
from sim.reproduce.outlook import Case, Outlook
from sim.scenario import LoadedScenario, parse_scenario
from sim.weather.source import MissionWeather

CORRIDOR_M = 1100.0
MARGIN_MPS = 2.0
ALTITUDE_M = 1000.0
SEVERITY = 3
GOAL = "goal"


@dataclass(frozen=True)
class FlownDay:
    """One day at one level of error, within an envelope.

    Unlike on the paper's maps a cell is closed where the wind is over the threshold anywhere in the corridor
    around it, moves have to be flyable, and both cells of a move safe in every stage that it touches.
    """

    forecasts: DayForecasts
    envelope: Envelope

    @cached_property
    def forecast(self) -> WindField:
        """As of departure, on the planner's cells."""
        return self._on_cells(self.forecasts.wind(0))

    @cached_property
    def weather(self) -> MissionWeather:
        """What a flight needs."""
        return MissionWeather(self.forecast, replace(self.forecasts.day.wind, hold=True))

    def case(self) -> Case:
        """The mission; the oracle sees the truth with its corridor and its moves."""
        day = self.forecasts.day
        start, goals = day.mission
        truth = self._ground(self._on_cells(day.wind))
        return Case(start, goals, truth, self._outlook(0), self._outlook)

    def judged(self) -> Ground:
        """The truth by which a plan is safe: at the centres of the cells, without a corridor."""
        return Ground(self.forecasts.day.truth, self.forecasts.day.clock, Occupancy.STRICT)

    def plan(self, name: str, way: tuple[Cell, ...]) -> Plan:
        """A way as a plan to be flown."""
        day = self.forecasts.day
        route = evaluate(way, np.zeros(day.truth.shape), day.clock, Weights())  # its clearance is not asked
        goal = GoalOutcome(GOAL, *self._degrees(way[-1]), reachable=True)
        points = waypoints(route, day.grid, day.clock, ALTITUDE_M)
        return Plan("staged", name, day.clock.departure_s, GOAL, points, (goal,))

    def scenario(self, name: str, seed: int, way: tuple[Cell, ...]) -> LoadedScenario:
        """The scenario of a flight along a way; its file stands for the day's wind, which is made."""
        day = self.forecasts.day
        grid, world = day.grid, day.world
        south, north = math.degrees(grid.lat_rad[0]), math.degrees(grid.lat_rad[-1])
        west, east = math.degrees(grid.lon_rad[0]), math.degrees(grid.lon_rad[-1])
        toml = f"""name = "{name}"
description = "Day {day.seed} of galeway reproduce: wind of {world.system_m / 1e3:g} km systems"
seed = {seed}
[mission]
departure = 1970-01-02T00:00:00Z
altitude_m = {ALTITUDE_M}
goal = "{GOAL}"
start = {self._place("start", way[0])}
goals = [{self._place(GOAL, way[-1])}]
[weather]
file = "day-{day.seed}.nc"
[grid]
cell_m = {world.cell_m}
south_deg = {south}
north_deg = {north}
west_deg = {west}
east_deg = {east}
[stages]
count = {world.stage_count}
steps = {world.steps_per_stage}
step_s = {world.step_s}
[hazard]
threshold_mps = {world.threshold_mps}
corridor_m = {CORRIDOR_M}
[planner]
airspeed_margin_mps = {MARGIN_MPS}
[turbulence]
severity = {SEVERITY}
[flight]
sample_hz = 5
late_limit_s = 900.0
"""
        return LoadedScenario(parse_scenario(tomllib.loads(toml), name), toml, Path())

    def _place(self, name: str, cell: Cell) -> str:
        lat_deg, lon_deg = self._degrees(cell)
        return f'{{ name = "{name}", lat_deg = {lat_deg}, lon_deg = {lon_deg} }}'

    def _degrees(self, cell: Cell) -> tuple[float, float]:
        grid = self.forecasts.day.grid
        return math.degrees(grid.lat_rad[cell[0]]), math.degrees(grid.lon_rad[cell[1]])

    def _outlook(self, stage: int) -> Outlook:
        forecast = self.forecast if stage == 0 else self._on_cells(self.forecasts.wind(stage))
        ground = self._ground(forecast)
        return Outlook(
            lambda: ground.hazard,
            self.forecasts.ensemble(stage),
            ground.clock,
            ground.occupancy,
            ground.flyable,
        )

    def _ground(self, wind: WindField) -> Ground:
        clock, world = self.forecasts.day.clock, self.forecasts.day.world
        peaks_mps = strongest_mps(wind, clock, corridor_m=CORRIDOR_M)
        flyable = flyable_moves(
            wind,
            clock,
            airspeed_min_mps=self.envelope.airspeed_min_mps + MARGIN_MPS,
            airspeed_max_mps=self.envelope.airspeed_max_mps - MARGIN_MPS,
        )
        return Ground(peaks_mps > world.threshold_mps, clock, Occupancy.STRICT, flyable)

    def _on_cells(self, wind: WindField) -> WindField:
        return wind.resampled(self.forecasts.day.grid)
