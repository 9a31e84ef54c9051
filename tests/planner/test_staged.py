"""The staged search against a literal version of itself, breadth-first search and its invariants."""

import math
from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from planner.errors import BadFieldError, OutsideGridError
from planner.ground import Occupancy
from planner.hazards import OFFSETS, Move, StageClock, clearance_cells
from planner.route import Route
from planner.score import Weights
from planner.staged import Blocked, StagedProblem, search

# With this gamma, in worlds of so few steps, moves never weigh just as much as whole cells of mean clearance.
# Of two labels worth the same rounding would choose one, and what follows from them differs.
WEIGHTS = Weights(alpha=1.0, beta=2.0, gamma=0.29, delta=0.2, clearance_cap_cells=4.0)


def problem(hazard, steps=3, occupancy=Occupancy.STRICT, flyable=None, weights=WEIGHTS):
    clock = StageClock(0.0, stage_count=len(hazard), steps_per_stage=steps)
    return StagedProblem(np.asarray(hazard, dtype=bool), clock, weights, occupancy, flyable)


def literal(task, start, goal):
    """The sweep as one would write it on paper: a dictionary of labels per step, cell by cell."""
    hazard, clock, weights = task.hazard, task.clock, task.weights
    clearance = clearance_cells(hazard, weights.clearance_cap_cells)
    if hazard[0][start]:
        return {}
    labels = {start: (float(clearance[0][start]), 0)}  # cell: (sum of clearance, moves)
    arrivals = {}
    for step in range(clock.step_count):
        stage, before = clock.stage_of_step(step), clock.stage_of_step(max(step - 1, 0))

        def safe(cell, stage=stage, before=before):
            strict = task.occupancy is Occupancy.STRICT
            return not hazard[stage][cell] and not (strict and hazard[before][cell])

        if step:
            incoming = {}
            for (row, column), (history, moves) in labels.items():
                if task.occupancy is Occupancy.STRICT and not safe((row, column)):
                    continue
                for move, (rows, columns) in OFFSETS.items():
                    cell = row + rows, column + columns
                    if not (0 <= cell[0] < hazard.shape[1] and 0 <= cell[1] < hazard.shape[2]):
                        continue
                    if task.flyable is not None and not task.flyable[before, move, row, column]:
                        continue
                    if safe(cell):
                        length = moves + (move is not Move.STAY)
                        value = weights.beta * history / (step + 1) - weights.gamma * length
                        incoming.setdefault(cell, []).append((value, -move, history, length))
            labels = {}
            for cell, candidates in incoming.items():
                _, _, history, length = max(candidates)
                labels[cell] = (history + float(clearance[stage][cell]), length)
        if goal in labels:
            history, moves = labels[goal]
            arrivals[step] = weights.score(
                clearance=float(clearance[stage][goal]),
                mean_clearance=history / (step + 1),
                moves=moves,
                steps=step,
            )
    return arrivals


def earliest_by_sets(task, start, goal):
    """Earliest arrival by breadth-first search over (step, cell)."""
    queue, seen = deque([(0, start)]), {(0, start)}
    if task.hazard[0][start]:
        return None
    while queue:
        step, cell = queue.popleft()
        if cell == goal:
            return step
        if step + 1 == task.clock.step_count:
            continue
        stages = {task.clock.stage_of_step(step), task.clock.stage_of_step(step + 1)}
        if task.occupancy is Occupancy.PAPER:
            stages = {task.clock.stage_of_step(step + 1)}
        for rows, columns in OFFSETS.values():
            target = cell[0] + rows, cell[1] + columns
            inside = 0 <= target[0] < task.hazard.shape[1] and 0 <= target[1] < task.hazard.shape[2]
            ends = [target] if task.occupancy is Occupancy.PAPER else [cell, target]
            if inside and all(not task.hazard[stage][end] for stage in stages for end in ends):
                state = step + 1, target
                if state not in seen:
                    seen.add(state)
                    queue.append(state)
    return None


