"""Breadth-first search on the first stage's map: the baseline of the paper."""

from __future__ import annotations

from scipy.sparse import csgraph

from planner.peers.one_map import stage_graph, way_back
from planner.peers.route import START_IN_HAZARD, PeerRoute, static_route
from planner.staged import Cell, StagedProblem


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """Shortest way in cells on the map of departure, flown as if it never changed."""
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    columns = problem.hazard.shape[2]
    _, predecessors = csgraph.breadth_first_order(stage_graph(problem, 0), start[0] * columns + start[1])
    cells = way_back(predecessors, start, goal, columns)
    if cells is None:
        return PeerRoute(reason="no way on the first stage's map")
    return static_route(problem, cells)
