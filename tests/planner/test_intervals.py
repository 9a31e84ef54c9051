"""Safe intervals against runs counted cell by cell."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from planner.intervals import SafeIntervals

HAZARDS = hnp.arrays(np.bool_, st.tuples(st.integers(1, 5), st.integers(1, 4), st.integers(1, 4)))


def run_end(hazard, stage, row, column):
    """First stage after the run, 0 in hazard and off the grid."""
    _, rows, columns = hazard.shape
    if not (0 <= row < rows and 0 <= column < columns) or hazard[stage, row, column]:
        return 0
    while stage < len(hazard) and not hazard[stage, row, column]:
        stage += 1
    return stage


@given(hazard=HAZARDS)
def test_runs(hazard):
    intervals = SafeIntervals.of(hazard)
    numbers = set()
    for row, column in np.ndindex(hazard.shape[1:]):
        place = intervals.place_of(row, column)
        assert intervals.cell_of(place) == (row, column)
        for stage, alike in enumerate(hazard[:, row, column]):
            number = int(intervals.run[stage, place])
            assert int(intervals.run_end[stage, place]) == run_end(hazard, stage, row, column)
            assert (number < 0) == alike
            if number >= 0:
                numbers.add(number)
                assert int(intervals.place[number]) == place
                assert intervals.begin[number] <= stage < intervals.end[number]
                assert not hazard[intervals.begin[number] : intervals.end[number], row, column].any()
    assert numbers == set(range(intervals.place.size))
    assert (intervals.run >= 0).sum() == (~hazard).sum()


@given(hazard=HAZARDS, rows=st.integers(-2, 2), columns=st.integers(-2, 2))
def test_a_move_can_be_made_as_long_as_all_its_cells_are_safe(hazard, rows, columns):
    intervals = SafeIntervals.of(hazard)
    swept = [(0, 0), (rows, 0), (rows, columns)]
    for stage in range(len(hazard)):
        joint = intervals.joint_end(stage, [swept])
        for row, column in itertools.product(range(hazard.shape[1]), range(hazard.shape[2])):
            expected = min(run_end(hazard, stage, row + up, column + right) for up, right in swept)
            assert joint[0, intervals.place_of(row, column)] == expected
