"""Replanning every stage, from nothing, on the map of that hour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csgraph

from planner.hazards import OFFSETS
from planner.peers.hourly import follow
from planner.peers.one_map import stage_graph
from planner.peers.route import PeerRoute
from planner.staged import Cell, StagedProblem


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """Fly a shortest way on the map of the hour, found anew when the map changes."""
    return follow(problem, start, goal, _DistanceField(problem, goal))


class _DistanceField:
    """Moves still to make from every cell, by breadth-first distance from the goal."""

    def __init__(self, problem: StagedProblem, goal: Cell) -> None:
        self._problem, self._goal = problem, goal
        self._left: NDArray[np.float64] = np.empty(0)

    def see(self, stage: int, here: Cell) -> None:  # noqa: ARG002 - the same from everywhere
        columns = self._problem.hazard.shape[2]
        self._graph = stage_graph(self._problem, stage)
        goal = self._goal[0] * columns + self._goal[1]
        self._left = csgraph.dijkstra(self._graph.T.tocsr(), indices=goal, unweighted=True)

    def next_cell(self, here: Cell) -> Cell | None:
        columns = self._problem.hazard.shape[2]
        index = here[0] * columns + here[1]
        entered = self._graph.indices[self._graph.indptr[index] : self._graph.indptr[index + 1]].tolist()
        order = {north * columns + east: rank for rank, (north, east) in enumerate(OFFSETS.values())}
        entered.sort(key=lambda cell: (self._left[cell], order[cell - index]))
        if not entered or not np.isfinite(self._left[entered[0]]):
            return None
        row, column = divmod(int(entered[0]), columns)
        return row, column
