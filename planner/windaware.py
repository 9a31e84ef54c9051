"""The wind-aware planner: earliest arrival in any direction, at a real airspeed through the wind.

A sweep over cells and their safe intervals (`earliest`) finds who can be where first; its way to the goal is
straightened into legs in any direction (`straighten`), and its waits are made loiters or slower legs
(`waits`). All times are continuous, so that the aircraft can meet them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from planner.air import Air, Chart
from planner.blocked import Blocked
from planner.earliest import Cell, Earliest, TimedProblem, sweep
from planner.errors import PlannerError
from planner.grid import Grid
from planner.hazards import Bools, clearance_m, hazard_stages
from planner.intervals import SafeIntervals
from planner.legs import Country
from planner.moves import Moves
from planner.planning import Place, PlanningRequest
from planner.plans import GoalOutcome, Plan
from planner.straighten import Leg, cell_by_cell, nodes_to, straighten
from planner.timetable import cells_passed, length_m, waiting_s, waypoints
from planner.waits import with_flyable_waits
from planner.windfield import Floats, WindField

_HEADWAY_MPS = 3.0  # what a head wind has to leave of the slowest airspeed; stronger wind counts as hazard
_ROUNDING_MPS = 0.1
_GUARDS_S = (0.0, 60.0, 300.0, 900.0)  # by how much to be early for closing cells, if less cannot be flown


Way = Sequence[Leg] | str
"""The legs to a goal, or the reason why there are none."""


def plan_windaware(wind: WindField, request: PlanningRequest, *, neighbours: int = 8) -> Plan:
    """Plan the earliest arrival at true airspeed through a wind field on the planner's grid.

    Positions are cell centres, as in the staged planner. `request.objective` and the weights are not used:
    the objective is time.

    Args:
        wind: two-dimensional forecast whose grid is the planner's.
        request: start, goals, times and limits.
        neighbours: of the search's moves, 8 or 16 (4 to compare).

    Returns:
        The plan to `request.goal`, without waypoints where it cannot be reached, and every goal's outcome; of
        the other goals that of the way from cell to cell, before it is straightened.

    Raises:
        PlannerError: if the goal is not one of the goals, a position lies off the grid, or the cruising
            airspeed outside the envelope.
    """
    if request.goal not in (goal.name for goal in request.goals):
        known = ", ".join(goal.name for goal in request.goals)
        raise PlannerError(f"no goal is named {request.goal!r}; there are {known}")
    search = _Search.prepare(wind, request, neighbours)
    ways = search.ways()
    chosen = ways[request.goal]
    route = (
        ()
        if isinstance(chosen, str)
        else waypoints(search.country, wind.grid, request.clock, search.start, chosen, request.altitude_m)
    )
    return Plan(
        planner="windaware",
        objective="earliest",
        departure_s=request.clock.departure_s,
        goal=request.goal,
        waypoints=route,
        goals=search.outcomes(ways),
    )


@dataclass(frozen=True, eq=False)
class _Search:
    """One request, with everything that is made from it once."""

    request: PlanningRequest
    grid: Grid
    hazard: Bools
    country: Country
    moves: Moves
    start: Cell
    goals: dict[str, Cell]
    airspeed_mps: float
    fastest_mps: float

    @classmethod
    def prepare(cls, wind: WindField, request: PlanningRequest, neighbours: int) -> _Search:
        grid, clock = wind.grid, request.clock
        airspeed_mps = _cruise(request)
        threshold_mps = min(request.threshold_mps, request.airspeed_min_mps - _HEADWAY_MPS)
        hazard = hazard_stages(wind, clock, threshold_mps=threshold_mps, corridor_m=request.corridor_m)
        chart = Chart.of(grid)
        return cls(
            request=request,
            grid=grid,
            hazard=hazard,
            country=Country(chart, Air.over(wind, clock), SafeIntervals.of(hazard), clock.stage_s),
            moves=Moves.on(chart, neighbours),
            start=request.start.cell(grid, "start"),
            goals={goal.name: goal.cell(grid, "goal") for goal in request.goals},
            airspeed_mps=airspeed_mps,
            fastest_mps=airspeed_mps + threshold_mps + _ROUNDING_MPS,
        )

    def ways(self) -> dict[str, Way]:
        """The way to each goal: to the chosen one as it is flown, to the others from cell to cell."""
        if self.hazard[0][self.start]:
            return dict.fromkeys(self.goals, str(Blocked.START_IN_HAZARD))
        found = self._sweep(list(self.goals.values()), 0.0)
        ways: dict[str, Way] = {}
        for name, cell in self.goals.items():
            state = found.best_state(cell)
            if state is None:
                always = bool(self.hazard[(slice(None), *cell)].all())
                ways[name] = str(Blocked.GOAL_ALWAYS_IN_HAZARD if always else Blocked.NEVER_REACHABLE)
            elif name == self.request.goal:
                ways[name] = self._flyable(found)
            else:
                nodes = nodes_to(found, state, self.country.stage_s)
                ways[name] = cell_by_cell(nodes, self.airspeed_mps)
        return ways

    def _sweep(self, goals: Sequence[Cell], guard_s: float) -> Earliest:
        problem = TimedProblem(
            self.country.intervals,
            self.request.clock,
            self.country.air,
            self.moves,
            self.airspeed_mps,
            self.fastest_mps,
            guard_s,
        )
        return sweep(problem, self.start, goals)

    def _flyable(self, found: Earliest) -> Way:
        """Legs to the chosen goal that can be flown on time."""
        goal = self.goals[self.request.goal]
        for guard_s in _GUARDS_S:
            if guard_s:
                found = self._sweep([goal], guard_s)
            state = found.best_state(goal)
            if state is None:
                break
            way = nodes_to(found, state, self.country.stage_s)
            straight = straighten(self.country, way, self.airspeed_mps)
            for legs in (straight, cell_by_cell(way, self.airspeed_mps)):
                timed = legs if legs is None else self._with_flyable_waits(legs)
                if timed is not None:
                    return timed
        return str(Blocked.WAITS_TOO_SHORT)

    def _with_flyable_waits(self, legs: Sequence[Leg]) -> list[Leg] | None:
        return with_flyable_waits(
            self.country,
            legs,
            slowest_mps=self.request.airspeed_min_mps,
            wait_min_s=self.request.wait_min_s,
        )

    def outcomes(self, ways: dict[str, Way]) -> tuple[GoalOutcome, ...]:
        """Every goal's outcome."""
        clear_m: dict[int, Floats] = {}
        return tuple(self._outcome(goal, ways[goal.name], clear_m) for goal in self.request.goals)

    def _outcome(self, goal: Place, way: Way, clear_m: dict[int, Floats]) -> GoalOutcome:
        if isinstance(way, str):
            return GoalOutcome(goal.name, goal.lat_deg, goal.lon_deg, reachable=False, reason=way)
        nearest_m = float("inf")
        for time_s, cell in [(0.0, self.start), *cells_passed(self.country, way)]:
            stage = self.request.clock.stage_at(time_s)
            if stage not in clear_m:
                clear_m[stage] = clearance_m(self.grid, self.hazard[stage])
            nearest_m = min(nearest_m, float(clear_m[stage][cell]))
        arrival_s = way[-1].arrive_s if way else 0.0
        return GoalOutcome(
            goal.name,
            goal.lat_deg,
            goal.lon_deg,
            reachable=True,
            earliest_arrival_s=arrival_s,
            arrival_s=arrival_s,
            length_m=length_m(self.country, way),
            waiting_s=waiting_s(way),
            min_clearance_m=nearest_m if nearest_m < float("inf") else None,
        )


def _cruise(request: PlanningRequest) -> float:
    low_mps, high_mps = request.airspeed_min_mps, request.airspeed_max_mps
    airspeed_mps = 0.5 * (low_mps + high_mps) if request.cruise_mps is None else request.cruise_mps
    if not (_HEADWAY_MPS < low_mps <= airspeed_mps <= high_mps):
        raise PlannerError(
            f"a cruise of {airspeed_mps} m/s does not lie within the airspeeds {low_mps} to {high_mps} m/s, "
            f"of which the lowest has to be above {_HEADWAY_MPS} m/s; choose another"
        )
    return airspeed_mps