def assert_sound(route: Route, task: StagedProblem, start, goal):
    assert route.cells[0] == start
    assert route.cells[-1] == goal
    for step, (here, there) in enumerate(zip(route.cells, route.cells[1:], strict=False)):
        assert abs(here[0] - there[0]) + abs(here[1] - there[1]) <= 1
        stages = {task.clock.stage_of_step(step), task.clock.stage_of_step(step + 1)}
        if task.occupancy is Occupancy.STRICT:
            assert not any(task.hazard[stage][cell] for stage in stages for cell in (here, there))
        assert not task.hazard[task.clock.stage_of_step(step + 1)][there]


hazards = hnp.arrays(
    bool,
    st.tuples(st.integers(1, 4), st.integers(1, 5), st.integers(1, 5)),
    elements=st.sampled_from([False, False, True]),
)


@st.composite
def problems(draw):
    hazard = draw(hazards)
    cell = st.tuples(st.integers(0, hazard.shape[1] - 1), st.integers(0, hazard.shape[2] - 1))
    task = problem(hazard, draw(st.integers(1, 4)), draw(st.sampled_from(Occupancy)))
    return task, draw(cell), draw(cell)


@settings(max_examples=150, deadline=None)
@given(problems())
def test_agrees_with_the_literal_sweep_and_with_breadth_first_search(case):
    task, start, goal = case
    (found,) = search(task, start, [goal])
    arrivals = literal(task, start, goal)
    assert (found.earliest is None) == (not arrivals)
    assert (found.blocked is None) == bool(arrivals)
    assert earliest_by_sets(task, start, goal) == (min(arrivals) if arrivals else None)
    if found.earliest and found.best:
        assert found.earliest.arrival_step == min(arrivals)
        assert found.best.score == pytest.approx(max(arrivals.values()), abs=1e-9)
        for route in (found.earliest, found.best):
            assert route.score == pytest.approx(arrivals[route.arrival_step], abs=1e-9)
            assert_sound(route, task, start, goal)


@settings(max_examples=100, deadline=None)
@given(problems(), st.data())
def test_another_hazard_never_brings_an_arrival_forward(case, data):
    task, start, goal = case
    hazard = task.hazard.copy()
    place = tuple(data.draw(st.integers(0, size - 1)) for size in hazard.shape)
    hazard[place] = True
    (before,) = search(task, start, [goal])
    (after,) = search(problem(hazard, task.clock.steps_per_stage, task.occupancy), start, [goal])
    if after.earliest:
        assert before.earliest
        assert after.earliest.arrival_step >= before.earliest.arrival_step


@settings(max_examples=60, deadline=None)
@given(problems())
def test_mirrored_and_rotated_worlds_give_the_same_arrivals(case):
    task, start, goal = case
    rows, columns = task.hazard.shape[1:]
    (found,) = search(task, start, [goal])
    turns = {
        "mirrored": (np.flip(task.hazard, 2), lambda cell: (cell[0], columns - 1 - cell[1])),
        "rotated": (np.rot90(task.hazard, axes=(1, 2)), lambda cell: (columns - 1 - cell[1], cell[0])),
    }
    for hazard, turned in turns.values():
        other_task = problem(hazard, task.clock.steps_per_stage, task.occupancy)
        (other,) = search(other_task, turned(start), [turned(goal)])
        assert (found.earliest is None) == (other.earliest is None)
        if found.earliest and other.earliest:
            assert other.earliest.arrival_step == found.earliest.arrival_step
    assert rows == task.hazard.shape[1]


def test_without_change_arrival_is_the_breadth_first_distance():
    hazard = np.zeros((2, 6, 6), dtype=bool)
    hazard[:, 2, :5] = True  # a wall with a gap at the east end
    (found,) = search(problem(hazard, steps=20), (0, 0), [(4, 0)])
    assert found.earliest is not None
    assert found.earliest.arrival_step == 4 + 2 * 5


