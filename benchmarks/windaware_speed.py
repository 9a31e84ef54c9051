"""The wind-aware planner's speed against the staged score search, in one run on one world of the paper's size.

Run with `python benchmarks/windaware_speed.py`. The wall times say little by themselves; the ratios hold.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from planner_speed import best_routes
from scipy import ndimage
from worlds import start_and_goals

from planner.grid import Grid
from planner.hazards import StageClock, hazard_stages
from planner.windfield import WindField


def stormy(rows=548, columns=421, stages=18, seed=3):
    random = np.random.default_rng(seed)
    noise = random.standard_normal((stages + 7, rows, columns))
    smooth = ndimage.gaussian_filter(noise, (1.5, 14, 14), mode="wrap")[3:-3]
    turn = ndimage.gaussian_filter(random.standard_normal((rows, columns)), 40, mode="wrap")
    turn /= turn.std()
    shares = 0.16 + 0.1 * np.sin(2.0 * np.pi * np.arange(stages + 1) / 9.0)
    north, east = np.empty((2, stages + 1, rows, columns), dtype=np.float32)
    for at, (sheet, share) in enumerate(zip(smooth, shares, strict=True)):
        over = (sheet - np.quantile(sheet, 1.0 - share)) / sheet.std()
        speed = np.clip(15.0 * np.exp(0.4 * over), 0.0, 30.0)
        north[at], east[at] = speed * np.cos(turn), speed * np.sin(turn)
    step = 3600.0 / 6_371_000.0
    grid = Grid(np.radians(20.0), np.radians(-90.0), step, step, rows, columns)
    return WindField(grid, np.arange(stages + 1) * 3600.0, north, east)


if __name__ == "__main__":
    from planner.windaware import *
    from planner.windaware import _Search
    from planner.planning import *

    wind = stormy()
    clock = StageClock(0.0, 18, 30)
    t = time.perf_counter()
    hazard = hazard_stages(wind, clock, threshold_mps=15.0, corridor_m=0.0)
    print("hazard", time.perf_counter() - t)
    print(hazard.mean(axis=(1, 2)))
    start, goals = start_and_goals(hazard)
    t = time.perf_counter()
    best_routes(hazard, start, goals)
    print("best", time.perf_counter() - t)
    t = time.perf_counter()
    print(best_routes(hazard, start, goals))
    print("best", time.perf_counter() - t)
    g = wind.grid
    P = lambda n, c: Place(n, float(np.degrees(g.lat_rad[c[0]])), float(np.degrees(g.lon_rad[c[1]])))
    req = PlanningRequest(
        P("s", start),
        tuple(P(f"g{i}", c) for i, c in enumerate(goals)),
        "g0",
        1000.0,
        clock,
        15.0,
        0.0,
        22.0,
        39.0,
        cruise_mps=27.0,
    )
    t = time.perf_counter()
    s = _Search.prepare(wind, req, 8)
    print("prepare", time.perf_counter() - t)
    t = time.perf_counter()
    f = s._sweep(list(s.goals.values()), 0.0)
    print("sweep", time.perf_counter() - t)
    t = time.perf_counter()
    w = s.ways()
    print("ways", time.perf_counter() - t)
    t = time.perf_counter()
    o = s.outcomes(w)
    print("outcomes", time.perf_counter() - t)
    for x in o:
        print(x.name, x.arrival_s, x.reason)
    import cProfile, pstats

    p = cProfile.Profile()
    p.enable()
    s._sweep(list(s.goals.values()), 0.0)
    p.disable()
    pstats.Stats(p).sort_stats("tottime").print_stats(12)
    p = cProfile.Profile()
    p.enable()
    w = s.ways()
    p.disable()
    pstats.Stats(p).sort_stats("cumtime").print_stats(30)
    for k, v in w.items():
        print(k, len(v))
