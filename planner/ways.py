"""Flyable ways to the goals: the earliest at an airspeed, the best by score or survival, the thriftiest.

Other objectives begin with the earliest ways and keep them where they find nothing better, so none does worse
than these.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from planner.appraisal import Appraisal
from planner.blocked import Blocked
from planner.cheapest import Cheapest
from planner.cheapest import sweep as sweep_labels
from planner.earliest import Earliest, sweep
from planner.edges import TimedProblem
from planner.hazards import Bools
from planner.legs import Country
from planner.levels import stacked
from planner.moves import Moves
from planner.planning import PlanningRequest
from planner.price import TIME, Price
from planner.straighten import cell_by_cell, nodes_to, straighten
from planner.thrift import with_thrifty_speeds
from planner.waits import with_flyable_waits
from planner.way import Cell, Leg, Node
from planner.windfield import Floats

HEADWAY_MPS = 3.0
"""What a head wind has to leave of the slowest airspeed; stronger wind counts as hazard."""

_ROUNDING_MPS = 0.1
_GUARDS_S = (0.0, 60.0, 300.0, 900.0)  # by how much to be early for closing cells, if less cannot be flown
_ENOUGH_GAIN = 0.9  # of what the search promised; with less, straight legs give way to those between cells
_SPEEDS = 6  # constant airspeeds to search for the thriftiest way with


Legs = Sequence[Leg]
Way = Legs | Blocked
"""The legs to a goal, or the reason why there are none."""


class GoalWay(NamedTuple):
    """A way, and the earliest arrival at cruise [s], None where there is none."""

    way: Way
    earliest_s: float | None


@dataclass(frozen=True, eq=False)
class WaySearch:
    """One request on its country.

    `moves_at_level`: those that keep their level, all of them where there is one alone. `strongest_mps`: of
    the wind where it is no hazard.
    """

    request: PlanningRequest
    hazard: Bools
    country: Country
    moves: Moves
    moves_at_level: Moves
    start: Cell
    goals: tuple[Cell, ...]
    chosen: Cell
    cruise_mps: float
    strongest_mps: float
    appraisal: Appraisal

    def ways(self) -> list[GoalWay]:
        """The way to each goal, by the request's objective."""
        if self.hazard[self.request.clock.stage_at(self.begin_s)][self.start]:
            return [GoalWay(Blocked.START_IN_HAZARD, None)] * len(self.goals)
        earliest = self._earliest(self.cruise_mps)
        match self.request.objective:
            case "fuel":
                ways = self._thriftiest(earliest)
            case "score" | "survival":
                ways = self._best_by_price(earliest)
            case _:
                ways = earliest
        return [
            GoalWay(way, _arrival_s(way if isinstance(first, Blocked) else first, self.begin_s))
            for way, first in zip(ways, earliest, strict=True)
        ]

    @property
    def begin_s(self) -> float:
        """When ways begin, since departure."""
        return self.country.begin_s

    def _problem(self, airspeed_mps: float, guard_s: float = 0.0, moves: Moves | None = None) -> TimedProblem:
        fastest_mps = airspeed_mps + self.strongest_mps + _ROUNDING_MPS
        clock, country = self.request.clock, self.country
        return TimedProblem(
            country.intervals, clock, country.air, moves or self.moves, airspeed_mps, fastest_mps, guard_s
        )

    def _earliest(self, airspeed_mps: float) -> list[Way]:
        ways = self._earliest_by(self.moves, airspeed_mps)
        if self.moves is self.moves_at_level:
            return ways
        # what levels gain in the search may be lost where ways are straightened: never be later than without
        at_level = self._earliest_by(self.moves_at_level, airspeed_mps)
        return [min(pair, key=_arrival_or_never) for pair in zip(ways, at_level, strict=True)]

    def _earliest_by(self, moves: Moves, airspeed_mps: float) -> list[Way]:
        found = sweep(self._problem(airspeed_mps, moves=moves), {self.start: self.begin_s}, self.goals)
        return [self._earliest_to(goal, found, airspeed_mps, moves) for goal in self.goals]

    def _earliest_to(self, goal: Cell, found: Earliest, airspeed_mps: float, moves: Moves) -> Way:
        if found.best_state(goal) is None:
            always = bool(self.hazard[(slice(None), *goal)].all())
            return Blocked.GOAL_ALWAYS_IN_HAZARD if always else Blocked.NEVER_REACHABLE
        for guard_s in _GUARDS_S:
            if guard_s:
                found = sweep(self._problem(airspeed_mps, guard_s, moves), {self.start: self.begin_s}, [goal])
            state = found.best_state(goal)
            if state is None:
                break
            legs = self._flyable(nodes_to(found, state, self.country.stage_s), airspeed_mps)
            if legs is not None:
                return legs
        return Blocked.WAITS_TOO_SHORT

    def _flyable(
        self, way: Sequence[Node], airspeed_mps: float, price: Price = TIME, way_price: float | None = None
    ) -> list[Leg] | None:
        """Straight legs along a way that can be flown on time, else those from cell to cell."""
        straight = straighten(self.country, way, airspeed_mps, price, way_price)
        timed = None if straight is None else self._with_flyable_waits(straight)
        return self._with_flyable_waits(cell_by_cell(way, airspeed_mps)) if timed is None else timed

    def _with_flyable_waits(self, legs: Sequence[Leg]) -> list[Leg] | None:
        return with_flyable_waits(
            self.country,
            legs,
            slowest_mps=self.request.airspeed_min_mps,
            wait_min_s=self.request.wait_min_s,
        )

    def begun(self, start: Cell, begin_s: float) -> WaySearch:
        """The same from another cell and time on."""
        country = replace(self.country, begin_s=begin_s)
        return replace(
            self,
            start=start,
            country=country,
            appraisal=replace(self.appraisal, start=start, country=country),
        )

    def spread(self, starts: Mapping[Cell, float], goals: Sequence[Cell] | None = None) -> Earliest:
        """Earliest arrivals at cruise from any of several cells, each from a time of its own on."""
        return sweep(self._problem(self.cruise_mps), starts, goals)

    def way_to(self, found: Earliest, state: int) -> Legs | None:
        """Flyable legs to a state that was found from the beginning at cruise."""
        return self._flyable(nodes_to(found, state, self.country.stage_s), self.cruise_mps)

    def _best_by_price(self, ways: Sequence[Way]) -> list[Way]:
        """The best ways by score or survival, found by the prices around the way to the chosen goal."""
        known = {
            goal: way for goal, way in zip(self.goals, ways, strict=True) if not isinstance(way, Blocked)
        }
        if not known:
            return list(ways)
        objective, appraisal = self.request.objective, self.appraisal
        reference = known.get(self.chosen) or next(iter(known.values()))
        reference_s = reference[-1].arrive_s - self.begin_s if reference else 0.0
        price = appraisal.price(objective, reference_s, appraisal.mean_clearance(reference))
        until_s, most = self._limits(known)
        problem = self._problem(self.cruise_mps)
        found = sweep_labels(problem, price, self.start, list(known), until_s, most, self.begin_s)
        better = {goal: self._better_way(found, goal, legs, reference_s) for goal, legs in known.items()}
        return [better.get(goal, way) for goal, way in zip(self.goals, ways, strict=True)]

    def _better_way(self, found: Cheapest, goal: Cell, legs: Legs, reference_s: float) -> Legs:
        """The flyable way by the best label of a goal, if it is better than one that is known."""
        objective, appraisal, arrivals = self.request.objective, self.appraisal, found.arrivals[goal]
        if not arrivals.label.size:
            return legs
        worths = appraisal.worth_of_arrivals(objective, goal, arrivals, reference_s)
        at, known = int(worths.argmax()), appraisal.worth(objective, legs)
        if worths[at] <= known:
            return legs
        nodes = found.nodes_to(int(arrivals.label[at]), self.country.stage_s)
        integral = float(appraisal.rescaled(objective, arrivals, reference_s)[at])
        time_s, length_m = float(arrivals.time_s[at]) - self.begin_s, float(arrivals.length_m[at])
        beta = self.request.weights.beta
        price = appraisal.price(objective, time_s, -integral / beta if beta else 0.0)
        spent = price.per_s * time_s + price.per_m * length_m + integral
        candidates = [legs]
        straight = self._flyable(nodes, self.cruise_mps, price, spent)
        if straight is not None:
            candidates.append(straight)
        if straight is None or appraisal.worth(objective, straight) < known + _ENOUGH_GAIN * (
            float(worths[at]) - known
        ):
            by_cells = self._with_flyable_waits(cell_by_cell(nodes, self.cruise_mps))
            candidates.extend([by_cells] if by_cells is not None else [])
        return max(candidates, key=lambda way: appraisal.worth(objective, way))

    def _limits(self, known: Mapping[Cell, Legs]) -> tuple[Floats, float]:
        """Until when a cell is of use for any goal, [north, east], and the risk above which no way is."""
        appraisal, chart = self.appraisal, self.country.chart
        horizon_s = float(self.country.air.time_s[-1])
        fastest_mps = self.cruise_mps + self.strongest_mps + _ROUNDING_MPS
        until_s = np.full((chart.levels.rows, chart.east_m.size), -np.inf)
        most = 0.0
        for goal, legs in known.items():
            _, (row, column) = chart.levels.split(goal)
            worth = appraisal.worth(self.request.objective, legs)
            latest_s = horizon_s
            if self.request.objective == "score":
                latest_s = min(horizon_s, appraisal.score_bound_s(goal, worth))
            plane_m = np.hypot(
                (chart.north_m - chart.north_m[row])[:, np.newaxis], chart.east_m - chart.east_m[column]
            )
            np.maximum(until_s, latest_s - plane_m / (chart.scale.max() * fastest_mps), out=until_s)
            most = max(most, -worth)
        if chart.levels.count > 1:
            until_s = stacked(np.stack([until_s] * chart.levels.count), -np.inf)
        return until_s, most if self.request.objective == "survival" else math.inf

    def _thriftiest(self, ways: Sequence[Way]) -> list[Way]:
        """The ways that burn least, of the earliest ways at one airspeed after the other, slowest first.

        At one airspeed what burns least is what arrives first. Faster ways are tried as long as they burn
        less to any goal, the cruise's always; each is then slowed down before waits, and its legs flown at
        their own best airspeeds.
        """
        low_mps, high_mps = self.request.airspeed_min_mps, self.request.airspeed_max_mps
        best = [self._thrifty(way) for way in ways]
        for airspeed_mps in np.linspace(low_mps, high_mps, _SPEEDS).tolist():
            if airspeed_mps == self.cruise_mps:
                continue
            gained = False
            for index, way in enumerate(self._earliest(airspeed_mps)):
                thrifty = self._thrifty(way)
                if not isinstance(thrifty, Blocked) and self._burns_less(thrifty, best[index]):
                    best[index] = thrifty
                    gained = True
            if not gained:
                break
        return best

    def _thrifty(self, way: Way) -> Way:
        """The way at the airspeeds that burn least along it, if that is less."""
        flow = self.request.fuel_flow
        if isinstance(way, Blocked) or flow is None:
            return way
        slower = with_thrifty_speeds(
            self.country,
            way,
            flow,
            slowest_mps=self.request.airspeed_min_mps,
            fastest_mps=self.request.airspeed_max_mps,
            wait_min_s=self.request.wait_min_s,
        )
        return slower if slower is not None and self._burns_less(slower, way) else way

    def _burns_less(self, legs: Legs, other: Way) -> bool:
        appraise = self.appraisal
        return isinstance(other, Blocked) or appraise.worth("fuel", legs) > appraise.worth("fuel", other)


def _arrival_or_never(way: Way) -> float:
    arrival_s = _arrival_s(way)
    return math.inf if arrival_s is None else arrival_s


def _arrival_s(way: Way, begin_s: float = 0.0) -> float | None:
    if isinstance(way, Blocked):
        return None
    return way[-1].arrive_s if way else begin_s
