"""Forecasts of a storm that turn out wrong: errors of track and intensity that grow with lead time.

The error of a forecast is u(issue, valid) times the published deviation at its lead, where u is smooth
Gaussian noise of variance 1. It is correlated along the valid time, so that a forecast's track is smooth, and
from issue to issue, so that one forecast resembles the next. A forecast knows the storm up to its issue.

A member of the ensemble is the forecast less an error of its own, drawn the same way. As the truth, too, is
the forecast less its error, truth and members are alike: which is which cannot be told from the forecast.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from planner.windfield import WindField
from sim.weather.best_track import BestTrackFix
from sim.weather.issues import LazyMembers, error_rng
from sim.weather.lead_errors import intensity_deviation_mps, track_deviation_m
from sim.weather.smooth_noise import NoiseAxis, SmoothNoise
from sim.weather.vortex import Shift, vortex_field

Floats = NDArray[np.float64]

VALID_LENGTH_S = 12.0 * 3600.0
"""Over which the errors of one forecast are correlated."""

ISSUE_LENGTH_S = 12.0 * 3600.0
"""Over which those of successive forecasts are."""

WEAKEST_MPS = 5.0
"""Maximum wind below which no forecast goes."""


class ErrorTrack:
    """One realisation of the errors of all forecasts issued from a time on."""

    def __init__(self, begin_s: float, end_s: float, rng: np.random.Generator, scale: float = 1.0) -> None:
        self._begin_s, self._scale = begin_s, scale
        axes = (
            NoiseAxis(0.0, end_s - begin_s, ISSUE_LENGTH_S),
            NoiseAxis(0.0, end_s - begin_s, VALID_LENGTH_S),
        )
        self._north, self._east, self._stronger = (SmoothNoise(axes, rng) for _ in range(3))

    def at(self, issue_s: float, time_s: Floats) -> tuple[Floats, Floats, Floats]:
        """How far north and east [m] a forecast puts the centre, how much stronger [m/s], shape (T,)."""
        lead_s = np.maximum(time_s - issue_s, 0.0)
        track_m = self._scale * track_deviation_m(lead_s)
        wind_mps = self._scale * intensity_deviation_mps(lead_s)
        asked = issue_s - self._begin_s, time_s - self._begin_s
        north, east, stronger = (noise.on(*asked)[0] for noise in (self._north, self._east, self._stronger))
        return track_m * north, track_m * east, wind_mps * stronger


@dataclass(frozen=True)
class StormForecasts:
    """All forecasts of one storm for one mission.

    Attributes:
        fixes: the true ones.
        grid: where the wind is wanted.
        time_s: when, shape (T,) [s since 1970-01-01 UTC]; the first is the departure.
        stage_s: from one issue to the next.
        seed: of the scenario.
        scale: times the published errors.
    """

    fixes: Sequence[BestTrackFix]
    grid: Grid
    time_s: Floats
    stage_s: float
    seed: int
    scale: float = 1.0

    def truth(self) -> WindField:
        """The storm on its best track."""
        return vortex_field(self.fixes, self.grid, self.time_s)

    def issued(self, stage: int) -> WindField:
        """The forecast that is issued when a stage begins; that of stage 0 is issued at departure."""
        return self._shifted(*self.error(stage, 0))

    def members(self, stage: int, count: int) -> LazyMembers:
        """The ensemble that comes with that forecast."""
        forecast = self.error(stage, 0)

        def member(index: int) -> WindField:
            own = self.error(stage, index + 1)
            return self._shifted(*(ours - its for ours, its in zip(forecast, own, strict=True)))

        return LazyMembers(count, member)

    def error(self, stage: int, member: int) -> tuple[Floats, Floats, Floats]:
        """The error of a forecast (member 0) or the own one of a member, as `ErrorTrack.at` gives it."""
        begin_s, end_s = float(self.time_s[0]), float(self.time_s[-1])
        errors = ErrorTrack(begin_s, end_s, error_rng(self.seed, member), self.scale)
        return errors.at(begin_s + stage * self.stage_s, self.time_s)

    def _shifted(self, north_m: Floats, east_m: Floats, stronger_mps: Floats) -> WindField:
        fix_s = [fix.time_s for fix in self.fixes]
        true_mps = np.interp(self.time_s, fix_s, [fix.max_wind_mps for fix in self.fixes])
        strength = np.maximum(true_mps + stronger_mps, WEAKEST_MPS) / true_mps
        shifts = [Shift(*map(float, off)) for off in zip(north_m, east_m, strength, strict=True)]
        return vortex_field(self.fixes, self.grid, self.time_s, shifts=shifts)
