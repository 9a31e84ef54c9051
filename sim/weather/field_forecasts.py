"""Forecasts of a gridded wind that turn out wrong: weather that lies elsewhere and is stronger or weaker.

The forecast at a place is the true wind some way off, times a factor: F(x, t) = exp(a) T(x + d, t). The
displacement d and the logarithm a are smooth Gaussian noise over the area, the valid time and the time of
issue, times a deviation that grows with lead time. Displacements are as large as published track errors of
storms, since no table for winds at large is as widely used; the deviation of a is that of the published
intensity errors, as a share of a hurricane's least wind, 64 kt.

A member of the ensemble has the forecast's error less one of its own, drawn the same way. So truth and
members are alike: each lies its own error away from what the forecast has at a place.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from planner.windfield import WindField
from sim.weather.best_track import KNOT_MPS
from sim.weather.issues import LazyMembers, error_rng
from sim.weather.lead_errors import intensity_deviation_mps, track_deviation_m
from sim.weather.smooth_noise import NoiseAxis, SmoothNoise
from sim.weather.storm_forecasts import ISSUE_LENGTH_S, VALID_LENGTH_S

Floats = NDArray[np.float64]

AREA_LENGTH_M = 500e3
"""Over which errors are correlated in space: the size of the weather that is misplaced."""

_EARTH_RADIUS_M = 6371008.8
_HURRICANE_MPS = 64.0 * KNOT_MPS


class FieldError(NamedTuple):
    """What is wrong with a forecast, each of shape (T, rows, columns)."""

    north_m: Floats
    east_m: Floats
    log_factor: Floats

    def less(self, other: FieldError) -> FieldError:
        """The difference of two errors."""
        return FieldError(*(mine - its for mine, its in zip(self, other, strict=True)))


@dataclass(frozen=True)
class FieldForecasts:
    """All forecasts of one gridded truth for one mission.

    Attributes:
        truth: without heights; beyond its area its outermost values hold.
        grid: of the planner, inside the truth's area.
        begin_s: the departure [s since 1970-01-01 UTC].
        stage_s: from one issue to the next.
        seed: of the scenario.
        scale: times the errors above.
    """

    truth: WindField
    grid: Grid
    begin_s: float
    stage_s: float
    seed: int
    scale: float = 1.0

    @cached_property
    def _held(self) -> WindField:
        return replace(self.truth, hold=True)

    def issued(self, stage: int) -> WindField:
        """The forecast that is issued when a stage begins; that of stage 0 is issued at departure."""
        time_s = self._time_s(stage)
        return self._wrong(time_s, self.error(stage, time_s, 0))

    def members(self, stage: int, count: int) -> LazyMembers:
        """The ensemble that comes with that forecast."""
        time_s = self._time_s(stage)
        forecast = self.error(stage, time_s, 0)

        def member(index: int) -> WindField:
            return self._wrong(time_s, forecast.less(self.error(stage, time_s, index + 1)))

        return LazyMembers(count, member)

    def _issue_s(self, stage: int) -> float:
        return self.begin_s + stage * self.stage_s

    def _time_s(self, stage: int) -> Floats:
        """The truth's times, and that of the issue, from which on errors grow."""
        times_s = self.truth.time_s
        inside = [time_s for time_s in [self._issue_s(stage)] if times_s[0] < time_s < times_s[-1]]
        return np.union1d(times_s, inside)

    def error(self, stage: int, time_s: Floats, member: int) -> FieldError:
        """The error of a forecast (member 0) or the own one of a member, at times within the truth's."""
        grid, issue_s = self.grid, self._issue_s(stage)
        first_s, last_s = (float(end_s) - self.begin_s for end_s in self.truth.time_s[[0, -1]])
        lead_s = np.maximum(time_s - issue_s, 0.0)[:, np.newaxis, np.newaxis]
        north_m = _EARTH_RADIUS_M * (grid.lat_rad - grid.lat_rad[0])
        east_m = _EARTH_RADIUS_M * np.cos(grid.lat_rad.mean()) * (grid.lon_rad - grid.lon_rad[0])
        axes = (
            NoiseAxis(0.0, last_s, ISSUE_LENGTH_S),
            NoiseAxis(first_s, last_s, VALID_LENGTH_S),
            NoiseAxis(0.0, float(north_m[-1]), AREA_LENGTH_M),
            NoiseAxis(0.0, float(east_m[-1]), AREA_LENGTH_M),
        )
        rng = error_rng(self.seed, member)
        asked = issue_s - self.begin_s, time_s - self.begin_s, north_m, east_m
        north, east, stronger = (SmoothNoise(axes, rng).on(*asked)[0] for _ in range(3))
        displaced_m = self.scale * track_deviation_m(lead_s)
        factor = self.scale * intensity_deviation_mps(lead_s) / _HURRICANE_MPS
        return FieldError(displaced_m * north, displaced_m * east, factor * stronger)

    def _wrong(self, time_s: Floats, error: FieldError) -> WindField:
        """The truth as it is elsewhere and stronger."""
        lat_rad = self.grid.lat_rad[:, np.newaxis] + error.north_m / _EARTH_RADIUS_M
        parallel_m = _EARTH_RADIUS_M * np.cos(self.grid.lat_rad)[:, np.newaxis]
        lon_rad = self.grid.lon_rad + error.east_m / parallel_m
        north_mps, east_mps, _ = self._held.at_many(time_s[:, np.newaxis, np.newaxis], lat_rad, lon_rad)
        factor = np.exp(error.log_factor)
        return WindField(
            self.grid,
            time_s,
            (factor * north_mps).astype(np.float32),
            (factor * east_mps).astype(np.float32),
            hold=self.truth.hold,
        )
