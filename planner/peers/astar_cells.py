"""A* that closes each cell when it is first expanded: it knows the time, but cannot wait or come back."""

from __future__ import annotations

import heapq

from planner.peers.moves import Moves
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.staged import Cell, StagedProblem


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """A* on the changing map with a closed list of cells, as on a map that stands still.

    A move is tested at the step at which it would be made, but a cell is left at one time only: at the next
    step after it was first reached. So it neither waits for a door to open nor tries it again later, and
    misses goals or makes detours.
    """
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    moves, last = Moves(problem), problem.clock.step_count - 1

    def total(step: int, cell: Cell) -> int:
        return step + abs(cell[0] - goal[0]) + abs(cell[1] - goal[1])

    queue = [(total(0, start), 0, start, start)]
    parents: dict[Cell, Cell] = {}  # the closed list
    while queue:
        _, back, cell, parent = heapq.heappop(queue)
        if cell in parents:
            continue
        parents[cell] = parent
        step = -back
        if cell == goal:
            way = [cell]
            while way[-1] != start:
                way.append(parents[way[-1]])
            return PeerRoute(tuple(reversed(way)))
        if step == last:
            continue
        for target in moves.leaving(step, cell):
            if target not in parents:
                heapq.heappush(queue, (total(step + 1, target), -step - 1, target, cell))
    return PeerRoute(reason="the open list ran empty; closed cells were not tried again later")
