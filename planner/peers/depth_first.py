"""Depth-first search over (step, cell): finds a route wherever there is one, but not a short one."""

from __future__ import annotations

from planner.hazards import Move
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.peers.step_states import EXPANSION_LIMIT, GAVE_UP, StepStates
from planner.staged import Cell, StagedProblem


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """The first way that a descent meets which tries the moves toward the goal first.

    On the first stage's map alone depth-first search wanders over thousands of cells; over (step, cell),
    with the horizon as its depth, it finds a way if there is one, unless it gives up before.
    """
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    states = StepStates(problem, goal)
    stack = [(states.index(start), int(Move.STAY))]
    expansions = 0
    while stack:
        state, move = stack.pop()
        if not states.meet(state, move):
            continue
        if not states.distance[state % states.cell_count]:
            return states.route_to(state)
        if expansions == EXPANSION_LIMIT:
            return GAVE_UP
        expansions += 1
        following = sorted(states.successors(state), key=lambda next_state: -next_state[1])
        stack.extend((target, by) for target, _, by in following)
    return PeerRoute(reason="every way was tried within the horizon")
