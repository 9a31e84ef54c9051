"""Whether to hold: an aircraft too early for its slowest airspeed waits by its path, where that is safe."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from aircraft.guidance import Guidance, Progress
from aircraft.holding import Hold, HoldLimits, lay_hold
from aircraft.schedule import End
from aircraft.state import FlightState
from aircraft.watch import Path
from planner.grid import Grid
from planner.hazards import StageClock

_ASKED_AGAIN_S = 5.0
_ON_PATH_M = 20.0
_ON_A_LINE = 1e-4  # of a cell, in which a place on the line between two cells may be off it by rounding


@dataclass(frozen=True, slots=True, eq=False)
class SafePlaces:
    """Where the forecast allows to circle.

    `hazard`: of the forecast as planned on, with the corridor, shape [stage, north, east] on `grid`. A place
    with the four cells around it is as safe as the plan's moves: the wind within the corridor around it is a
    blend of theirs (ARCHITECTURE.md, invariant 1; `planner.legs`), and a circle that is no wider stays in it.
    """

    grid: Grid
    clock: StageClock
    hazard: NDArray[np.bool_]

    def may_hold(self, from_s: float, north_m: float, east_m: float, until_s: float) -> bool:
        """Whether the room around a place is without hazard for some time, seconds since departure."""
        if until_s > self.clock.stage_count * self.clock.stage_s:
            return False  # the forecast that was planned on ends there
        row, column = self.grid.indices(*self.grid.frame.to_geodetic(north_m, east_m))
        rows, columns = _around(float(row)), _around(float(column))
        if (
            rows.start < 0
            or columns.start < 0
            or rows.stop > self.grid.rows
            or columns.stop > self.grid.columns
        ):
            return False
        stages = slice(self.clock.stage_at(from_s), self.clock.stage_at(until_s) + 1)
        return not self.hazard[stages, rows, columns].any()


def _around(index: float) -> slice:
    """The cells on both sides of a place in one axis; one, where it lies on it."""
    return slice(math.ceil(index - 1.0 + _ON_A_LINE), math.floor(index + 1.0 - _ON_A_LINE) + 1)


class Holding:
    """Decides for one flight; see `aircraft.holding` for what is flown.

    `early_s`: time error, early negative, below which there is anything to decide; the only thing that a
    flight on time has to look at.
    """

    def __init__(self, limits: HoldLimits, places: SafePlaces) -> None:
        self.limits, self.places = limits, places
        self.early_s = -limits.early_s
        self._next_s = -math.inf

    def decide(self, guidance: Guidance, progress: Progress, seen: FlightState) -> Hold | None:
        """The hold to fly now, if any: looked for every five seconds at most.

        Args:
            guidance: of the flight, as of this moment.
            progress: what it said.
            seen: by its instruments.
        """
        at_its_slowest = guidance.schedule.end is End.SLOWEST
        on_path = guidance.watch.path is Path.FOLLOWED and abs(progress.cross_track_m) < _ON_PATH_M
        if not (at_its_slowest and on_path and seen.time_s >= self._next_s):
            return None
        self._next_s = seen.time_s + _ASKED_AGAIN_S
        wind = seen.wind_north_mps, seen.wind_east_mps
        may_hold = partial(self.places.may_hold, seen.time_s)
        early_s = -progress.time_error_s
        return lay_hold(guidance.reference, progress.path_m, early_s, self.limits, wind, may_hold)


def story(hold: Hold, early_s: float) -> str:
    """What there is to tell of a hold."""
    laps = "1 lap" if hold.laps == 1 else f"{hold.laps} laps"
    return f"schedule: early by {early_s:.0f} s at the slowest, holding {laps} of {hold.lap_s:.0f} s"
