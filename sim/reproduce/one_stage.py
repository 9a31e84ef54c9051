"""Figure 2: within one stage, the route of plain BFS against that of the staged planner."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from planner.clearance import capped_clearance
from planner.hazards import Bools
from planner.route import Route, evaluate
from sim.reproduce.days_judged import DayTask
from sim.reproduce.outlook import Case
from sim.reproduce.policies import paper_score, plain_bfs
from sim.reproduce.tuning import Tuning


class Pair(NamedTuple):
    """Both routes to one goal."""

    bfs: Route
    staged: Route


def one_stage(case: Case) -> Case:
    """The same mission where the weather of the first stage, as forecast, stays for ever."""
    clock = replace(case.truth.clock, stage_count=1, steps_per_stage=case.truth.clock.step_count)
    hazard: Bools = case.outlook.hazard[:1]
    flyable = None if case.outlook.flyable is None else case.outlook.flyable[:1]
    truth = replace(case.truth, hazard=hazard, clock=clock, flyable=flyable)
    outlook = replace(case.outlook, forecast=lambda: hazard, clock=clock, flyable=flyable)
    return replace(case, truth=truth, outlook=outlook, later=None)


def pairs(case: Case, tuning: Tuning) -> list[Pair]:
    """The routes to the goals that both reach, on the map of one stage; `case` is of that stage alone."""
    clock, weights = case.truth.clock, tuning.weights
    clearance = capped_clearance(case.truth.hazard, weights.clearance_cap_cells)
    return [
        Pair(*(evaluate(way, clearance, clock, weights) for way in (bfs.way, staged.way)))
        for bfs, staged in zip(plain_bfs(case, tuning), paper_score(case, tuning), strict=True)
        if bfs.way is not None and staged.way is not None
    ]


def compare_in_one_stage(task: DayTask) -> list[dict[str, Any]]:
    """Clearance, moves and score of both routes to each goal that both reach."""
    return [
        {name: _figures(route) for name, route in pair._asdict().items()}
        for pair in pairs(one_stage(task.source.case(task.day)), task.tuning)
    ]


def longest_pair(task: DayTask) -> tuple[Pair, Bools] | None:
    """The pair of a day with the longest BFS route, and the map; None where no goal is reached."""
    case = one_stage(task.source.case(task.day))
    found = pairs(case, task.tuning)
    if not found:
        return None
    return max(found, key=lambda pair: pair.bfs.moves), case.truth.hazard[0]


def _figures(route: Route) -> dict[str, float]:
    clear = np.array(route.clearance_cells)
    return {
        "min_clearance_cells": float(clear.min()),
        "mean_clearance_cells": float(clear.mean()),
        "beside_hazard": float((clear < 2.0).mean()),
        "moves": route.moves,
        "steps": len(route.cells) - 1,
        "score": route.score,
    }
