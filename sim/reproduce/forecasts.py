"""Forecasts of a day that turn out wrong, by the project's own model of errors, each with its ensemble."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from planner.ground import Ground, Occupancy
from planner.windfield import WindField
from sim.reproduce.days import Day, hazard_of
from sim.reproduce.ensembles import NodeEnsemble
from sim.reproduce.outlook import Case, Floats, Outlook
from sim.weather.field_forecasts import FieldError, FieldForecasts

MEMBERS = 20


@dataclass(frozen=True)
class DayForecasts:
    """All forecasts of a day; their errors are the published means times `scale`."""

    day: Day
    scale: float
    members: int = MEMBERS

    @cached_property
    def _made(self) -> FieldForecasts:
        day, world = self.day, self.day.world
        return FieldForecasts(
            truth=day.wind,
            grid=world.nodes,
            begin_s=world.clock.departure_s - world.age_s,
            stage_s=world.clock.stage_s,
            seed=day.seed,
            scale=self.scale,
        )

    def wind(self, stage: int) -> WindField:
        """The forecast in force when a stage begins, on the nodes."""
        return self._made.issued(stage)

    def outlook(self, stage: int) -> Outlook:
        """What is known when a stage begins, of that stage and those to come."""
        day = self.day
        return Outlook(lambda: hazard_of(self.wind(stage), day.world), self.ensemble(stage), day.clock)

    def case(self) -> Case:
        """The day's mission on these forecasts."""
        start, goals = self.day.mission
        truth = Ground(self.day.truth, self.day.clock, Occupancy.PAPER)
        return Case(start, goals, truth, self.outlook(0), self.outlook)

    def ensemble(self, stage: int) -> NodeEnsemble:
        """The members that come with the forecast, from that stage on; the stages before are left calm."""
        world, made = self.day.world, self._made
        clock = world.clock
        stages: Floats = np.arange(stage, clock.stage_count + 1, dtype=np.float64)
        time_s: Floats = clock.departure_s + stages * clock.stage_s
        forecast = made.error(stage, time_s, 0)
        peaks = np.zeros((self.members, world.stage_count, *world.nodes.shape), dtype=np.float32)
        for member in range(self.members):
            speed = self._speed_mps(time_s, forecast.less(made.error(stage, time_s, member + 1)))
            peaks[member, stage:] = np.maximum(speed[:-1], speed[1:])
        return NodeEnsemble(peaks, world)

    def _speed_mps(self, time_s: Floats, error: FieldError) -> NDArray[np.float32]:
        """The wind speed on the nodes with an error, at times of the truth: what `members` would give."""
        wind, nodes = self.day.wind, self.day.world.nodes
        rows, columns = np.indices(nodes.shape, dtype=np.float64)
        places = np.searchsorted(wind.time_s, time_s).tolist()
        speed = np.empty((len(places), *nodes.shape), dtype=np.float32)
        for at, place in enumerate(places):
            where = np.stack(
                [
                    rows + error.north_m[at] / nodes.north_cell_m[0],
                    columns + error.east_m[at] / nodes.east_cell_m[0],
                ]
            )
            north, east = (
                ndimage.map_coordinates(part[place], where, order=1, mode="nearest")
                for part in (wind.north_mps, wind.east_mps)
            )
            speed[at] = np.exp(error.log_factor[at]) * np.hypot(north, east)
        return speed
