"""The planner's speed as ratios of one run, on the paper's size, against the literal version."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
from literal_planner import LiteralWorld, best_score, earliest_carried, earliest_queued
from numpy.typing import NDArray
from tables import duration, table, times
from timing import clocked, own_peak_mb, say
from worlds import Cell, drifting_patches, size_of, start_and_goals

from planner.arrivals import sweep_arrivals
from planner.departures import search_departures
from planner.exact import search_exact
from planner.ground import Ground, Occupancy
from planner.hazards import StageClock
from planner.score import Weights
from planner.staged import StagedProblem, score_worth, scores_at, search
from planner.survival import probability_from_members, search_survival
from planner.sweep import sweep
from planner.trace import routes

TITLE = "The planner against the paper in pure Python"
STEPS = 30
CAP = 30
WEIGHTS = Weights(clearance_cap_cells=float(CAP))
MEMORY_LIMIT_MB = 300
Hazard = NDArray[np.bool_]


def ground_of(hazard: Hazard) -> Ground:
    return Ground(hazard, StageClock(0.0, len(hazard), STEPS), Occupancy.PAPER)


def problem_of(hazard: Hazard) -> StagedProblem:
    return StagedProblem(hazard, StageClock(0.0, len(hazard), STEPS), WEIGHTS, Occupancy.PAPER)


def earliest_routes(hazard: Hazard, start: Cell, goals: list[Cell]) -> list[tuple[Cell, ...] | None]:
    arrivals = sweep_arrivals(ground_of(hazard), start)
    return [arrivals.route(goal) for goal in goals]


def best_routes(hazard: Hazard, start: Cell, goals: list[Cell]) -> list[float | None]:
    """Clearance, sweep and the best-scoring route of every goal: what the literal version gives."""
    problem = problem_of(hazard)
    clearance = problem.clearance()
    swept = sweep(problem.ground, score_worth(clearance, WEIGHTS), start, goals)
    scores = scores_at(swept, clearance, WEIGHTS, goals)
    steps = scores.argmax(axis=0)
    found = [index for index in range(len(goals)) if np.isfinite(scores[steps[index], index])]
    routes(swept, [(goals[index], int(steps[index])) for index in found])
    return [float(scores[steps[index], index]) if index in found else None for index in range(len(goals))]


def survival_routes(hazard: Hazard, start: Cell, goals: list[Cell]) -> None:
    """Of one forecast, blurred: the hazard itself is only a probability here, so that all cells are open."""
    chance = probability_from_members(hazard[None])
    search_survival(chance, ground_of(np.zeros_like(hazard)), start, goals)


def literal_times(hazard: Hazard, start: Cell, goals: list[Cell]) -> dict[str, float]:
    """Processor times of the literal version [s].

    Raises:
        SystemExit: if it does not find the routes and scores that the planner finds.
    """
    world = LiteralWorld(hazard.tolist(), STEPS)
    carried_s, carried = clocked(lambda: earliest_carried(world, start, goals), 2)
    say(f"literal arrivals, every cell carried: {carried_s:.1f} s")
    queued_s, queued = clocked(lambda: earliest_queued(world, start, goals), 3)
    say(f"literal arrivals, a queue in each stage: {queued_s:.1f} s")
    weights = (WEIGHTS.alpha, WEIGHTS.beta, WEIGHTS.gamma, WEIGHTS.delta)
    score_s, score = clocked(lambda: best_score(world, start, goals, weights, CAP))
    say(f"literal score: {score_s:.1f} s")
    same = [None if route is None else list(route) for route in earliest_routes(hazard, start, goals)]
    agree = [
        one is None if other is None else one is not None and abs(one[0] - other) < 1e-6
        for one, other in zip(score, best_routes(hazard, start, goals), strict=True)
    ]
    if not (queued == carried == same and all(agree)):
        raise SystemExit("the literal version and the planner do not find the same")
    return {"carried": carried_s, "queued": queued_s, "score": score_s}


def against_literal(hazard: Hazard, start: Cell, goals: list[Cell]) -> str:
    literal_s = literal_times(hazard, start, goals)
    problem = problem_of(hazard)
    arrivals_s, _ = clocked(lambda: earliest_routes(hazard, start, goals), 9)
    field_s, _ = clocked(lambda: sweep_arrivals(ground_of(hazard), start).field(), 5)
    score_s, _ = clocked(lambda: best_routes(hazard, start, goals), 5)
    all_s, _ = clocked(lambda: search(problem, start, goals), 3)
    survival_s, _ = clocked(lambda: survival_routes(hazard, start, goals), 3)
    exact_s, found = clocked(lambda: search_exact(problem, start, goals), 2)
    gap = max(entry.gap for entry in found)

    def row(what: str, reference: str, own_s: float, target: str) -> list[str]:
        ratio = times(literal_s[reference] / own_s)
        return [what, duration(literal_s[reference]), duration(own_s), ratio, target]

    rows = [
        row("earliest arrivals with routes; literal: every cell carried", "carried", arrivals_s, "400 x"),
        row("the same; literal with a queue in each stage", "queued", arrivals_s, ""),
        row("arrival step of every cell", "carried", field_s, ""),
        row("best score with clearance and routes", "score", score_s, "60 x"),
        row("... and every stage's best routes, reasons for the missed", "score", all_s, ""),
        row("survival with routes (literal: score)", "score", survival_s, "60 x"),
        row(f"exact optimum, gap {gap:.0e} (literal: score)", "score", exact_s, ""),
    ]
    return table(["", "literal", "galeway", "faster", "target: at least"], rows)


PLANS = {"nothing": None, "arrivals": earliest_routes, "best score": best_routes, "survival": survival_routes}


def memory(hazard: Hazard) -> str:
    """Of a process for each objective, which does nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        matrices = Path(folder) / "hazard.npy"
        np.save(matrices, hazard)
        rows = []
        for what in PLANS:
            command = [sys.executable, __file__, what, str(matrices)]
            done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
            limit = f"{MEMORY_LIMIT_MB} MB" if what in ("best score", "survival") else ""
            rows.append([what, f"{float(done.stdout):.0f} MB", limit])
    return table(["a process that plans", "peak memory", "target: at most"], rows)


