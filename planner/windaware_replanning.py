"""The wind-aware planner's plan under way against a new forecast.

A plan can be left at any of its waypoints, which lie anywhere on its legs, at any time; the search knows the
centres of cells. So between the two a straight passage is flown, to that of the cells around from which the
goal is reached first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.closures import joined
from planner.earliest import Earliest
from planner.entry import Entry, entries
from planner.hazards import Bools
from planner.passage import Spot, around, spot_at
from planner.planning import PlanningRequest
from planner.plans import Plan, Waypoint
from planner.refuge import LEAVING_STEPS
from planner.revision import Branch, WayOut, told_way, utc
from planner.timetable import waypoints
from planner.track import Track
from planner.way import Cell
from planner.ways import WaySearch
from planner.windaware import plan_of, way_search
from planner.windaware_escape import Escape, escape, through_hazard
from planner.windfield import WindField

_ENOUGH = {"earliest": 30.0, "score": 0.05, "survival": 0.01, "fuel": 1e-3}
"""What a new plan has to be better by: seconds, score, log of the chance, kg. Less is not worth a change."""

_TRIED = 8  # places to wait


@dataclass(frozen=True, eq=False)
class WindawareProspect:
    """The wind-aware planner on one forecast."""

    search: WaySearch
    wind: WindField

    @classmethod
    def of(cls, wind: WindField, request: PlanningRequest) -> WindawareProspect:
        """On a forecast on the planner's grid.

        Raises:
            PlannerError: as `plan_windaware`.
        """
        return cls(way_search(wind, request), wind)

    @property
    def hazard(self) -> Bools:
        """With the corridor, [stage, north, east]."""
        request = self.search.request
        return joined(self.search.appraisal.speed_mps > request.threshold_mps, request.closures)

    def ahead(self, from_s: float) -> tuple[NDArray[Any] | None, ...]:
        """Hazard, wind and the risk of hazard from a time's stage on."""
        search, air = self.search, self.search.country.air
        stage = search.request.clock.stage_at(from_s)
        risk = search.appraisal.risk[stage:] if search.request.tells_chance else None
        return search.hazard[stage:], air.wind_mps[air.time_s >= stage * search.country.stage_s], risk

    def options(self, branch: Branch, until_s: float) -> WindawareOptions | None:
        """From the waypoint's time on, or that at which the aircraft will be there."""
        clock, points = self.search.request.clock, branch.plan.waypoints
        ends = points[branch.place]
        begin_s = branch.from_s if branch.waiting else max(branch.from_s, ends.time_s)
        if begin_s > clock.stage_count * clock.stage_s or (branch.waiting and begin_s > ends.time_s):
            return None  # less of the wait is left than can be circled, or nothing of the horizon
        later_s = 0.0 if branch.waiting else begin_s - ends.time_s
        rest = [_later(point, later_s) for point in points[branch.place :]]
        if branch.waiting:
            rest.insert(0, replace(ends, time_s=begin_s, stage=clock.stage_at(begin_s)))
        return WindawareOptions(self, tuple(rest), until_s + LEAVING_STEPS * clock.step_s)


def _later(point: Waypoint, by_s: float) -> Waypoint:
    return replace(point, time_s=point.time_s + by_s)


