"""Probabilistic roadmap on the first stage's map: OMPL draws the roadmap, scipy searches it.

Source: L. Kavraki et al., "Probabilistic roadmaps for path planning in high-dimensional configuration
spaces", 1996. OMPL's own query runs a second thread, which waits for ever on a test of states written in
Python; so start and goal are joined to the roadmap here.
"""

from __future__ import annotations

import math
from typing import Any

from scipy import sparse
from scipy.sparse import csgraph

from planner.peers.plane import Ompl, counted, position, search_by_ompl, set_up_on_first_map, timed_track
from planner.peers.route import PeerRoute
from planner.staged import Cell, StagedProblem

GROWTH_ITERATIONS = 1_500
_GOAL_RADIUS_CELLS = 1e-6  # the goal itself
_JOINED = 10  # nearest milestones that start and goal are joined to


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The shortest way over the roadmap, flown as if the map never changed."""
    return search_by_ompl(_search, problem, start, goal, seed)


def _search(ompl: Ompl, problem: StagedProblem, start: Cell, goal: Cell) -> PeerRoute:
    setup = set_up_on_first_map(ompl, problem, start, goal, _GOAL_RADIUS_CELLS)
    information = setup.getSpaceInformation()
    planner = ompl.geometric.PRM(information)
    setup.setPlanner(planner)
    setup.setup()
    planner.growRoadmapPtc(counted(ompl.base, GROWTH_ITERATIONS))
    data = ompl.base.PlannerData(information)
    planner.getPlannerData(data)
    corners = _query(information, data, start, goal)
    if corners is None:
        return PeerRoute(reason="the roadmap does not join start and goal")
    return timed_track(start, corners, problem.clock.step_count - 1)


def _query(information: Any, data: Any, start: Cell, goal: Cell) -> list[tuple[float, float]] | None:
    """Corners of the shortest way from start to goal over the milestones, None without one."""
    space = information.getStateSpace()
    count = data.numVertices()
    states = [data.getVertex(index).getState() for index in range(count)]
    places = [(float(state[0]), float(state[1])) for state in states]
    edges = {(index, int(other)) for index in range(count) for other in data.getEdges(index)}
    for end in (start, goal):
        near = sorted(range(len(places)), key=lambda index, end=end: math.dist(places[index], end))  # type: ignore[misc]
        state, own = position(space, *end), len(places)
        places.append((float(end[0]), float(end[1])))
        states.append(state)
        edges.update(
            (own, index) for index in near[:_JOINED] if information.checkMotion(state, states[index])
        )
    lengths = [math.dist(places[here], places[there]) for here, there in edges]
    rows, columns = zip(*edges, strict=True) if edges else ((), ())
    graph = sparse.csr_array((lengths, (rows, columns)), shape=(len(places), len(places)))
    _, before = csgraph.dijkstra(graph, directed=False, indices=count, return_predecessors=True)
    way = [count + 1]
    while way[-1] != count:
        if before[way[-1]] < 0:
            return None
        way.append(int(before[way[-1]]))
    return [places[index] for index in reversed(way)]
