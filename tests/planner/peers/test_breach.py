"""The referee that judges every route."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.hazards import Move
from planner.peers.breach import cells_crossed, first_breach
from planner.peers.route import PeerRoute, TrackPoint
from planner.staged import Occupancy


@pytest.fixture
def hazard():
    hazard = np.zeros((2, 3, 4), dtype=bool)
    hazard[1, 0, 2] = True
    return hazard


@pytest.mark.parametrize(
    ("steps", "cells", "breach"),
    [
        (5, [(0, 0), (0, 1)], None),
        (4, [(0, 0), (0, 0), (0, 0), (0, 0), (0, 0), (0, 1)], None),
        (5, [(0, 0), (1, 1), (0, 1)], "jumps"),
        (3, [(0, 0), (0, 1), (0, 1), (0, 2), (0, 1)], "(0, 2) is in hazard in stage 1"),
        (5, [(0, 1)], "leads from"),
        (5, [(0, 0)], "leads from"),
        (5, [(0, 0)] * 11 + [(0, 1)], "takes 11 steps of 9"),
    ],
)
def test_judges_cells(world, hazard, steps, cells, breach):
    said = first_breach(world(hazard, steps), (0, 0), (0, 1), PeerRoute(tuple(cells)))
    assert said is None if breach is None else breach in said


def test_strict_asks_both_stages_of_both_cells(world, hazard):
    leaving = PeerRoute(((0, 2), (0, 2), (0, 3)))  # out of the cell as its hazard begins
    paper, strict = (
        first_breach(world(hazard, 2, occupancy), (0, 2), (0, 3), leaving)
        for occupancy in (Occupancy.PAPER, Occupancy.STRICT)
    )
    assert paper is None
    assert "(0, 2) is in hazard in stage 1" in strict


def test_moves_that_cannot_be_flown_break_the_rules(world, hazard):
    flyable = np.ones((2, len(Move), 3, 4), dtype=bool)
    flyable[0, Move.EAST, 0, 0] = False
    problem = world(hazard, flyable=flyable)
    assert "EAST" in first_breach(problem, (0, 0), (0, 1), PeerRoute(((0, 0), (0, 1))))
    around = PeerRoute(((0, 0), (1, 0), (1, 1), (0, 1)))
    assert first_breach(problem, (0, 0), (0, 1), around) is None


@pytest.mark.parametrize(
    ("track", "breach"),
    [
        ([(0, 0, 0), (math.sqrt(13.0), 2, 3)], None),
        ([(0, 0, 0), (2, 2, 3)], "flies 3.61 cells in 2.00 steps"),
        ([(0, 0, 0), (5, 0, 0), (9, 2, 3)], None),
        ([(0, 0, 0), (4, 0, 2), (4.5, 0, 2), (6, 2, 3)], "flies 2.24 cells in 1.50 steps"),
        ([(0, 0, 0), (4, 0, 2), (6, 0, 2), (8.5, 2, 3)], "(0, 2) is in hazard"),
        ([(0, 0, 0), (4, -1, 2), (9, 2, 3)], "off the grid"),
        ([(1, 0, 0), (9, 2, 3)], "leads from"),
        ([(0, 0, 0), (9.5, 2, 3)], "takes 9.5 steps of 9"),
    ],
)
def test_judges_tracks(world, hazard, track, breach):
    route = PeerRoute(track=tuple(TrackPoint(*map(float, point)) for point in track))
    said = first_breach(world(hazard), (0, 0), (2, 3), route)
    assert said is None if breach is None else breach in said


places = st.floats(-0.49, 5.49)


@settings(max_examples=100, deadline=None)
@given(places, places, places, places, st.floats(0.0, 12.0), st.floats(0.1, 12.0))
def test_a_leg_is_cut_into_the_cells_that_dense_samples_meet(row, column, to_row, to_column, step, length):
    here, there = TrackPoint(step, row, column), TrackPoint(step + length, to_row, to_column)
    pieces = {(int(at) // 5, cell) for at, cell in cells_crossed(here, there, 5)}
    shares = np.linspace(0.0, 1.0, 2001)[1:-1]
    near = 1e-6  # samples on a border belong to either side
    for share in shares:
        at, place = (
            step + share * length,
            (row + share * (to_row - row), column + share * (to_column - column)),
        )
        borders = [abs((value + 0.5) % 1.0) for value in place] + [at % 5.0]
        if (
            min(min(border, size - border) for border, size in zip(borders, (1.0, 1.0, 5.0), strict=True))
            > near
        ):
            cell = math.floor(place[0] + 0.5), math.floor(place[1] + 0.5)
            assert (int(at // 5), cell) in pieces


def test_a_planner_with_a_speed_of_its_own_may_be_faster_but_not_go_back_in_time(world, hazard):
    quick = PeerRoute(track=(TrackPoint(0.0, 0.0, 0.0), TrackPoint(2.0, 2.0, 3.0)))
    back = PeerRoute(track=(TrackPoint(0.0, 0.0, 0.0), TrackPoint(4.0, 0.0, 1.0), TrackPoint(3.0, 2.0, 3.0)))
    at_once = PeerRoute(track=(TrackPoint(0.0, 0.0, 0.0), TrackPoint(0.0, 2.0, 3.0)))
    assert first_breach(world(hazard), (0, 0), (2, 3), quick, fastest=math.inf) is None
    assert first_breach(world(hazard), (0, 0), (2, 3), quick, fastest=1.7) is not None
    assert "-1.00 steps" in first_breach(world(hazard), (0, 0), (2, 3), back, fastest=math.inf)
    assert "0.00 steps" in first_breach(world(hazard), (0, 0), (2, 3), at_once, fastest=math.inf)


def test_no_route_breaks_nothing(world, hazard):
    assert first_breach(world(hazard), (0, 0), (0, 1), PeerRoute(reason="none")) is None
