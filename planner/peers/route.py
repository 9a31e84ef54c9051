"""What every system that galeway is compared with returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from planner.staged import Cell, StagedProblem


class TrackPoint(NamedTuple):
    """A position between cell centres: `step` since departure, `row` and `column`, all fractional."""

    step: float
    row: float
    column: float


@dataclass(frozen=True, slots=True)
class PeerRoute:
    """One system's way to the goal, or the reason why it has none.

    `cells`: the cell occupied at each step from 0 to the arrival, of a system that moves from cell to cell.
    `track`: the corners of the way, of a system that plans in the continuous plane; straight at constant
    speed between them. At most one of the two is set; neither is where there is no route.

    The route is what the system believes in: one that plans on a single map may lead through later hazard.
    """

    cells: tuple[Cell, ...] | None = None
    track: tuple[TrackPoint, ...] | None = None
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether there is a route."""
        return self.cells is not None or self.track is not None

    @property
    def arrival_step(self) -> float:
        """When the goal is reached, in steps since departure; infinite without a route."""
        if self.cells is not None:
            return len(self.cells) - 1
        return self.track[-1].step if self.track is not None else float("inf")


class Find(Protocol):
    """The one call behind which every system stands."""

    def __call__(self, problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
        """Find a way from `start`, occupied at step 0, to `goal`; `seed` is for those that draw lots."""


class Peer(NamedTuple):
    """A system in the table: what to call, what it is, and what it claims.

    `time_dependent`: it plans for the map that changes, not for one map. `optimal`: its arrival is the
    earliest there is, by proof. `fastest`: the speed in the plane that it may plan with, in cells a step;
    infinite for a planner that takes its speed from the wind.
    """

    find: Find
    about: str
    time_dependent: bool
    optimal: bool = False
    fastest: float = 1.0


def static_route(problem: StagedProblem, cells: tuple[Cell, ...]) -> PeerRoute:
    """A way found on one map, if it fits the horizon."""
    last = problem.clock.step_count - 1
    if len(cells) - 1 > last:
        return PeerRoute(reason=f"its way of {len(cells) - 1} moves does not fit the horizon of {last} steps")
    return PeerRoute(cells)


START_IN_HAZARD = PeerRoute(reason="the start is in hazard at departure")
