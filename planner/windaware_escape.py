"""The nearest way out of hazard for the wind-aware planner, from any place, at the fastest airspeed.

A sweep through the hazard tells when each cell can be reached, and so when each safe interval can be entered.
The first such exit is looked for from which one can stay in the open, moving if need be, until the forecast
after next is known.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.earliest import Earliest
from planner.entry import Entry, entries
from planner.grid import Grid
from planner.intervals import SafeIntervals
from planner.passage import Spot, around
from planner.plans import Waypoint
from planner.refuge import LEAVING_STEPS
from planner.timetable import length_m, waypoints
from planner.waits import arriving_at
from planner.way import Cell
from planner.ways import HEADWAY_MPS, Legs, WaySearch
from planner.windfield import Floats

_TRIED = 8  # exits, where the ways there cannot be flown

Ints = NDArray[np.intp]


class Escape(NamedTuple):
    """A way out of hazard. `points`: from its beginning to the exit, the centre of `cell`."""

    points: tuple[Waypoint, ...]
    cell: Cell
    length_m: float

    @property
    def exit(self) -> Entry:
        """Where the search goes on."""
        return Entry(self.points[-1].time_s, self.length_m)


def through_hazard(search: WaySearch) -> WaySearch:
    """The same where only wind that the aircraft makes no headway against is hazard, at its fastest."""
    fastest_mps = search.request.airspeed_max_mps
    flyable_mps = fastest_mps - HEADWAY_MPS
    too_strong = search.appraisal.speed_mps > flyable_mps
    country = replace(search.country, intervals=SafeIntervals.of(too_strong))
    return replace(
        search, hazard=too_strong, country=country, cruise_mps=fastest_mps, strongest_mps=flyable_mps
    )


def escape(search: WaySearch, grid: Grid, spot: Spot, first: Waypoint) -> Escape | None:
    """The way by which one is soonest out of hazard for good; None if there is none within the horizon.

    Args:
        search: on the forecast.
        grid: the planner's.
        spot: where one is.
        first: the same as a waypoint, with its time since departure.
    """
    through, request = through_hazard(search), search.request
    too_strong = through.hazard[request.clock.stage_at(first.time_s)]
    if any(too_strong[cell] for cell in around(spot)):
        return None
    begins = entries(through.country, spot, grid.shape, first.time_s, through.cruise_mps)
    found = through.spread({cell: entry.time_s for cell, entry in begins.items()})
    for number, (state, open_s) in enumerate(_Exits(search, found).viable()):
        if number == _TRIED:
            break
        start = found.intervals.cell_of(int(found.intervals.place[found.states_to(state)[0]]))
        begun = through.begun(start, begins[start].time_s)
        legs = _not_just_before(begun, begun.way_to(found, state), open_s)
        if legs is None:
            continue
        points = waypoints(begun.country, grid, request.clock, start, legs, request.altitude_m)
        if points[-1].time_s < open_s:
            points += (replace(points[-1], time_s=open_s, stage=request.clock.stage_at(open_s)),)
        passage_m = begins[start].length_m
        return Escape(
            (first, *points) if passage_m else points,
            found.intervals.cell_of(int(found.intervals.place[state])),
            passage_m + length_m(begun.country, legs),
        )
    return None


def _not_just_before(begun: WaySearch, legs: Legs | None, open_s: float) -> Legs | None:
    """Legs that end when a place opens or later, or so long before it that the wait can be flown."""
    if legs is None:
        return None
    arrive_s = legs[-1].arrive_s if legs else begun.begin_s
    if not open_s - begun.request.wait_min_s < arrive_s < open_s:
        return legs
    return arriving_at(begun.country, legs, open_s, begun.request.airspeed_min_mps)


@dataclass(frozen=True, eq=False)
class _Exits:
    """Safe intervals by when they can be entered. `found`: the earliest arrivals through the hazard."""

    search: WaySearch
    found: Earliest

    def viable(self) -> Iterator[tuple[int, float]]:
        """The states of `found` in which one is out for good, and when they open, the soonest first."""
        safe, through, stage_s = self._safe, self.found.intervals, self._stage_s
        states = through.run[safe.begin, safe.place]
        open_s = safe.begin * stage_s
        exit_s = np.maximum(self.found.arrive_s[states], open_s)
        runs = np.flatnonzero(exit_s < safe.end * stage_s)
        runs = runs[np.argsort(exit_s[runs], kind="stable")]
        stages = (exit_s[runs] // stage_s).astype(np.intp)
        for stage in np.unique(stages).tolist():
            left = runs[stages == stage]
            until_s = self._known_s(stage)
            while (at := self._first_viable(left, exit_s, until_s)) is not None:
                yield int(states[left[at]]), float(open_s[left[at]])
                left = left[at + 1 :]

    @property
    def _safe(self) -> SafeIntervals:
        return self.search.country.intervals

    @property
    def _stage_s(self) -> float:
        return self.search.country.stage_s

    def _known_s(self, stage: int) -> float:
        """Until when one has to be able to stay who is out in a stage."""
        clock = self.search.request.clock
        return min(
            (stage + 1) * clock.stage_s + LEAVING_STEPS * clock.step_s, clock.stage_count * clock.stage_s
        )

    def _first_viable(self, runs: Ints, exit_s: Floats, until_s: float) -> int | None:
        """The first of some intervals, by when they are entered, from which one can stay until a time.

        The first that is long enough itself is so. Whether any before it is one sweep tells, and of those
        the first is found by halving: with a later one among them the earlier stay viable.
        """
        long_enough = np.flatnonzero(self._lasts(runs, exit_s[runs], until_s))
        bound = int(long_enough[0]) if long_enough.size else runs.size
        if not self._stays(runs[:bound], exit_s, until_s):
            return bound if long_enough.size else None
        low, high = 0, bound
        while high - low > 1:
            middle = (low + high) // 2
            if self._stays(runs[:middle], exit_s, until_s):
                high = middle
            else:
                low = middle
        return high - 1

    def _stays(self, runs: Ints, exit_s: Floats, until_s: float) -> bool:
        """Whether from any of some intervals a safe way leads into one that is long enough."""
        if not runs.size:
            return False
        safe = self._safe
        cells = (safe.cell_of(place) for place in safe.place[runs].tolist())
        arrive_s = self.search.spread(dict(zip(cells, exit_s[runs].tolist(), strict=True))).arrive_s
        return bool(self._lasts(np.arange(arrive_s.size), arrive_s, until_s).any())

    def _lasts(self, runs: Ints, from_s: Floats, until_s: float) -> NDArray[np.bool_]:
        """Whether intervals last until a time, and long enough to wait in them."""
        request = self.search.request
        end_s = self._safe.end[runs] * self._stage_s
        wait_s = request.wait_min_s + request.clock.step_s
        return np.asarray((end_s >= until_s) & (from_s + wait_s <= end_s))
