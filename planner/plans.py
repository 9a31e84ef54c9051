"""The plan: waypoints in time, and what became of every goal that was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import msgspec

from planner.errors import BadPlanError
from planner.route import ScoreTerms

FORMAT = 1


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A position to be passed at a time; two in a row at one position are a wait (a loiter).

    `lat_deg`, `lon_deg`: geodetic, WGS84; degrees, because a plan is a file before it is anything else.
    `altitude_m`: above the ellipsoid. `time_s`: since departure. `stage`: the hour of weather it lies in,
    counted from the beginning of the forecast that was planned on.
    """

    lat_deg: float
    lon_deg: float
    altitude_m: float
    time_s: float
    stage: int


@dataclass(frozen=True, slots=True)
class StageOutcome:
    """Whether a goal is reachable by the end of a stage, and arrival and score of the best route so far."""

    stage: int
    reachable: bool
    arrival_s: float | None = None
    score: float | None = None


@dataclass(frozen=True, slots=True)
class NearestPlace:
    """The reachable place nearest to a goal: how far off it lies, and when it is first reached."""

    lat_deg: float
    lon_deg: float
    distance_m: float
    arrival_s: float


@dataclass(frozen=True, slots=True)
class GoalOutcome:
    """What the sweep found for one goal: times since departure, or the reason why there is no route.

    `terms`: of the score. `fuel_kg`: burned on the way, by the aircraft's measured consumption. `stages`: for
    the end of each stage from the departure's on. `survival`: the chance that no step of the route meets
    hazard, where the forecast has an error, each step being an independent draw, and `survival_at_most` if
    one draw decides all; `members_survived` of `members`: the same counted in an ensemble. `abstained`: the
    chance lies below the level asked for, so the route is shown but not to be flown. Without a route:
    `nearest` is the nearest reachable place, if any, and `last_door_stage` the last stage in which the goal
    was open to one, if there was any (see planner.dead_end.DeadEnd).
    """

    name: str
    lat_deg: float
    lon_deg: float
    reachable: bool
    reason: str = ""
    earliest_arrival_s: float | None = None
    arrival_s: float | None = None
    length_m: float | None = None
    waiting_s: float | None = None
    score: float | None = None
    terms: ScoreTerms | None = None
    min_clearance_m: float | None = None
    fuel_kg: float | None = None
    survival: float | None = None
    members_survived: int | None = None
    members: int | None = None
    abstained: bool = False
    survival_at_most: float | None = None
    stages: tuple[StageOutcome, ...] = ()
    nearest: NearestPlace | None = None
    last_door_stage: int | None = None


@dataclass(frozen=True, slots=True)
class Plan:
    """A route to `goal`, empty where it cannot be reached, beside the outcome of each goal.

    `departure_s`: seconds since 1970-01-01 UTC. `objective`: which of a goal's arrivals the route takes,
    "earliest", "score", "survival" or "fuel".
    """

    planner: str
    objective: str
    departure_s: float
    goal: str
    waypoints: tuple[Waypoint, ...]
    goals: tuple[GoalOutcome, ...]
    format: int = FORMAT

    @property
    def outcome(self) -> GoalOutcome:
        """The outcome of the goal that the route leads to."""
        return next(outcome for outcome in self.goals if outcome.name == self.goal)

    @property
    def duration_s(self) -> float:
        """From departure to the last waypoint [s]."""
        return self.waypoints[-1].time_s if self.waypoints else 0.0

    @property
    def level_flight(self) -> tuple[tuple[float, float], ...]:
        """The altitudes that the route stays at, one after the other, and when each begins: (m, s).

        A route that never stays at the altitude of its beginning or end has it there all the same.
        """
        route = self.waypoints
        stays = [(a.altitude_m, a.time_s) for a, b in pairwise(route) if a.altitude_m == b.altitude_m]
        ends = [(point.altitude_m, point.time_s) for point in (*route[:1], *route[-1:])]
        met = [*ends[:1], *stays, *ends[1:]]
        return (*met[:1], *(now for before, now in pairwise(met) if before[0] != now[0]))

    def to_json(self) -> bytes:
        """The plan as indented JSON."""
        return msgspec.json.format(msgspec.json.encode(self), indent=1) + b"\n"

    @classmethod
    def from_json(cls, text: bytes | str) -> Plan:
        """Read a plan back.

        Raises:
            BadPlanError: if the text is not a plan of this format.
        """
        try:
            plan = msgspec.json.decode(text, type=cls)
        except msgspec.MsgspecError as error:
            raise BadPlanError(f"not a galeway plan: {error}; make a new one with `galeway plan`") from error
        if plan.format != FORMAT:
            raise BadPlanError(f"the plan has format {plan.format}, this galeway reads {FORMAT}")
        return plan

    def save(self, path: Path) -> None:
        """Write the plan as JSON.

        Raises:
            BadPlanError: if the file cannot be written.
        """
        try:
            path.write_bytes(self.to_json())
        except OSError as error:
            raise BadPlanError(
                f"cannot write the plan {path}: {error.strerror}; name another file"
            ) from error

    @classmethod
    def load(cls, path: Path) -> Plan:
        """Read a plan from a file.

        Raises:
            BadPlanError: if the file cannot be read or is not a plan.
        """
        try:
            return cls.from_json(path.read_bytes())
        except OSError as error:
            raise BadPlanError(f"cannot read the plan {path}: {error.strerror}") from error
