"""Every route there is, one after the other: the oracle for small worlds."""

from itertools import pairwise

from planner.ground import Occupancy
from planner.hazards import OFFSETS
from planner.score import Weights


def every_route(ground, start, first_step=0):
    """Yield each route as a list of cells, of every length up to the horizon."""
    hazard, clock = ground.hazard, ground.clock
    if hazard[clock.stage_of_step(first_step)][start]:
        return
    stack = [[start]]
    while stack:
        cells = stack.pop()
        yield cells
        step = first_step + len(cells)
        if step == clock.step_count:
            continue
        here = cells[-1]
        stages = {clock.stage_of_step(step - 1), clock.stage_of_step(step)}
        for rows, columns in OFFSETS.values():
            there = here[0] + rows, here[1] + columns
            if not (0 <= there[0] < hazard.shape[1] and 0 <= there[1] < hazard.shape[2]):
                continue
            if ground.occupancy is Occupancy.STRICT:
                safe = not any(hazard[stage][cell] for stage in stages for cell in (here, there))
            else:
                safe = not hazard[clock.stage_of_step(step)][there]
            if safe:
                stack.append([*cells, there])


def score_of(cells, ground, weights: Weights, clearance, first_step=0):
    """Equation (2) by its definition."""
    clear = [clearance[(ground.clock.stage_of_step(first_step + at), *cell)] for at, cell in enumerate(cells)]
    moves = sum(a != b for a, b in pairwise(cells))
    return (
        weights.alpha * clear[-1]
        + weights.beta * sum(clear) / len(clear)
        - weights.gamma * moves
        - weights.delta * (len(cells) - 1)
    )
