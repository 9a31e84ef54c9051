"""Dijkstra's algorithm on the first stage's map, where cells near hazard cost more."""

from __future__ import annotations

from scipy.sparse import csgraph

from planner.hazards import clearance_cells
from planner.peers.one_map import stage_graph, way_back
from planner.peers.route import START_IN_HAZARD, PeerRoute, static_route
from planner.staged import Cell, StagedProblem


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """Cheapest way on the map of departure, flown as if it never changed.

    Entering a cell costs 1 far from hazard, rising to 2 beside it: 2 - D / cap, with D the clearance and cap
    the one of the score's weights.
    """
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    columns = problem.hazard.shape[2]
    cap = max(problem.weights.clearance_cap_cells, 1.0)
    cost = 2.0 - clearance_cells(problem.hazard[:1], cap)[0] / cap
    _, predecessors = csgraph.dijkstra(
        stage_graph(problem, 0, cost), indices=start[0] * columns + start[1], return_predecessors=True
    )
    cells = way_back(predecessors, start, goal, columns)
    if cells is None:
        return PeerRoute(reason="no way on the first stage's map")
    return static_route(problem, cells)
