"""An independent referee: whether a route keeps the rules of a staged problem, on cells or in the plane."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from planner.hazards import OFFSETS
from planner.peers.route import PeerRoute, TrackPoint
from planner.staged import Cell, Occupancy, StagedProblem

_MOVE_OF = {offset: move for move, offset in OFFSETS.items()}


def first_breach(
    problem: StagedProblem, start: Cell, goal: Cell, route: PeerRoute, *, fastest: float = 1.0
) -> str | None:
    """The first rule that a route breaks, in words; None where it keeps them all, or there is no route.

    Of a route in the plane every cell that it crosses must be safe in the stage in which it is crossed, and
    its speed must not exceed `fastest` [cells a step]. Flyable moves are known for the four moves only, so
    they are asked of routes from cell to cell alone.
    """
    if route.cells is not None:
        return _breach_of_cells(problem, start, goal, route.cells)
    if route.track is not None:
        return _breach_of_track(problem, start, goal, route.track, fastest)
    return None


def _breach_of_cells(problem: StagedProblem, start: Cell, goal: Cell, cells: Sequence[Cell]) -> str | None:
    clock, hazard = problem.clock, problem.hazard
    if cells[0] != start or cells[-1] != goal:
        return f"leads from {cells[0]} to {cells[-1]}"
    if len(cells) > clock.step_count:
        return f"takes {len(cells) - 1} steps of {clock.step_count - 1}"
    if hazard[(0, *start)]:
        return "starts in hazard"
    for step, (here, there) in enumerate(pairwise(cells)):
        before, after = clock.stage_of_step(step), clock.stage_of_step(step + 1)
        move = _MOVE_OF.get((there[0] - here[0], there[1] - here[1]))
        if move is None:
            return f"jumps from {here} to {there} after step {step}"
        if problem.flyable is not None and not problem.flyable[(before, move, *here)]:
            return f"the move {move.name} from {here} after step {step} cannot be flown"
        if problem.occupancy is Occupancy.PAPER:
            asked = [(after, there)]
        else:
            asked = [(stage, cell) for stage in (before, after) for cell in (here, there)]
        for stage, cell in asked:
            if hazard[(stage, *cell)]:
                return f"cell {cell} is in hazard in stage {stage}, at step {step + 1}"
    return None


def _breach_of_track(
    problem: StagedProblem, start: Cell, goal: Cell, track: Sequence[TrackPoint], fastest: float
) -> str | None:
    clock, hazard = problem.clock, problem.hazard
    ends = [(round(point.row), round(point.column)) for point in (track[0], track[-1])]
    if ends != [start, goal] or track[0].step != 0.0:
        return f"leads from {ends[0]} at step {track[0].step} to {ends[1]}"
    if track[-1].step > clock.step_count - 1:
        return f"takes {track[-1].step:.1f} steps of {clock.step_count - 1}"
    for here, there in pairwise(track):
        length = math.hypot(there.row - here.row, there.column - here.column)
        steps = there.step - here.step
        too_fast = length > 1e-9 and (steps <= 0.0 or length > fastest * steps * (1.0 + 1e-6))
        if steps < 0.0 or too_fast:
            return f"flies {length:.2f} cells in {steps:.2f} steps after step {here.step:.1f}"
        for step, cell in cells_crossed(here, there, clock.steps_per_stage):
            inside = all(0 <= index < size for index, size in zip(cell, hazard.shape[1:], strict=True))
            if not inside or hazard[(clock.stage_of_step(int(step)), *cell)]:
                return f"cell {cell} is in hazard or off the grid at step {step:.1f}"
    return None


def cells_crossed(here: TrackPoint, there: TrackPoint, steps_per_stage: int) -> Iterator[tuple[float, Cell]]:
    """Every piece of a straight leg that lies in one cell and one stage, by the step and cell of its middle.

    The leg is cut exactly where it crosses the border of a cell (half-way between centres) or of a stage.
    """
    cuts = [0.0, 1.0]
    for low, high, first, spacing in (
        (here.row, there.row, 0.5, 1.0),
        (here.column, there.column, 0.5, 1.0),
        (here.step, there.step, 0.0, float(steps_per_stage)),
    ):
        if low != high:
            bounds = sorted((low, high))
            numbers = range(
                math.floor((bounds[0] - first) / spacing), math.ceil((bounds[1] - first) / spacing) + 1
            )
            cuts.extend((first + spacing * number - low) / (high - low) for number in numbers)
    cuts = sorted(cut for cut in cuts if 0.0 <= cut <= 1.0)
    for begin, end in pairwise(cuts):
        if end - begin > 1e-9:
            share = (begin + end) / 2.0
            row, column = (
                low + share * (high - low)
                for low, high in ((here.row, there.row), (here.column, there.column))
            )
            cell = math.floor(row + 0.5), math.floor(column + 0.5)
            yield here.step + share * (there.step - here.step), cell
