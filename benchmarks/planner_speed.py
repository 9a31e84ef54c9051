"""The planner's speed as ratios of one run, on the paper's size, against the literal version in pure Python.

Run with `python benchmarks/planner_speed.py`; `--skip-literal` leaves out the minutes that the literal
version takes. The wall times say little by themselves; the ratios hold from machine to machine.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np
from literal_planner import LiteralWorld, best_score, earliest_carried, earliest_queued
from numpy.typing import NDArray
from worlds import Cell, drifting_patches, start_and_goals

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

T = TypeVar("T")
STEPS = 30
CAP = 30
WEIGHTS = Weights(clearance_cap_cells=float(CAP))
Hazard = NDArray[np.bool_]


def clocked(call: Callable[[], T], repeats: int = 1) -> tuple[float, T]:
    """The least of some wall times, and what the call gave."""
    best = float("inf")
    for _ in range(repeats):
        begin = time.perf_counter()
        found = call()
        best = min(best, time.perf_counter() - begin)
    return best, found


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


def report(name: str, wall_s: float, literal_s: float | None = None) -> None:
    ratio = f"  {literal_s / wall_s:8.0f} x faster than literal" if literal_s else ""
    print(f"{name:52s} {wall_s * 1e3:10.1f} ms{ratio}", flush=True)


def literal_times(hazard: Hazard, start: Cell, goals: list[Cell]) -> dict[str, float]:
    world = LiteralWorld(hazard.tolist(), STEPS)
    queued_s, queued = clocked(lambda: earliest_queued(world, start, goals))
    carried_s, carried = clocked(lambda: earliest_carried(world, start, goals))
    ours = earliest_routes(hazard, start, goals)
    same = [None if route is None else list(route) for route in ours]
    weights = (WEIGHTS.alpha, WEIGHTS.beta, WEIGHTS.gamma, WEIGHTS.delta)
    score_s, score = clocked(lambda: best_score(world, start, goals, weights, CAP))
    agree = [
        one is None if other is None else one is not None and abs(one[0] - other) < 1e-6
        for one, other in zip(score, best_routes(hazard, start, goals), strict=True)
    ]
    if not (queued == carried == same and all(agree)):
        raise SystemExit("the literal version and the planner do not find the same")
    report("literal: arrivals, every cell carried", carried_s)
    report("literal: arrivals, a queue in each stage", queued_s)
    report("literal: best score", score_s)
    return {"carried": carried_s, "queued": queued_s, "score": score_s}


def compare(hazard: Hazard, start: Cell, goals: list[Cell], *, literal: bool) -> None:
    times = literal_times(hazard, start, goals) if literal else {}
    arrivals_s, _ = clocked(lambda: earliest_routes(hazard, start, goals), 7)
    report("arrivals with routes (against carried)", arrivals_s, times.get("carried"))
    if literal:
        report("arrivals with routes (against queued)", arrivals_s, times["queued"])
    arrivals = sweep_arrivals(ground_of(hazard), start)
    report("  and the arrival step of every cell", clocked(arrivals.field, 3)[0])
    score_s, _ = clocked(lambda: best_routes(hazard, start, goals), 5)
    report("best score with routes", score_s, times.get("score"))
    problem = problem_of(hazard)
    all_s, _ = clocked(lambda: search(problem, start, goals), 3)
    report("  and every stage's routes, reasons for the missed", all_s, times.get("score"))
    chance = probability_from_members(hazard[None])
    open_ground = ground_of(np.zeros_like(hazard))
    survival_s, _ = clocked(lambda: search_survival(chance, open_ground, start, goals), 3)
    report("survival with routes", survival_s, times.get("score"))
    exact_s, found = clocked(lambda: search_exact(problem, start, goals))
    report("exact optimum with routes", exact_s, times.get("score"))
    print(f"  largest gap left: {max(entry.gap for entry in found):.1e}")


def growth(hazard: Hazard) -> None:
    print("\ncost against ...       arrivals   best score   [ms]")

    def row(name: str, part: Hazard, count: int = 10) -> None:
        start, goals = start_and_goals(part, count)
        first = clocked(lambda: earliest_routes(part, start, goals), 3)[0]
        second = clocked(lambda: best_routes(part, start, goals), 2)[0]
        print(f"{name:20s} {first * 1e3:10.1f} {second * 1e3:12.1f}", flush=True)

    for share in (4, 2, 1):
        part = hazard[:, : 548 // share, : 421 // share]
        row(f"{part.shape[1]} x {part.shape[2]} cells", part)
    for stages in (3, 6, 12, 18):
        row(f"{stages} stages", hazard[:stages])
    for count in (1, 10, 100, 1000):
        row(f"{count} goals", hazard, count)
    start, goals = start_and_goals(hazard)
    for slots in (1, 10, 54):
        steps = range(0, 540, 540 // slots)[:slots]
        ground = ground_of(hazard)
        wall_s, _ = clocked(lambda g=ground, s=steps: search_departures(g, start, goals, s))
        print(f"{f'{slots} departures':20s} {wall_s * 1e3:10.1f}")


def peak_memory(what: str, matrices: Path) -> float:
    """The largest resident size of a process that does nothing else [MB]."""
    done = subprocess.run(
        [sys.executable, __file__, "--only", what, str(matrices)], check=True, capture_output=True, text=True
    )
    return float(done.stdout) / 1000.0


def only(what: str, matrices: Path) -> None:
    hazard = np.load(matrices)
    start, goals = start_and_goals(hazard)
    if what == "arrivals":
        earliest_routes(hazard, start, goals)
    elif what == "score":
        best_routes(hazard, start, goals)
    status = Path("/proc/self/status").read_text(
        encoding="ascii"
    )  # not getrusage: that counts the parent too
    print(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM")))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--skip-literal", action="store_true")
    parser.add_argument("--only", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.only:
        only(options.only[0], Path(options.only[1]))
        return
    hazard = drifting_patches()
    start, goals = start_and_goals(hazard)
    stages, rows, columns = hazard.shape
    print(f"{rows} x {columns} cells, {stages} stages of {STEPS} steps, {len(goals)} goals")
    print(f"hazard {hazard.mean(axis=(1, 2)).min():.0%} to {hazard.mean(axis=(1, 2)).max():.0%} of the cells")
    compare(hazard, start, goals, literal=not options.skip_literal)
    with tempfile.TemporaryDirectory() as folder:
        matrices = Path(folder) / "hazard.npy"
        np.save(matrices, hazard)
        for what in ("nothing", "arrivals", "score"):
            print(f"peak memory of a process that plans {what}: {peak_memory(what, matrices):.0f} MB")
    growth(hazard)


if __name__ == "__main__":
    main()
