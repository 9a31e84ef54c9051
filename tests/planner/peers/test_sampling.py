"""Systems in the plane, by OMPL: shorter than four moves allow, and, but for one, blind to time."""

import math

import numpy as np
import pytest

pytest.importorskip("ompl")

from planner.peers import PEERS
from planner.peers.breach import first_breach
from planner.peers.plane import SPACING, free_around

BLIND = ["prm", "rrt", "rrt-star"]


@pytest.mark.parametrize("name", BLIND)
def test_cuts_corners_on_a_map_that_stands_still(name, still):
    route = PEERS[name].find(still.problem, still.start, still.goal, seed=2)
    assert first_breach(still.problem, still.start, still.goal, route) is None
    straight = 2 * math.hypot(3.0, 4.5)
    assert route.arrival_step > straight  # around the wall's end
    if name != "rrt":
        assert route.arrival_step < still.optimum


def test_rrt_star_is_shorter_than_rrt(still):
    rrt, star = (
        [
            PEERS[name].find(still.problem, still.start, still.goal, seed=seed).arrival_step
            for seed in range(3)
        ]
        for name in ("rrt", "rrt-star")
    )
    assert max(star) < min(rrt)


@pytest.mark.parametrize("name", BLIND)
def test_does_not_wait_for_a_door(name, door):
    assert not PEERS[name].find(door.problem, door.start, door.goal).found


@pytest.mark.parametrize("name", BLIND)
def test_flies_into_a_gap_that_has_shut(name, shutter):
    route = PEERS[name].find(shutter.problem, shutter.start, shutter.goal, seed=1)
    assert "is in hazard" in first_breach(shutter.problem, shutter.start, shutter.goal, route)


@pytest.mark.parametrize("fixture", ["still", "door", "shutter"])
def test_with_time_as_a_coordinate_it_waits_and_goes_round(fixture, request):
    world = request.getfixturevalue(fixture)
    route = PEERS["rrt-time"].find(world.problem, world.start, world.goal, seed=1)
    assert route.found, route.reason
    assert first_breach(world.problem, world.start, world.goal, route) is None


def test_with_time_as_a_coordinate_it_is_crooked(still):
    arrivals = [
        PEERS["rrt-time"].find(still.problem, still.start, still.goal, seed=seed).arrival_step
        for seed in range(3)
    ]
    star = PEERS["rrt-star"].find(still.problem, still.start, still.goal).arrival_step
    assert min(arrivals) > star


def test_what_lies_between_two_free_points_is_free():
    lots = np.random.default_rng(5)
    hazard = lots.random((6, 6)) < 0.3
    free = free_around(hazard)
    for _ in range(2000):
        row, column = lots.uniform(-0.4, 5.4, 2)
        if free(row, column):
            for angle in np.linspace(0.0, 2.0 * math.pi, 9):
                near = (
                    round(row + 0.499 * SPACING * math.sin(angle)),
                    round(column + 0.499 * SPACING * math.cos(angle)),
                )
                assert not hazard[near]
    assert not free(-0.45, 0.0)
    assert not free(5.45, 0.0)
    assert not free(7.0, 0.0)
    assert not free(0.0, -9.0)
