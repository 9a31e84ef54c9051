"""What is known of a goal without a route: how near one comes, and when the last door to it closed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from planner.arrivals import Arrivals
from planner.ground import Cell


@dataclass(frozen=True, slots=True)
class DeadEnd:
    """How far the search came toward a goal that it did not reach.

    `nearest`: the reached cell at the least distance from the goal, `distance_cells` away, first reached at
    `nearest_step`; None where nothing was reached. `last_door_stage`: the last stage in which the goal was
    safe and joined, by safe cells of that stage's map, to a cell that was reached in it; the door was closed
    from the next stage on, or, if it is the horizon's last stage, time ran out. None if there never was one.
    """

    nearest: Cell | None
    distance_cells: float | None
    nearest_step: int | None
    last_door_stage: int | None


def dead_ends(arrivals: Arrivals, goals: Sequence[Cell]) -> list[DeadEnd]:
    """Explain each of some goals that are not reached."""
    reached = arrivals.grid.unpack(np.bitwise_or.reduce(arrivals.layers, axis=0))
    if not goals or not reached.any():
        return [DeadEnd(None, None, None, None) for _ in goals]
    nearest_rows, nearest_columns = ndimage.distance_transform_edt(
        ~reached, return_distances=False, return_indices=True
    )
    found = []
    for goal, door in zip(goals, _last_doors(arrivals, goals), strict=True):
        nearest = int(nearest_rows[goal]), int(nearest_columns[goal])
        found.append(DeadEnd(nearest, math.dist(nearest, goal), arrivals.step_at(nearest), door))
    return found


def _last_doors(arrivals: Arrivals, goals: Sequence[Cell]) -> list[int | None]:
    ground = arrivals.ground
    per_stage = ground.clock.steps_per_stage
    doors: list[int | None] = [None] * len(goals)
    rows, columns = np.array(goals, dtype=np.intp).reshape(-1, 2).T
    for stage in reversed(range(ground.clock.stage_count)):
        open_to = ~ground.hazard[stage][rows, columns] & np.array([door is None for door in doors])
        if not open_to.any():
            continue
        layers = arrivals.layers[stage * per_stage : (stage + 1) * per_stage]
        reached = arrivals.grid.unpack(np.bitwise_or.reduce(layers, axis=0))
        region, _ = ndimage.label(~ground.hazard[stage])
        joined = np.isin(region[rows, columns], np.unique(region[reached])) & open_to
        for goal in np.flatnonzero(joined):
            doors[goal] = stage
    return doors
