"""The paper's planner, "Route planning of UAV based on improved BFS": its best-scoring arrival."""

from __future__ import annotations

from planner.peers.route import PeerRoute
from planner.staged import Cell, StagedProblem, search


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """The route of the staged search whose score, by the paper's equation (2), is the largest."""
    (found,) = search(problem, start, [goal])
    return PeerRoute(found.best.cells) if found.best else PeerRoute(reason=str(found.blocked))
