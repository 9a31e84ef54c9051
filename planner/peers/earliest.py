"""Galeway's own earliest arrival: what the delay of the others is counted from."""

from __future__ import annotations

from planner.arrivals import sweep_arrivals
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.staged import Blocked, Cell, StagedProblem


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """The route of the staged search that arrives first."""
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    cells = sweep_arrivals(problem.ground, start).route(goal)
    return PeerRoute(cells) if cells else PeerRoute(reason=str(Blocked.NEVER_REACHABLE))