@dataclass(frozen=True, eq=False)
class WindawareOptions:
    """What the wind-aware planner can do from a waypoint of the old plan on.

    `rest`: of the old plan, times since departure. `needed_until_s`: until when a place to wait has to be
    safe. `escape`: the way out of hazard that plans begin with.
    """

    prospect: WindawareProspect
    rest: tuple[Waypoint, ...]
    needed_until_s: float
    escape: Escape | None = None

    @property
    def search(self) -> WaySearch:
        """On the new forecast, from departure."""
        return self.prospect.search

    @property
    def goal(self) -> str:
        """The mission's."""
        return self.search.request.goal

    @property
    def objective(self) -> str:
        """By which plans are compared."""
        return self.search.request.objective

    @property
    def begin_s(self) -> float:
        """When the old plan is left."""
        return self.rest[0].time_s

    @property
    def later_s(self) -> float:
        """Nothing: plans have times since departure."""
        return 0.0

    @property
    def in_hazard(self) -> bool:
        """Whether a cell around the place is."""
        hazard = self.search.hazard[self.search.request.clock.stage_at(self.begin_s)]
        return any(hazard[cell] for cell in around(self._spot))

    @cached_property
    def _spot(self) -> Spot:
        return spot_at(self.search.country.chart, self._grid, self.rest[0].lat_deg, self.rest[0].lon_deg)

    @property
    def _grid(self) -> Any:
        return self.prospect.wind.grid

    @cached_property
    def _entries(self) -> dict[Cell, Entry]:
        """The cells to begin a search in."""
        if self.escape:
            return {self.escape.cell: self.escape.exit}
        search = self.search
        return entries(search.country, self._spot, self._grid.shape, self.begin_s, search.cruise_mps)

    @cached_property
    def _found(self) -> Earliest:
        return self.search.spread({cell: entry.time_s for cell, entry in self._entries.items()})

    def trouble(self) -> str:
        """What the old waypoints run into, and when."""
        bad = Track(self.search, self.prospect.wind, self.rest).trouble()
        if bad is None:
            return ""
        into = "into hazard" if bad.hazard else "into wind that it cannot be flown in"
        return f"{into} at {self._utc(bad.time_s)}"

    def plan(self, goal: str) -> Plan:
        """By way of the cell around from which the goal is reached first."""
        found, grid = self._found, self._grid
        places = {place.name: place.cell(grid, "goal") for place in self.search.request.goals}
        states = [found.best_state(places[name]) for name in (goal, *places)]
        state = next((state for state in states if state is not None), None)
        start = self._from(state)
        return self._with_passage(plan_of(self.search.begun(start, self._begin_s(start)), grid, goal), start)

    def _from(self, state: int | None) -> Cell:
        """The cell in which the way to a state begins; without one the first reached, or the nearest."""
        if state is not None:
            intervals = self._found.intervals
            return intervals.cell_of(int(intervals.place[self._found.states_to(state)[0]]))
        if self._entries:
            return min(self._entries, key=lambda cell: self._entries[cell].time_s)
        return round(self._spot[0]), round(self._spot[1])

    def _begin_s(self, start: Cell) -> float:
        return self._entries[start].time_s if start in self._entries else self.begin_s

    def _with_passage(self, plan: Plan, start: Cell) -> Plan:
        """The plan with the passage to its beginning before it, or the way out of hazard."""
        entry = self._entries.get(start)
        if entry is None or not plan.waypoints or entry.time_s == self.begin_s:
            return plan
        goals = tuple(
            replace(goal, length_m=goal.length_m + entry.length_m) if goal.length_m is not None else goal
            for goal in plan.goals
        )
        before = self.escape.points[:-1] if self.escape else self.rest[:1]
        return replace(plan, waypoints=(*before, *plan.waypoints), goals=goals)

    def better(self, plan: Plan) -> str:
        """By how much it is, at the objective; both as their waypoints have them, in the new forecast."""
        old, new = (Track(self.search, self.prospect.wind, points) for points in (self.rest, plan.waypoints))
        was, now = (track.worth(self.objective) for track in (old, new))
        if now <= was + _ENOUGH[self.objective]:
            return ""
        earlier_s = old.arrival_s - new.arrival_s
        sooner = f", {earlier_s / 60.0:.1f} min earlier" if earlier_s > 0.0 else ""
        if self.objective == "survival":
            was, now = math.exp(was), math.exp(now)
        values = {
            "earliest": "",
            "fuel": f", {1e3 * (now - was):.0f} g less fuel",
        }
        by = f", {self.objective} {now:.3g} instead of {was:.3g}"
        return f"a better one{sooner}{values.get(self.objective, by)}"

    def arrival(self, plan: Plan) -> str:
        """The time of day of its end."""
        return self._utc(plan.duration_s)

    def _utc(self, time_s: float) -> str:
        return utc(self.search.request.clock.departure_s + time_s)

    def waiting(self, plan: Plan) -> Plan | None:
        """To where it is safe longest, of such places the nearest, and there a loiter."""
        clock = self.search.request.clock
        for state in self._refuges():
            start = self._from(state)
            search = self.search.begun(start, self._begin_s(start))
            legs = search.way_to(self._found, state)
            if legs is None:
                continue
            route = waypoints(search.country, self._grid, clock, start, legs, search.request.altitude_m)
            until_s = int(self._found.intervals.end[state]) * clock.stage_s - clock.step_s
            if until_s - route[-1].time_s < search.request.wait_min_s:
                continue
            wait = replace(route[-1], time_s=until_s, stage=clock.stage_at(until_s))
            return self._with_passage(replace(plan, waypoints=(*route, wait)), start)
        return None

    def out_of_hazard(self) -> WayOut | None:
        """In the shortest time."""
        way = escape(self.search, self._grid, self._spot, self.rest[0])
        if way is None:
            return None
        told = told_way(way.points[0], way.points[-1], way.length_m)
        return WayOut(replace(self, escape=way), told, self._is_out(way.exit.time_s + _ENOUGH["earliest"]))

    def _is_out(self, by_s: float) -> bool:
        """Whether the old plan can be flown, and is safe from a waypoint on that it passes by a time."""
        wind = self.prospect.wind
        passed = sum(point.time_s <= by_s for point in self.rest)
        return (
            passed > 0
            and Track(through_hazard(self.search), wind, self.rest).trouble() is None
            and Track(self.search, wind, self.rest[passed - 1 :]).trouble() is None
        )

    def _refuges(self) -> Iterator[int]:
        """The states that are safe longest, if that is long enough, the nearest first."""
        found, clock = self._found, self.search.request.clock
        reached = np.flatnonzero(np.isfinite(found.arrive_s))
        if not reached.size:
            return
        end = found.intervals.end[reached]
        horizon_s = clock.stage_count * clock.stage_s
        if int(end.max()) * clock.stage_s < min(self.needed_until_s, horizon_s):
            return
        best = reached[end == end.max()]
        row, column = np.divmod(found.intervals.place[best], found.intervals.width)
        start_row, start_column = divmod(found.intervals.place_of(0, 0), found.intervals.width)
        here = self.escape.cell if self.escape else self._spot
        away = np.hypot(row - start_row - here[0], column - start_column - here[1])
        yield from best[np.lexsort((found.arrive_s[best], away))][:_TRIED].tolist()
