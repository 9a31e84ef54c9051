"""Control-space RRT with time as a third coordinate, for the map that changes, by OMPL.

Source: S. LaValle and J. Kuffner, "Randomized kinodynamic planning", 2001.
"""

from __future__ import annotations

import math
import random
from functools import partial
from typing import Any

from planner.peers.plane import SPACING, Ompl, bounded_space, counted, free_around, position, search_by_ompl
from planner.peers.route import PeerRoute, TrackPoint
from planner.staged import Cell, StagedProblem

ITERATIONS = 20_000
_LONGEST_CONTROL_STEPS = 6.0
_WAITING_SHARE = 0.15  # of the controls that are drawn
_GOAL_RADIUS_CELLS = 0.4


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:
    """The first way that a tree of (row, column, step) meets by drawn courses and waits.

    A control is a course held at one cell a step, or a wait, for up to six steps. The way is valid in the
    changing map; it is crooked, and no claim is made about its arrival.
    """
    return search_by_ompl(partial(_grow, seed), problem, start, goal, seed)


def _grow(seed: int, ompl: Ompl, problem: StagedProblem, start: Cell, goal: Cell) -> PeerRoute:
    base, _, control = ompl
    horizon = float(problem.clock.step_count - 1)
    space = bounded_space(base, problem.hazard.shape[1:], horizon)
    controls = control.RealVectorControlSpace(space, 2)
    bounds = base.RealVectorBounds(2)
    for axis, (low, high) in enumerate(((-math.pi, math.pi), (0.0, 1.0))):
        bounds.setLow(axis, low)
        bounds.setHigh(axis, high)
    controls.setBounds(bounds)
    setup = control.SimpleSetup(controls)
    setup.setStateValidityChecker(_free_in_time(problem, space))
    setup.setStatePropagator(_fly)
    information = setup.getSpaceInformation()
    information.setPropagationStepSize(SPACING)
    information.setMinMaxControlDuration(2, round(_LONGEST_CONTROL_STEPS / SPACING))
    setup.setStartState(position(space, *start, 0.0))
    setup.setGoal(_goal(base, information, goal, horizon, seed))
    setup.setPlanner(control.RRT(information))
    setup.solve(counted(base, ITERATIONS))
    if not setup.haveExactSolutionPath():
        return PeerRoute(reason=f"the tree did not meet the goal in {ITERATIONS} iterations")
    states = setup.getSolutionPath().getStates()
    return PeerRoute(track=tuple(TrackPoint(state[2], state[0], state[1]) for state in states))


def _free_in_time(problem: StagedProblem, space: Any) -> Any:
    """Free on the maps of the moments half a spacing before and after."""
    free = [free_around(stage) for stage in problem.hazard]
    steps, last = problem.clock.steps_per_stage, problem.clock.stage_count - 1

    def valid(state: Any) -> bool:
        if not space.satisfiesBounds(state):
            return False
        row, column, step = state[0], state[1], state[2]
        first = max(int((step - SPACING / 2.0) // steps), 0)
        second = min(int((step + SPACING / 2.0) // steps), last)
        return free[first](row, column) and (first == second or free[second](row, column))

    return valid


def _fly(state: Any, control: Any, duration: float, result: Any) -> None:
    speed = 0.0 if control[1] < _WAITING_SHARE else 1.0
    row, column, step = state[0], state[1], state[2]
    result[0] = row + speed * duration * math.sin(control[0])
    result[1] = column + speed * duration * math.cos(control[0])
    result[2] = step + duration


def _goal(base: Any, information: Any, goal: Cell, horizon: float, seed: int) -> Any:
    """The goal's cell at any time; drawn as a target, at a time at which it could be reached."""
    lots = random.Random(seed)

    class AtAnyTime(base.GoalSampleableRegion):  # type: ignore[misc]
        def distanceGoal(self, state: Any) -> float:  # noqa: N802 - OMPL calls it
            return math.hypot(state[0] - goal[0], state[1] - goal[1])

        def sampleGoal(self, state: Any) -> None:  # noqa: N802
            state[0], state[1], state[2] = float(goal[0]), float(goal[1]), lots.uniform(0.0, horizon)

        def maxSampleCount(self) -> int:  # noqa: N802
            return 1_000_000

    region = AtAnyTime(information)
    region.setThreshold(_GOAL_RADIUS_CELLS)
    return region
