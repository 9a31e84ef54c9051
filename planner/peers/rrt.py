"""RRT and RRT* on the first stage's map, by OMPL.

Source: S. LaValle, "Rapidly-exploring random trees", 1998; S. Karaman and E. Frazzoli, "Sampling-based
algorithms for optimal motion planning", 2011.
"""

from __future__ import annotations

from functools import partial

from planner.peers.plane import Ompl, counted, search_by_ompl, set_up_on_first_map, timed_track
from planner.peers.route import PeerRoute
from planner.staged import Cell, StagedProblem

_RANGE_SHARE = 1 / 15  # longest branch, of the diagonal of the map
_GOAL_RADIUS_CELLS = 0.1
RRT_ITERATIONS = 20_000
RRT_STAR_ITERATIONS = 8_000


def find_rrt(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The first way that the tree meets, in straight legs, flown as if the map never changed."""
    return search_by_ompl(partial(_grow, "RRT", RRT_ITERATIONS), problem, start, goal, seed)


def find_rrt_star(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The shortest way in the tree after its iterations, flown as if the map never changed."""
    return search_by_ompl(partial(_grow, "RRTstar", RRT_STAR_ITERATIONS), problem, start, goal, seed)


def _grow(
    planner_name: str, iterations: int, ompl: Ompl, problem: StagedProblem, start: Cell, goal: Cell
) -> PeerRoute:
    setup = set_up_on_first_map(ompl, problem, start, goal, _GOAL_RADIUS_CELLS)
    information = setup.getSpaceInformation()
    planner = getattr(ompl.geometric, planner_name)(information)
    planner.setRange(_RANGE_SHARE * information.getStateSpace().getMaximumExtent())
    setup.setPlanner(planner)
    setup.solve(counted(ompl.base, iterations))
    if not setup.haveExactSolutionPath():
        return PeerRoute(reason=f"the tree did not meet the goal in {iterations} iterations")
    corners = [(state[0], state[1]) for state in setup.getSolutionPath().getStates()]
    return timed_track(start, corners, problem.clock.step_count - 1)
