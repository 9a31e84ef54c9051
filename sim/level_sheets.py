"""The weather to record of a flight that changes level: always that of the level it is at.

Between two levels it is that of both and of the heights between: hazardous where any of them is, the wind as
it is half-way.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from planner.hazards import Bools, StageClock, strongest_mps
from planner.windfield import FieldArray, WindField
from recordings.recorder import Layer, WeatherSheet
from sim.clock import make_clock
from sim.scenario import Scenario
from sim.weather.at_levels import laid_out
from sim.weather.source import MissionWeather

_NEAR_M = 25.0  # of a level counts as at it: gusts
_NEAR_SHARE = 0.25  # of the way to the next, if that is less


class LevelLayer:
    """One layer at all heights.

    `wind`: on the flight's grid, its heights those of the levels and between. `closed`: at each height what
    is hazardous besides the wind, [stage, north, east], or None; empty where nothing is at any.
    """

    def __init__(
        self,
        layer: Layer,
        wind: WindField,
        closed: Sequence[Bools | None],
        *,
        corridor_m: float,
        threshold_mps: float,
        clock: StageClock,
    ) -> None:
        """See the class; `corridor_m`: half width of the room kept below the threshold."""
        assert wind.height_m is not None
        self.layer, self.wind, self.closed, self.clock = layer, wind, closed, clock
        self.height_m: list[float] = wind.height_m.tolist()
        self._corridor_m, self._threshold_mps = corridor_m, threshold_mps
        self._peaks_mps = lru_cache(maxsize=None)(self._peaks)

    def _peaks(self, height: int) -> FieldArray:
        at_height = self.wind.at_altitude(self.height_m[height])
        return strongest_mps(at_height, self.clock, corridor_m=self._corridor_m)

    def hazard(self) -> Bools:
        """Hazardous at any of the heights, [stage, north, east]."""
        every = [self._hazard(stage, range(len(self.height_m))) for stage in range(self.clock.stage_count)]
        return np.stack(every)

    def _hazard(self, stage: int, heights: range) -> Bools:
        hazard = self._peak(stage, heights) > self._threshold_mps
        closed = self._closed(stage, heights)
        return hazard if closed is None else hazard | closed

    def _peak(self, stage: int, heights: range) -> FieldArray:
        peak: FieldArray = np.maximum.reduce([self._peaks_mps(height)[stage] for height in heights])
        return peak

    def _closed(self, stage: int, heights: range) -> Bools | None:
        known = [self.closed[height] for height in heights] if self.closed else []
        closed = [sheets[stage] for sheets in known if sheets is not None]
        return np.logical_or.reduce(closed) if closed else None

    def sheet(self, stage: int, heights: range, time_s: float) -> WeatherSheet:
        """The sheet of a stage at one height, or at several next to each other."""
        middle_m = 0.5 * (self.height_m[heights[0]] + self.height_m[heights[-1]])
        north, east = self.wind.at_altitude(middle_m).sheet(self.clock.span_s(stage)[0])
        return WeatherSheet(
            layer=self.layer,
            stage=stage,
            time_s=time_s,
            hazard=self._hazard(stage, heights),
            wind_north_mps=north.astype(np.float32),
            wind_east_mps=east.astype(np.float32),
            peak_mps=self._peak(stage, heights).astype(np.float32),
            closed=self._closed(stage, heights),
            altitude_m=middle_m,
        )


class LevelWatch:
    """Says for one flight what is to be recorded when it comes to another stage or level."""

    def __init__(self, layers: tuple[LevelLayer, ...], levels_m: tuple[float, ...]) -> None:
        """For layers of the same heights, of which `levels_m` are those to stay at."""
        self.layers, self._levels_m = layers, levels_m
        self._clock = layers[0].clock
        self._shown: tuple[int, range] | None = None
        self.news: list[str] = []

    def due(self, time_s: float, altitude_m: float) -> list[WeatherSheet]:
        """The sheets to record now, none while the flight is where it was; `news` tells of its level."""
        stage, heights = self._clock.stage_at(time_s), self._heights_at(altitude_m)
        self.news = []
        if (stage, heights) == self._shown:
            return []
        if self._shown is not None and self._shown[1] != heights:
            self.news = [self._told(self._shown[1], heights)]
        self._shown = stage, heights
        return [layer.sheet(stage, heights, time_s) for layer in self.layers]

    def _heights_at(self, altitude_m: float) -> range:
        """The height of the level that the flight is at, or all from the level below it to that above."""
        heights_m, levels_m = self.layers[0].height_m, self._levels_m
        nearest = min(levels_m, key=lambda level_m: abs(level_m - altitude_m))
        toward = [m for m in levels_m if (m - nearest) * (altitude_m - nearest) > 0.0]
        if not toward:
            return _only(heights_m.index(nearest))
        other = min(toward, key=lambda level_m: abs(level_m - nearest))
        if abs(altitude_m - nearest) <= min(_NEAR_M, _NEAR_SHARE * abs(other - nearest)):
            return _only(heights_m.index(nearest))
        low, high = sorted((heights_m.index(nearest), heights_m.index(other)))
        return range(low, high + 1)

    def _told(self, before: range, after: range) -> str:
        heights_m = self.layers[0].height_m
        if len(after) == 1:
            return f"level: at {heights_m[after[0]]:.0f} m"
        if len(before) == 1 and before[0] in after:
            other = after[-1] if before[0] == after[0] else after[0]
            verb = "climbs" if other > before[0] else "descends"
            return f"level: {verb} from {heights_m[before[0]]:.0f} m toward {heights_m[other]:.0f} m"
        return f"level: between {heights_m[after[0]]:.0f} m and {heights_m[after[-1]]:.0f} m"


def _only(height: int) -> range:
    return range(height, height + 1)


def level_watch(scenario: Scenario, weather: MissionWeather) -> LevelWatch | None:
    """For a flight that may change level; None for another."""
    levels = weather.levels
    if levels is None:
        return None
    threshold_mps, clock = scenario.hazard.mean_threshold_mps, make_clock(scenario)
    height_m = np.array(levels.height_m)
    planned = [None if also.planned is None else also.planned.closed for also in levels.also]
    forecast = LevelLayer(
        Layer.FORECAST,
        levels.forecast,
        planned,
        corridor_m=scenario.hazard.corridor_m,
        threshold_mps=threshold_mps,
        clock=clock,
    )
    truth = LevelLayer(
        Layer.TRUTH,
        laid_out(weather.truth, height_m, levels.forecast.grid),
        [also.true for also in levels.also],
        corridor_m=0.0,
        threshold_mps=threshold_mps,
        clock=clock,
    )
    return LevelWatch((forecast, truth), scenario.mission.all_levels_m)
