"""Ways to plan on a forecast that may be wrong, each for all goals of a mission."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from scipy.sparse import csgraph

from planner.arrivals import sweep_arrivals
from planner.clearance import capped_clearance
from planner.ground import Ground
from planner.peers.one_map import stage_graph, way_back
from planner.score import Weights
from planner.staged import StagedProblem, search
from sim.reproduce.outlook import Case, Outlook, Way
from sim.reproduce.replanned import replanned
from sim.reproduce.safest import Safest
from sim.reproduce.tuning import Tuning


class Planned(NamedTuple):
    """A way to a goal, None where there is none; `abstained`: it is not to be flown."""

    way: Way
    abstained: bool = False


class Policy(NamedTuple):
    """A way to plan: `plan` gives one result a goal. `replans`: it asks for later forecasts."""

    title: str
    plan: Callable[[Case, Tuning], list[Planned]]
    replans: bool = False


def problem(outlook: Outlook, weights: Weights) -> StagedProblem:
    """What the staged search is given."""
    return StagedProblem(outlook.hazard, outlook.clock, weights, outlook.occupancy, outlook.flyable)


def plain_bfs(case: Case, tuning: Tuning) -> list[Planned]:
    """Breadth-first search on the map of the first stage, as if it never changed."""
    outlook = case.outlook
    graph, columns = stage_graph(problem(outlook, tuning.weights), 0), outlook.hazard.shape[2]
    start = case.start[0] * columns + case.start[1]
    _, before = csgraph.breadth_first_order(graph, start)
    ways = [way_back(before, case.start, goal, columns) for goal in case.goals]
    return [Planned(way if way and len(way) <= outlook.clock.step_count else None) for way in ways]


def paper_score(case: Case, tuning: Tuning) -> list[Planned]:
    """The paper's planner: the arrival of the best score by equation (2)."""
    found = search(problem(case.outlook, tuning.weights), case.start, case.goals)
    return [Planned(routes.best.cells if routes.best else None) for routes in found]


def margins(case: Case, tuning: Tuning) -> list[Planned]:
    """The earliest arrival at a distance from hazard: all of it if there is a way, else half of it, none."""
    ways: list[Way] = [None] * len(case.goals)
    clearance = capped_clearance(case.outlook.hazard, tuning.margin_cells + 1.0)
    for cells in (tuning.margin_cells, tuning.margin_cells / 2.0, 0.0):
        if None in ways:
            outlook = case.outlook
            ground = Ground(clearance <= cells, outlook.clock, outlook.occupancy, outlook.flyable)
            earliest = _earliest(ground, case)
            ways = [way or other for way, other in zip(ways, earliest, strict=True)]
    return [Planned(way) for way in ways]


def survival(case: Case, tuning: Tuning) -> list[Planned]:
    """The least sum of -log(1 - p), p the blurred share of members."""
    return [Planned(way) for way in case.once((survival, tuning), lambda: _safest(case, tuning))]


def survival_or_abstain(case: Case, tuning: Tuning) -> list[Planned]:
    """The same, and what survives in too few members is not flown."""
    clock, ensemble = case.outlook.clock, case.outlook.ensemble
    return [
        Planned(way, way is not None and ensemble.survived(way, clock) < tuning.abstain_below)
        for way, _ in survival(case, tuning)
    ]


def survival_replanned(case: Case, tuning: Tuning) -> list[Planned]:
    """The same, found anew from where the aircraft is, at each stage whose forecast casts doubt on it."""
    ways = [planned.way for planned in survival(case, tuning)]
    return [Planned(way) for way in replanned(case, ways, tuning)]


def oracle(case: Case, tuning: Tuning) -> list[Planned]:  # noqa: ARG001 - it has no dials
    """The earliest arrival in the truth: nobody reaches a goal that it does not."""
    return [Planned(way) for way in _earliest(case.truth, case)]


POLICIES: dict[str, Policy] = {
    "bfs": Policy("plain BFS", plain_bfs),
    "score": Policy("the paper's score", paper_score),
    "margins": Policy("margins", margins),
    "survival": Policy("survival", survival),
    "abstain": Policy("survival or abstain", survival_or_abstain),
    "replan": Policy("survival, replanned", survival_replanned, replans=True),
    "oracle": Policy("oracle", oracle),
}


def _safest(case: Case, tuning: Tuning) -> list[Way]:
    safest = Safest(case.outlook, blur_cells=tuning.blur_cells, price=tuning.price)
    return safest.find(case.start, case.goals)


def _earliest(ground: Ground, case: Case) -> list[Way]:
    arrivals = sweep_arrivals(ground, case.start)
    return [arrivals.route(goal) for goal in case.goals]
