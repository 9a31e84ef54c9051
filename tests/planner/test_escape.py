"""The nearest way out of hazard, cell by cell, against every way there is on small grids."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.escape import staying, way_out
from planner.ground import Cell, Ground, Occupancy
from planner.hazards import OFFSETS, Move, StageClock

CLOCK = StageClock(0.0, stage_count=4, steps_per_stage=3, step_s=120.0)
SIZE = 5
START, GOAL = (2, 2), (4, 4)
LAST = CLOCK.step_count - 1


def random_ground(seed: int, occupancy: Occupancy = Occupancy.STRICT) -> Ground:
    """Much hazard, the start in it at first, and moves of which a third cannot be flown."""
    random = np.random.default_rng(seed)
    hazard = random.random((CLOCK.stage_count, SIZE, SIZE)) < random.uniform(0.4, 0.85)
    flyable = random.random((CLOCK.stage_count, len(Move), SIZE, SIZE)) < 0.67
    for move, (rows, columns) in OFFSETS.items():
        for row, column in np.ndindex(SIZE, SIZE):
            if not (0 <= row + rows < SIZE and 0 <= column + columns < SIZE):
                flyable[:, move, row, column] = False
    flyable[:, Move.STAY] = True
    return Ground(hazard, CLOCK, occupancy, flyable)


def onward(ground: Ground, step: int, here: Cell) -> list[tuple[Move, Cell]]:
    """Where one can be a step later, hazard or not."""
    assert ground.flyable is not None
    moves = np.flatnonzero(ground.flyable[CLOCK.stage_of_step(step)][:, here[0], here[1]])
    return [
        (Move(move), (here[0] + OFFSETS[Move(move)][0], here[1] + OFFSETS[Move(move)][1])) for move in moves
    ]


def in_hazard(ground: Ground, step: int, cell: Cell) -> bool:
    return bool(ground.hazard[CLOCK.stage_of_step(step)][cell])


def stays(ground: Ground, step: int, cell: Cell, until: int) -> bool:
    """Whether one can be in the open from a step to another one, by trying everything."""

    @cache
    def tried(at: int, here: Cell) -> bool:
        if in_hazard(ground, at, here):
            return False
        if at == until:
            return True
        return any(
            tried(at + 1, there)
            for move, there in onward(ground, at, here)
            if ground.may_move(at + 1, here, move)
        )

    return tried(step, cell)


def known(step: int) -> int:
    """Two steps after the forecast that follows a step is issued."""
    return min((CLOCK.stage_of_step(step) + 1) * CLOCK.steps_per_stage + 2, LAST)


def soonest(ground: Ground, first_step: int) -> tuple[int, dict[Cell, int]] | None:
    """When one is out for good, and with how few moves in each of the cells in which one can be, by hand."""
    fewest = {START: 0}
    for step in range(first_step, LAST):
        out = {
            cell: moves
            for cell, moves in fewest.items()
            if step < known(step) and stays(ground, step, cell, known(step))
        }
        if out:
            return step, out
        after: dict[Cell, int] = {}
        for here, moves in fewest.items():
            for move, there in onward(ground, step, here):
                after[there] = min(after.get(there, 99), moves + (move is not Move.STAY))
        fewest = after
    return None


@settings(max_examples=250, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, CLOCK.step_count - 3), st.sampled_from(list(Occupancy)))
def test_nobody_is_sooner_out_of_hazard_for_good(seed: int, first_step: int, occupancy: Occupancy) -> None:
    ground = random_ground(seed, occupancy)
    ground.hazard[CLOCK.stage_of_step(first_step)][START] = True
    cells = way_out(ground, START, GOAL, first_step=first_step)
    best = soonest(ground, first_step)
    if best is None:
        assert cells is None
        return
    step, out = best
    assert cells is not None
    assert (cells[0], len(cells) - 1) == (START, step - first_step)
    for at, (here, there) in enumerate(pairwise(cells), first_step):
        assert there in [cell for _, cell in onward(ground, at, here)]

    def apart(one: Cell, other: Cell) -> int:
        return abs(one[0] - other[0]) + abs(one[1] - other[1])

    assert cells[-1] in out
    assert (apart(START, cells[-1]), apart(GOAL, cells[-1])) == min(
        (apart(START, cell), apart(GOAL, cell)) for cell in out
    )


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(list(Occupancy)))
def test_where_one_can_stay_is_where_some_way_stays(seed: int, occupancy: Occupancy) -> None:
    ground = random_ground(seed, occupancy)
    found = staying(ground, 2, 8)
    for step in range(2, 9):
        for cell in np.ndindex(SIZE, SIZE):
            assert found[(step - 2, *cell)] == stays(ground, step, cell, 8), (step, cell)


def walled(*open_to: tuple[int, Cell]) -> Ground:
    """Hazard everywhere, but for cells from a stage on."""
    hazard = np.ones((CLOCK.stage_count, SIZE, SIZE), dtype=np.bool_)
    for stage, cell in open_to:
        hazard[(slice(stage, None), *cell)] = False
    return Ground(hazard, CLOCK)


def test_the_nearest_open_cell_is_left_for_and_of_two_the_one_toward_the_goal() -> None:
    assert way_out(walled((0, (4, 2)), (0, (2, 3)), (0, (2, 1))), START, GOAL, first_step=1) == (
        (2, 2),
        (2, 3),
    )


def test_a_cell_that_closes_again_is_no_way_out_but_one_from_which_another_is_reached_is() -> None:
    ground = walled((0, (2, 4)))
    ground.hazard[0, 2, 1] = False
    out = way_out(ground, START, GOAL, first_step=0)
    assert out == ((2, 2), (2, 3), (2, 4))
    ground.hazard[:, 3, 1] = False
    assert way_out(ground, START, GOAL, first_step=0) == ((2, 2), (2, 1))
    assert way_out(ground, START, GOAL, first_step=1) == ((2, 2), (2, 3), (2, 4))  # too late for (3, 1)


def test_it_waits_where_hazard_passes_sooner_than_it_could_be_left() -> None:
    assert way_out(walled((1, START), (0, (0, 0))), START, GOAL, first_step=1) == (START,) * 3


def test_where_nothing_is_open_there_is_no_way_out() -> None:
    assert way_out(walled(), START, GOAL, first_step=0) is None
    shut = walled((0, (2, 3)))
    assert shut.flyable is None
    flyable = np.zeros((CLOCK.stage_count, len(Move), SIZE, SIZE), dtype=np.bool_)
    flyable[:, Move.STAY] = True
    still = Ground(shut.hazard, CLOCK, flyable=flyable)
    assert way_out(still, START, GOAL, first_step=0) is None
