"""RRT and RRT* on the first stage's map, by OMPL.

Source: S. LaValle, "Rapidly-exploring random trees", 1998; S. Karaman and E. Frazzoli, "Sampling-based
algorithms for optimal motion planning", 2011.
"""

from __future__ import annotations

from typing import Any

from planner.peers.plane import (
    MISSING,
    SPACING,
    already_there,
    bounded_space,
    counted,
    free_around,
    load_ompl,
    position,
    timed_track,
)
from planner.peers.route import START_IN_HAZARD, PeerRoute
from planner.staged import Cell, StagedProblem

_RANGE_SHARE = 1 / 15  # longest branch, of the diagonal of the map
_GOAL_RADIUS_CELLS = 0.1
RRT_ITERATIONS = 20_000
RRT_STAR_ITERATIONS = 8_000


def find_rrt(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The first way that the tree meets, in straight legs, flown as if the map never changed."""
    return _grow(problem, start, goal, seed, "RRT", RRT_ITERATIONS)


def find_rrt_star(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The shortest way in the tree after its iterations, flown as if the map never changed."""
    return _grow(problem, start, goal, seed, "RRTstar", RRT_STAR_ITERATIONS)


def _grow(
    problem: StagedProblem, start: Cell, goal: Cell, seed: int, planner_name: str, iterations: int
) -> PeerRoute:
    modules = load_ompl(seed)
    if modules is None:
        return MISSING
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    if start == goal:
        return already_there(start)
    base, geometric, _ = modules
    space, free = bounded_space(base, problem.hazard.shape[1:]), free_around(problem.hazard[0])
    setup = geometric.SimpleSetup(space)

    def valid(state: Any) -> bool:
        return free(state[0], state[1])

    setup.setStateValidityChecker(valid)
    information = setup.getSpaceInformation()
    information.setStateValidityCheckingResolution(SPACING / space.getMaximumExtent())
    setup.setStartAndGoalStates(position(space, *start), position(space, *goal), _GOAL_RADIUS_CELLS)
    planner = getattr(geometric, planner_name)(information)
    planner.setRange(_RANGE_SHARE * space.getMaximumExtent())
    setup.setPlanner(planner)
    setup.solve(counted(base, iterations))
    if not setup.haveExactSolutionPath():
        return PeerRoute(reason=f"the tree did not meet the goal in {iterations} iterations")
    corners = [(state[0], state[1]) for state in setup.getSolutionPath().getStates()]
    return timed_track(start, corners, problem.clock.step_count - 1)
