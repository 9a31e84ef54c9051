"""A* over (step, cell): the earliest arrival, exactly, one expansion at a time."""

from __future__ import annotations

from planner.hazards import Move
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.peers.step_states import EXPANSION_LIMIT, GAVE_UP, StepStates
from planner.staged import Cell, StagedProblem


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """The earliest arrival in the changing map.

    The estimate is the distance in moves, so sums are whole numbers that never fall: a stack for each sum
    takes the place of a heap, and of equal sums the state met last goes first. To prove that a goal cannot
    be reached, every state from which it could still be in time is expanded.
    """
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    states = StepStates(problem, goal)
    origin = states.index(start)
    states.meet(origin, Move.STAY)
    stacks: list[list[int]] = [[] for _ in range(states.last + 1)]
    if states.distance[origin] <= states.last:
        stacks[states.distance[origin]].append(origin)
    expansions = 0
    for stack in stacks:
        while stack:
            state = stack.pop()
            step, index = divmod(state, states.cell_count)
            if not states.distance[index]:
                return states.route_to(state)
            if expansions == EXPANSION_LIMIT:
                return GAVE_UP
            expansions += 1
            for target, distance, move in states.successors(state):
                if states.meet(target, move):
                    stacks[step + 1 + distance].append(target)
    return PeerRoute(reason="no safe way leads there within the horizon")
