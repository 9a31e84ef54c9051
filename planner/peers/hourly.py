"""Flying by the map of the hour: what the systems that replan every stage have in common."""

from __future__ import annotations

from typing import Protocol

from planner.peers.moves import Moves
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.staged import Cell, StagedProblem


class HourlyPlanner(Protocol):
    """Plans on one map at a time."""

    def see(self, stage: int, here: Cell) -> None:
        """Take the map of a stage, standing at a cell."""

    def next_cell(self, here: Cell) -> Cell | None:
        """The next cell of a shortest way to the goal on the map last seen, None where there is none."""


def follow(problem: StagedProblem, start: Cell, goal: Cell, planner: HourlyPlanner) -> PeerRoute:
    """Move step by step on the newest map; wait where it shows no way or the next move is not allowed yet.

    The map shown is that of the stage in which the next step ends. Where the hazard comes over the cell
    that is occupied, and neither the next move nor staying is allowed, the flight is lost.
    """
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    clock, moves = problem.clock, Moves(problem)
    cells, seen = [start], -1
    for step in range(clock.step_count - 1):
        here = cells[-1]
        if here == goal:
            break
        stage = clock.stage_of_step(step + 1)
        if stage != seen:
            planner.see(stage, here)
            seen = stage
        target, allowed = planner.next_cell(here), moves.leaving(step, here)
        if target not in allowed:
            target = here
        if target not in allowed:
            return PeerRoute(reason=f"caught by hazard at cell {here} after step {step}")
        cells.append(target)
    if cells[-1] != goal:
        return PeerRoute(reason="no map of the hour showed a way in time")
    return PeerRoute(tuple(cells))
