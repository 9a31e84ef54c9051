"""Earliest arrivals as bits against the enumeration of every route, and what the field promises."""

import numpy as np
import pytest

from planner.arrivals import NEVER, sweep_arrivals
from planner.bits import BitGrid
from planner.errors import OutsideGridError
from planner.ground import Ground, Occupancy
from planner.hazards import Move, StageClock


@pytest.mark.parametrize("block", range(5))
def test_agrees_with_every_route(block, small_world, enumeration):
    for seed in range(block * 60, block * 60 + 60):
        ground, start, _ = small_world(seed)
        expected = np.full(ground.shape, NEVER)
        for cells in enumeration.every_route(ground, start):
            at = cells[-1]
            step = len(cells) - 1
            expected[at] = step if expected[at] == NEVER else min(step, expected[at])
        arrivals = sweep_arrivals(ground, start)
        assert np.array_equal(arrivals.field(), expected)
        for goal in np.ndindex(ground.shape):
            route = arrivals.route(goal)
            assert (route is None) == (expected[goal] == NEVER)
            if route is not None:
                assert (route[0], route[-1], len(route) - 1) == (start, goal, expected[goal])
                assert list(route) in list(enumeration.every_route(ground, start))


@pytest.mark.parametrize("columns", [1, 7, 8, 63, 64, 65, 127, 128, 130])
def test_rows_of_any_width_lose_no_cell_and_do_not_leak_into_the_next(columns):
    hazard = np.zeros((1, 3, columns), dtype=bool)
    ground = Ground(hazard, StageClock(0.0, 1, columns + 3))
    field = sweep_arrivals(ground, (1, columns // 2)).field()
    rows, east = np.indices(field.shape)
    assert np.array_equal(field, abs(rows - 1) + abs(east - columns // 2))
    grid = BitGrid(3, columns)
    sheet = np.random.default_rng(columns).random((2, 3, columns)) < 0.5
    assert np.array_equal(grid.unpack(grid.pack(sheet)), sheet)


def test_without_change_arrival_is_the_breadth_first_distance():
    hazard = np.zeros((3, 9, 9), dtype=bool)
    hazard[:, 4, :8] = True
    arrivals = sweep_arrivals(Ground(hazard, StageClock(0.0, 3, 12)), (0, 0))
    assert arrivals.step_at((8, 0)) == 8 + 2 * 8
    assert arrivals.step_at((4, 3)) is None
    assert arrivals.can_occupy((8, 0)).sum() == 36 - 24


@pytest.mark.parametrize("occupancy", list(Occupancy))
def test_moves_that_cannot_be_flown_are_not_made(occupancy):
    random = np.random.default_rng(2)
    hazard = random.random((3, 7, 70)) < 0.2
    hazard[:, 3, 3] = False
    flyable = random.random((3, len(Move), 7, 70)) < 0.7
    ground = Ground(hazard, StageClock(0.0, 3, 9), occupancy, flyable)
    arrivals = sweep_arrivals(ground, (3, 3))
    reached = {(3, 3)}
    for step in range(1, 27):
        fresh = set()
        for here in reached:
            for move, (rows, columns) in {
                Move.STAY: (0, 0),
                Move.NORTH: (1, 0),
                Move.SOUTH: (-1, 0),
                Move.EAST: (0, 1),
                Move.WEST: (0, -1),
            }.items():
                there = here[0] + rows, here[1] + columns
                if 0 <= there[0] < 7 and 0 <= there[1] < 70 and ground.may_move(step, here, move):
                    fresh.add(there)
        reached = fresh
        assert {tuple(map(int, cell)) for cell in np.argwhere(arrivals.occupied(step))} == reached
    route = arrivals.route(max(reached, key=lambda cell: cell[1]))
    assert route[0] == (3, 3)


def test_a_start_in_hazard_reaches_nothing_and_one_off_the_grid_is_an_error():
    hazard = np.zeros((1, 2, 2), dtype=bool)
    hazard[0, 0, 0] = True
    ground = Ground(hazard, StageClock(0.0, 1, 3))
    assert (sweep_arrivals(ground, (0, 0)).field() == NEVER).all()
    with pytest.raises(OutsideGridError):
        sweep_arrivals(ground, (2, 0))


def test_a_later_departure_starts_then():
    ground = Ground(np.zeros((2, 1, 5), dtype=bool), StageClock(0.0, 2, 5))
    arrivals = sweep_arrivals(ground, (0, 0), first_step=4)
    assert arrivals.step_at((0, 3)) == 7
    assert len(arrivals.route((0, 3))) == 4
    assert not arrivals.occupied(3).any()
