"""Statistics of a speed, and its share over a threshold by stage, gathered as its times go by."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.weather.levels import Levels

Floats = NDArray[np.float64]

STAGE_S = 3600.0


@dataclass(frozen=True, slots=True)
class SpeedAtLevel:
    """Statistics of a speed at one level over all times, members and places [m/s]."""

    level: str
    mean_mps: float
    p95_mps: float
    highest_mps: float


@dataclass(frozen=True, slots=True)
class StageShare:
    """The share of points that at some time of a stage are over the threshold, at each level, 0 to 1.

    NaN where nothing is known of any time of it.
    """

    begin_s: float
    over: tuple[float, ...]


class Tally:
    """Statistics and stages of a speed, gathered as its times go by."""

    def __init__(self, levels: int, threshold_mps: float) -> None:
        self.threshold_mps = threshold_mps
        self.missing = self.values = 0
        self.edges_mps = np.arange(0.0, 200.1, 0.1)
        self.counts = np.zeros((levels, self.edges_mps.size - 1))
        self.sums, self.highest = np.zeros(levels), np.full(levels, np.nan)
        self.stages: list[StageShare] = []
        self.begin_s = self.last_s = math.nan
        self.last: list[Floats] = []
        self.over: NDArray[np.bool_] | None = None

    def add(self, time_s: float, parts: list[Floats]) -> None:
        """One time more."""
        speed = self._counted(parts)
        if self.over is None:
            self.begin_s, self.over = time_s, speed > self.threshold_mps
        else:
            while self.begin_s + STAGE_S < time_s - 1.0:  # a stage ends between two times: linear in between
                weight = (self.begin_s + STAGE_S - self.last_s) / (time_s - self.last_s)
                between = [(1.0 - weight) * a + weight * b for a, b in zip(self.last, parts, strict=True)]
                self._next_stage(_speed(between))
            if abs(self.begin_s + STAGE_S - time_s) <= 1.0:
                self._next_stage(speed)
            else:
                self.over |= speed > self.threshold_mps
        self.last_s, self.last = time_s, parts

    def add_window(self, begin_s: float, end_s: float, parts: list[Floats]) -> None:
        """One window more, whose values hold for all stages that have a part of it, and for no others."""
        over = self._counted(parts) > self.threshold_mps
        if math.isnan(self.begin_s):
            self.begin_s = self.last_s = begin_s
        while self.begin_s + STAGE_S <= begin_s + 1.0:
            self._end_stage()
        while True:
            self.over = over if self.over is None else self.over | over
            self.last_s = min(end_s, self.begin_s + STAGE_S)
            if end_s <= self.begin_s + STAGE_S + 1.0:
                return
            self._end_stage()

    def _end_stage(self) -> None:
        unknown = (math.nan,) * len(self.sums)
        shares = unknown if self.over is None else _shares(self.over)
        self.stages.append(StageShare(self.begin_s, shares))
        self.begin_s, self.over = self.begin_s + STAGE_S, None

    def _counted(self, parts: list[Floats]) -> Floats:
        """The speed that parts make, after it has been counted."""
        speed = _speed(parts)
        self.missing += int(np.count_nonzero(np.isnan(speed)))
        self.values += speed.size
        for level in range(speed.shape[1]):
            here = speed[:, level][np.isfinite(speed[:, level])]
            self.counts[level] += np.histogram(here, self.edges_mps)[0]
            self.sums[level] += here.sum()
            if here.size:
                self.highest[level] = np.fmax(self.highest[level], here.max())
        return speed

    def _next_stage(self, speed: Floats) -> None:
        assert self.over is not None
        over = speed > self.threshold_mps
        self.stages.append(StageShare(self.begin_s, _shares(self.over | over)))
        self.begin_s, self.over = self.begin_s + STAGE_S, over

    def finished(self) -> list[StageShare]:
        """The stages, and what is left of one that the times do not fill."""
        if self.over is not None and (self.last_s > self.begin_s or not self.stages):
            return [*self.stages, StageShare(self.begin_s, _shares(self.over))]
        return self.stages

    def speeds(self, levels: Levels) -> tuple[SpeedAtLevel, ...]:
        """The statistics by level."""
        found = []
        for level, counts in enumerate(self.counts):
            total = counts.sum()
            part = np.cumsum(counts) / total if total else np.full(counts.shape, np.nan)
            p95 = float(np.interp(0.95, part, self.edges_mps[1:])) if total else math.nan
            one = levels._replace(values=levels.values[level : level + 1])
            mean = float(self.sums[level] / total) if total else math.nan
            highest = float(self.highest[level])  # which lies within its bin, below the edge that p95 may be
            found.append(SpeedAtLevel(one.describe(), mean, min(p95, highest), highest))
        return tuple(found)


def _speed(parts: list[Floats]) -> Floats:
    return np.asarray(np.hypot(*parts) if len(parts) == 2 else parts[0])


def _shares(over: NDArray[np.bool_]) -> tuple[float, ...]:
    return tuple(over.mean(axis=(0, 2, 3)).tolist())
