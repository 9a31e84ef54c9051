"""The genetic algorithm and the ant colony: good guesses in the changing map, without proof."""

import random
from itertools import pairwise

import numpy as np
import pytest

from planner.peers import PEERS, ant_colony, genetic
from planner.peers.breach import first_breach


def test_ants_find_ways_that_need_waiting(door):
    route = PEERS["ants"].find(door.problem, door.start, door.goal, seed=1)
    assert first_breach(door.problem, door.start, door.goal, route) is None
    assert door.optimum <= route.arrival_step <= door.optimum + 4


def test_ants_do_not_come_back_to_a_cell(siding):
    assert not PEERS["ants"].find(siding.problem, siding.start, siding.goal).found


def test_ants_improve_on_the_first_of_them(still, monkeypatch):
    colony = PEERS["ants"].find(still.problem, still.start, still.goal, seed=4)
    monkeypatch.setattr(ant_colony, "ROUNDS", 1)
    first = PEERS["ants"].find(still.problem, still.start, still.goal, seed=4)
    assert still.optimum <= colony.arrival_step < first.arrival_step


def test_genes_learn_to_wait_for_the_door(door):
    pytest.importorskip("pygad")
    route = PEERS["genetic"].find(door.problem, door.start, door.goal, seed=1)
    assert route.found, route.reason
    assert first_breach(door.problem, door.start, door.goal, route) is None
    assert route.arrival_step >= door.optimum


def test_genes_are_no_proof_where_the_way_is_winding(world, monkeypatch):
    pytest.importorskip("pygad")
    monkeypatch.setattr(genetic, "GENERATIONS", 20)
    hazard = np.zeros((20, 9, 21), dtype=bool)
    for column in range(2, 20, 3):  # seven walls whose gaps take turns
        hazard[:, :, column] = True
        hazard[:, 0 if column % 2 else 8, column] = False
    problem = world(hazard)
    assert PEERS["staged"].find(problem, (4, 0), (4, 20)).found
    route = PEERS["genetic"].find(problem, (4, 0), (4, 20))
    assert not route.found
    assert "still breaks" in route.reason


def test_genes_leave_the_generators_of_others_alone(still, monkeypatch):
    pytest.importorskip("pygad")
    monkeypatch.setattr(genetic, "GENERATIONS", 2)
    random.seed(7)
    expected = random.random()
    random.seed(7)
    PEERS["genetic"].find(still.problem, still.start, still.goal)
    assert random.random() == expected


def test_a_staircase_takes_one_move_a_step():
    for there in [(0, 0), (3, 0), (0, 5), (4, 7), (7, 4)]:
        way = [(4, 4), *genetic._staircase((4, 4), there)]
        assert way[-1] == there
        steps = [abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in pairwise(way)]
        assert steps == [1] * (abs(there[0] - 4) + abs(there[1] - 4))