def test_waits_until_the_door_opens():
    hazard = np.zeros((2, 1, 3), dtype=bool)
    hazard[0, 0, 1] = True
    (found,) = search(problem(hazard, steps=5), (0, 0), [(0, 2)])
    assert found.earliest is not None
    assert found.earliest.arrival_step == 5 + 2  # strict: the move out begins once the new stage has begun
    assert found.earliest.waits == 5
    (paper,) = search(problem(hazard, steps=5, occupancy=Occupancy.PAPER), (0, 0), [(0, 2)])
    assert paper.earliest is not None
    assert paper.earliest.arrival_step == 6


def test_a_cell_that_becomes_hazardous_at_the_boundary_is_dropped():
    hazard = np.zeros((2, 1, 2), dtype=bool)
    hazard[1, 0, 0] = True
    (found,) = search(problem(hazard, steps=2), (0, 0), [(0, 0)])
    assert found.earliest is not None
    assert found.best is not None
    assert found.best.arrival_step < 2


def test_moves_that_cannot_be_flown_are_not_made():
    hazard = np.zeros((1, 2, 3), dtype=bool)
    flyable = np.ones((1, len(Move), 2, 3), dtype=bool)
    flyable[0, Move.EAST, 0, :] = False  # no way east along the southern row
    (found,) = search(problem(hazard, steps=10, flyable=flyable), (0, 0), [(0, 2)])
    assert found.earliest is not None
    assert found.earliest.arrival_step == 4
    assert (1, 1) in found.earliest.cells


@pytest.mark.parametrize(
    ("blocked", "hazard"),
    [
        (Blocked.START_IN_HAZARD, [[[True, False, False]]]),
        (Blocked.GOAL_ALWAYS_IN_HAZARD, [[[False, False, True]]]),
        (Blocked.NEVER_REACHABLE, [[[False, True, False]]]),
    ],
)
def test_says_why_there_is_no_route(blocked, hazard):
    (found,) = search(problem(hazard), (0, 0), [(0, 2)])
    assert (found.earliest, found.best, found.blocked) == (None, None, blocked)


def test_all_goals_come_from_one_sweep_in_their_order():
    goals = [(0, 2), (2, 0), (0, 0), (0, 2)]
    found = search(problem(np.zeros((1, 3, 3), dtype=bool), steps=9), (0, 0), goals)
    assert [entry.goal for entry in found] == goals
    assert [entry.earliest.arrival_step for entry in found] == [2, 2, 0, 2]


def test_clearance_weight_zero_and_no_hazard_are_sound():
    weights = Weights(alpha=0.0, beta=0.0, gamma=1.0, delta=1.0)
    (found,) = search(problem(np.zeros((1, 3, 3), dtype=bool), 9, weights=weights), (0, 0), [(2, 2)])
    assert found.best is not None
    assert found.best.score == pytest.approx(-8.0)


@pytest.mark.parametrize("cell", [(-1, 0), (0, 3), (5, 5)])
def test_off_the_grid_is_an_error(cell):
    task = problem(np.zeros((1, 3, 3), dtype=bool))
    with pytest.raises(OutsideGridError, match="rows and columns count from 0"):
        search(task, cell, [(0, 0)])
    with pytest.raises(OutsideGridError, match="off the grid of 3 rows"):
        search(task, (0, 0), [cell])


def test_shapes_that_disagree_are_errors():
    with pytest.raises(BadFieldError, match="do not fit 2 stages"):
        StagedProblem(np.zeros((1, 3, 3), dtype=bool), StageClock(0.0, 2), WEIGHTS)
    with pytest.raises(BadFieldError, match="flyable moves"):
        problem(np.zeros((1, 3, 3), dtype=bool), flyable=np.ones((1, 4, 3, 3), dtype=bool))
    with pytest.raises(BadFieldError):
        StageClock(0.0, stage_count=0)


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0])
def test_weights_must_be_finite(value):
    with pytest.raises(BadFieldError, match="gamma"):
        Weights(gamma=value)
