"""A day: the truth, the forecasts of it, and a mission; everything follows from its seed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from planner.clearance import capped_clearance
from planner.grid import Grid
from planner.ground import Cell
from planner.hazards import Bools, StageClock, sheets
from planner.windfield import WindField
from sim.errors import SimError
from sim.reproduce.systems import moving_systems
from sim.reproduce.worlds import World

MISSION_STREAM = 10
"""Seeds start and goals, together with the seed of the day."""


@dataclass(frozen=True)
class Day:
    """One seeded day in a world."""

    world: World
    seed: int

    @property
    def clock(self) -> StageClock:
        """The stages."""
        return self.world.clock

    @cached_property
    def grid(self) -> Grid:
        """The planner's cells."""
        return self.world.grid

    @cached_property
    def wind(self) -> WindField:
        """The true wind, on the world's nodes."""
        return moving_systems(self.world, self.seed)

    @cached_property
    def truth(self) -> Bools:
        """Hazard as it turns out, [stage, north, east]."""
        return hazard_of(self.wind, self.world)

    @cached_property
    def mission(self) -> tuple[Cell, tuple[Cell, ...]]:
        """The start, and the goals."""
        rng = np.random.default_rng(np.random.SeedSequence([self.seed, MISSION_STREAM]))
        return choose_mission(self.truth, self.world, rng)


def hazard_of(wind: WindField, world: World) -> Bools:
    """Hazard of a wind, given on the world's nodes, at the centres of the cells, [stage, north, east]."""
    clock, spread = world.clock, world.spread
    hazard = np.zeros((clock.stage_count, world.rows, world.columns), dtype=np.bool_)
    for stage, closed in enumerate(hazard):
        for north_mps, east_mps in sheets(wind, clock, stage):
            closed |= np.hypot(spread(north_mps), spread(east_mps)) > world.threshold_mps
    return hazard


def choose_mission(truth: Bools, world: World, rng: np.random.Generator) -> tuple[Cell, tuple[Cell, ...]]:
    """A start in the middle, and goals that are not hazardous all day, by the world's rules.

    Args:
        truth: hazard [stage, north, east].
        world: says how many goals, how far off, and how clear of hazard the start is at first.
        rng: draws them.

    Raises:
        SimError: if there are no such places.
    """
    clear = capped_clearance(truth[:1], world.start_clear_cells + 1.0)[0] > world.start_clear_cells
    middle = np.zeros_like(clear)
    middle[world.rows // 4 : -(world.rows // 4), world.columns // 4 : -(world.columns // 4)] = True
    nearest, farthest = world.distances_cells
    open_cells = np.argwhere(~truth.all(axis=0))
    for start in rng.permutation(np.argwhere(clear & middle)):
        moves = np.abs(open_cells - start).sum(axis=1)
        fit = open_cells[(moves >= nearest) & (moves <= farthest)]
        if len(fit) >= world.goals:
            goals = fit[rng.choice(len(fit), world.goals, replace=False)]
            return _cell(start), tuple(_cell(goal) for goal in goals)
    raise SimError("no place on this day has a safe start and goals in reach; choose another --seed")


def _cell(place: NDArray[np.intp]) -> Cell:
    return int(place[0]), int(place[1])
