"""Every policy on a case, judged in the truth: one row a policy and goal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from planner.clearance import capped_clearance
from planner.route import evaluate
from planner.score import Weights
from sim.reproduce.judging import Fate, first_hazard
from sim.reproduce.outlook import Case, Floats
from sim.reproduce.policies import POLICIES, Planned
from sim.reproduce.tuning import Tuning

Row = dict[str, Any]
"""What one policy's plan for one goal came to, as JSON knows it."""


def judge_policies(case: Case, names: Sequence[str], tuning: Tuning) -> dict[str, list[Row]]:
    """What each policy comes to, for each goal."""
    clearance = capped_clearance(case.truth.hazard, tuning.weights.clearance_cap_cells)
    return {
        name: [
            _row(planned, case, clearance, tuning.weights) for planned in POLICIES[name].plan(case, tuning)
        ]
        for name in names
    }


def _row(planned: Planned, case: Case, clearance: Floats, weights: Weights) -> Row:
    """The fate, and of a way its steps and moves, its score in the truth, and the members it survives in."""
    way, clock = planned.way, case.truth.clock
    if way is None:
        return {"fate": Fate.NO_ROUTE}
    lost_at = first_hazard(way, case.truth)
    safe = Fate.SAFE if lost_at is None else Fate.LOST
    route = evaluate(way, clearance, clock, weights)
    return {
        "fate": Fate.ABSTAINED if planned.abstained else safe,
        "would_be": safe,
        "steps": len(way) - 1,
        "moves": route.moves,
        "lost_at": lost_at,
        "score": round(route.score, 6),
        "members_survived": round(case.outlook.ensemble.survived(way, clock), 6),
    }
