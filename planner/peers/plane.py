"""The continuous plane for OMPL: bounds, what is free, and a budget that is counted, not timed.

OMPL draws its lots from one generator for the whole process. Seeding it before each search, and ending a
search after a number of iterations rather than of seconds, gives the same route every time.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from planner.hazards import Bools
from planner.peers.route import START_IN_HAZARD, PeerRoute, TrackPoint
from planner.staged import Cell, StagedProblem

MISSING = PeerRoute(reason="needs OMPL: pip install 'galeway[peers]'")

SPACING = 0.25
"""Distance between tested points [cells] or times [steps]; what lies between two of them is free, too."""

_REACH = SPACING / 2.0


class Ompl(NamedTuple):
    """The modules of OMPL that are in use."""

    base: Any
    geometric: Any
    control: Any


Search = Callable[[Ompl, StagedProblem, Cell, Cell], PeerRoute]


def search_by_ompl(search: Search, problem: StagedProblem, start: Cell, goal: Cell, seed: int) -> PeerRoute:
    """Call a search from start to goal, unless OMPL is not installed or there is nothing to search."""
    ompl = load_ompl(seed)
    if ompl is None:
        return MISSING
    if problem.hazard[0][start]:
        return START_IN_HAZARD
    if start == goal:  # trees sample it as a goal to be met again
        return PeerRoute(track=(TrackPoint(0.0, float(start[0]), float(start[1])),))
    return search(ompl, problem, start, goal)


def load_ompl(seed: int) -> Ompl | None:
    """OMPL, quiet and seeded; None where it is not installed."""
    try:
        base, geometric, control, util = (
            importlib.import_module(f"ompl.{name}") for name in ("base", "geometric", "control", "util")
        )
    except ImportError:
        return None
    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(seed + 1)  # it takes no zero
    return Ompl(base, geometric, control)


def set_up_on_first_map(
    ompl: Ompl, problem: StagedProblem, start: Cell, goal: Cell, goal_radius_cells: float
) -> Any:
    """OMPL's set-up for a way from start to goal on the first stage's map; it lacks a planner."""
    space, free = bounded_space(ompl.base, problem.hazard.shape[1:]), free_around(problem.hazard[0])
    setup = ompl.geometric.SimpleSetup(space)

    def valid(state: Any) -> bool:
        return free(state[0], state[1])

    setup.setStateValidityChecker(valid)
    setup.getSpaceInformation().setStateValidityCheckingResolution(SPACING / space.getMaximumExtent())
    setup.setStartAndGoalStates(position(space, *start), position(space, *goal), goal_radius_cells)
    return setup


def bounded_space(base: Any, shape: Sequence[int], horizon_steps: float | None = None) -> Any:
    """Rows and columns, with time as a third axis if a horizon is given."""
    highs = [size - 0.5 - _REACH for size in shape]
    lows = [_REACH - 0.5 for _ in shape]
    if horizon_steps is not None:
        highs.append(horizon_steps)
        lows.append(0.0)
    bounds = base.RealVectorBounds(len(highs))
    for axis, (low, high) in enumerate(zip(lows, highs, strict=True)):
        bounds.setLow(axis, low)
        bounds.setHigh(axis, high)
    space = base.RealVectorStateSpace(len(highs))
    space.setBounds(bounds)
    return space


def free_around(hazard: Bools) -> Callable[[float, float], bool]:
    """Whether a small square around a position is free on one map [north, east].

    The square reaches half the spacing of tested points to each side, so that a straight leg whose tested
    points are free crosses no hazardous cell between them.
    """
    rows, columns = hazard.shape
    blocked = np.pad(hazard, 1, constant_values=True).tobytes()

    def free(row: float, column: float) -> bool:
        south, north = math.floor(row - _REACH + 0.5), math.floor(row + _REACH + 0.5)
        west, east = math.floor(column - _REACH + 0.5), math.floor(column + _REACH + 0.5)
        if south < -1 or west < -1 or north > rows or east > columns:
            return False
        width = columns + 2
        return not (
            blocked[(south + 1) * width + west + 1]
            or blocked[(south + 1) * width + east + 1]
            or blocked[(north + 1) * width + west + 1]
            or blocked[(north + 1) * width + east + 1]
        )

    return free


def counted(base: Any, iterations: int) -> Any:
    """A termination condition that is met after so many times of asking."""
    left = [iterations]

    def done() -> bool:
        left[0] -= 1
        return left[0] < 0

    return base.PlannerTerminationCondition(done)


def position(space: Any, *values: float) -> Any:
    """A state of the space."""
    state = space.allocState()
    for axis, value in enumerate(values):
        state[axis] = value
    return state


def timed_track(start: Cell, corners: Sequence[tuple[float, float]], last: int) -> PeerRoute:
    """A way through corners in the plane, flown at one cell a step from departure, if it fits the horizon."""
    track = [TrackPoint(0.0, float(start[0]), float(start[1]))]
    for row, column in corners:
        before = track[-1]
        length = math.hypot(row - before.row, column - before.column)
        if length > 0.0:
            track.append(TrackPoint(before.step + length, row, column))
    if track[-1].step > last:
        return PeerRoute(
            reason=f"its way of {track[-1].step:.0f} cells does not fit the horizon of {last} steps"
        )
    return PeerRoute(track=tuple(track))
