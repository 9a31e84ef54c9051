"""An ant colony: ants walk the changing map by lot and by the trail that the best of them left.

Source: M. Dorigo, V. Maniezzo and A. Colorni, "Ant system", 1996, with the trail laid by the best ants
only. The libraries at hand solve tours over all nodes or paths in graphs that do not change; so this is
written out, small.
"""

from __future__ import annotations

import random
from itertools import pairwise

from planner.peers.moves import Moves
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.staged import Cell, StagedProblem

ROUNDS = 40
ANTS = 20
_EVAPORATION = 0.15
_GREED = 3.0  # how much likelier a move toward the goal is than one away from it, squared
_STAYING = 0.3
_LEAST_TRAIL = 0.05

Trail = dict[tuple[Cell, Cell], float]


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The earliest arrival of any ant; none enters a cell that is not allowed, or comes back to one."""
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    moves, last, lots = Moves(problem), problem.clock.step_count - 1, random.Random(seed)
    trail: Trail = {}
    best: list[Cell] | None = None
    for _ in range(ROUNDS):
        limit = last if best is None else len(best) - 1
        ways = [_walk(moves, start, goal, limit, trail, lots) for _ in range(ANTS)]
        arrived = [way for way in ways if way is not None]
        if best is not None:
            arrived.append(best)
        for edge in trail:
            trail[edge] *= 1.0 - _EVAPORATION
        if arrived:
            best = min(arrived, key=len)
            for here, there in pairwise(best):
                trail[here, there] = trail.get((here, there), 0.0) + _EVAPORATION * 20.0
    if best is None:
        return PeerRoute(reason=f"none of {ROUNDS * ANTS} ants arrived")
    return PeerRoute(tuple(best))


def _walk(
    moves: Moves, start: Cell, goal: Cell, last: int, trail: Trail, lots: random.Random
) -> list[Cell] | None:
    """One ant's cells by step, None if it got stuck or came too late."""
    way, visited = [start], {start}
    while way[-1] != goal:
        here, step = way[-1], len(way) - 1
        left = abs(here[0] - goal[0]) + abs(here[1] - goal[1])
        if step + left > last:
            return None
        targets = [cell for cell in moves.leaving(step, here) if cell == here or cell not in visited]
        if not targets:
            return None
        weights = [_attraction(here, cell, left, goal, trail) for cell in targets]
        way.append(lots.choices(targets, weights)[0])
        visited.add(way[-1])
    return way


def _attraction(here: Cell, there: Cell, left: int, goal: Cell, trail: Trail) -> float:
    nearer = left - abs(there[0] - goal[0]) - abs(there[1] - goal[1])
    own = _STAYING if here == there else _GREED**nearer
    return own * (_LEAST_TRAIL + trail.get((here, there), 0.0))