def print_peak_memory(what: str, matrices: Path) -> None:
    """What a child process does: plan, and print its peak memory [MB]."""
    hazard = np.load(matrices)
    start, goals = start_and_goals(hazard)
    if plan := PLANS[what]:
        plan(hazard, start, goals)
    print(own_peak_mb())


def growth(hazard: Hazard) -> str:
    def row(part: Hazard, count: int = 10) -> list[str]:
        start, goals = start_and_goals(part, count)
        arrivals_s, _ = clocked(lambda: earliest_routes(part, start, goals), 5)
        score_s, _ = clocked(lambda: best_routes(part, start, goals), 3)
        return [duration(arrivals_s), duration(score_s)]

    rows = []
    for share in (8, 4, 2, 1):
        part = hazard[:, : hazard.shape[1] // share, : hazard.shape[2] // share]
        rows.append([f"{part.shape[1]} x {part.shape[2]} cells", *row(part)])
    rows += [[f"{stages} stages", *row(hazard[:stages])] for stages in (3, 6, 12, 18)]
    rows += [[f"{count:,} goals", *row(hazard, count)] for count in (1, 10, 100, 1000, 10_000)]
    ground, (start, goals) = ground_of(hazard), start_and_goals(hazard)
    for slots in (1, 6, 18, 54):
        steps = range(0, len(hazard) * STEPS, len(hazard) * STEPS // slots)
        own_s, _ = clocked(partial(search_departures, ground, start, goals, steps), 2)
        rows.append([f"{slots} departures", duration(own_s), ""])
    return table(["", "arrivals", "best score"], rows)


def section() -> str:
    hazard = drifting_patches()
    start, goals = start_and_goals(hazard)
    ratios = against_literal(hazard, start, goals)
    say("memory and growth")
    return f"""\
{size_of(hazard, STEPS)}, {len(goals)} goals,
in patches that drift (`benchmarks/worlds.py`). The reference is the paper word for word, one cell after the
other (`benchmarks/literal_planner.py`), with the clearance capped at {CAP} cells. The run checks that both
find the same routes and scores; some of the goals have no route, and both say so. Times are processor times.

{ratios}

The queue is no longer the paper's sweep: within a stage it looks around from each cell once, which holds for
arrivals and not for scores. It is the leaner reference; the target is set against the sweep. Survival and the
exact optimum have no literal version; they are set against the score's, which visits the same cells.

{memory(hazard)}

How the cost grows, everything else as above:

{growth(hazard)}

Goals cost nothing in the sweep, only their routes. A departure costs one sweep of arrivals, less the later it
is."""


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print_peak_memory(sys.argv[1], Path(sys.argv[2]))
    else:
        print(section())
