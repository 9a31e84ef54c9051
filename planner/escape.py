"""The nearest way out of hazard, cell by cell: to where it is open, and where one can stay in the open.

In hazard nothing is asked but what the aircraft can fly; time in it is what counts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from planner.arrivals import sweep_arrivals
from planner.ground import Cell, Ground, Occupancy
from planner.hazards import OFFSETS, Bools, Move
from planner.refuge import LEAVING_STEPS


def way_out(ground: Ground, start: Cell, goal: Cell, *, first_step: int) -> tuple[Cell, ...] | None:
    """The route by which one is soonest out of hazard for good.

    It ends in a cell from which one can stay out of hazard, moving if need be, until the forecast after next
    is known, as any plan has to. Of such cells reached at one step the one with the fewest moves, then the
    nearest to the goal; moves come before waits for it to open.

    Args:
        ground: where and how one may move.
        start: the cell occupied at `first_step`, in hazard then.
        goal: that is wanted.
        first_step: from when on.

    Returns:
        The cell at each step from `first_step` on; None if there is no way out within the horizon.

    Raises:
        OutsideGridError: if the start lies off the grid.
    """
    clock = ground.clock
    through = sweep_arrivals(
        replace(ground, hazard=np.zeros_like(ground.hazard)), start, first_step=first_step
    )
    for stage in range(clock.stage_of_step(first_step), clock.stage_count):
        begin = max(stage * clock.steps_per_stage, first_step)
        last = min((stage + 1) * clock.steps_per_stage + LEAVING_STEPS, clock.step_count - 1)
        lasting = staying(ground, begin, last)
        for step in range(begin, min((stage + 1) * clock.steps_per_stage, last)):
            open_to = np.argwhere(through.occupied(step) & lasting[step - begin])
            if len(open_to):
                moves, away = (np.abs(open_to - np.array(cell)).sum(axis=1) for cell in (start, goal))
                row, column = open_to[np.lexsort((away, moves))[0]].tolist()
                cells = through.route((row, column)) or ()
                return (*cells, *[(row, column)] * (step - first_step + 1 - len(cells)))
    return None


def staying(ground: Ground, first_step: int, last_step: int) -> Bools:
    """The cells in which one is safe, and from which one can stay so until the last of some steps.

    Returns:
        Shape [step, north, east], from the first step to the last.
    """
    rows, columns = ground.shape
    clock = ground.clock
    safe = ~ground.hazard
    stays = np.zeros((last_step - first_step + 1, rows, columns), dtype=np.bool_)
    stays[-1] = safe[clock.stage_of_step(last_step)]
    for step in range(last_step, first_step, -1):
        stage, before = clock.stage_of_step(step), clock.stage_of_step(step - 1)
        onward = np.pad(stays[step - first_step], 1)
        into, leaving = stays[step - first_step - 1], safe[before]
        if ground.occupancy is Occupancy.STRICT:
            leaving = leaving & safe[stage]
            onward[1:-1, 1:-1] &= safe[before]
        for move, (up, right) in OFFSETS.items():
            there = onward[1 + up : 1 + up + rows, 1 + right : 1 + right + columns]
            if move is not Move.STAY and ground.flyable is not None:
                there = there & ground.flyable[before, move]
            into |= there & leaving
    return stays
