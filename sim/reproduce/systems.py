"""Wind of weather systems that move: lows and highs that drift with a steady flow, grow and fade.

The wind blows along the lines of a stream function, so that it neither gathers nor spreads. That is smooth
Gaussian noise over time and area, asked where the air of the drift comes from. Every moment is made as strong
as it takes for a given share of the area to be above the threshold, which wanders between two limits.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from planner.windfield import WindField
from sim.reproduce.worlds import World
from sim.weather.smooth_noise import NoiseAxis, SmoothNoise

Floats = NDArray[np.float64]

SYSTEM_STREAM = 9
"""Seeds the weather systems, together with the seed of the day."""

SHEET_S = 3600.0
"""Between two times of the field, unless stages are shorter."""


def moving_systems(world: World, seed: int) -> WindField:
    """The true wind of a day on the world's nodes, from departure to an hour after the horizon."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, SYSTEM_STREAM]))
    nodes, clock = world.nodes, world.clock
    end_s = clock.stage_count * clock.stage_s + 3600.0
    sheet_s = min(SHEET_S, clock.stage_s)
    time_s: Floats = np.arange(math.ceil(end_s / sheet_s) + 1, dtype=np.float64) * sheet_s
    north_m, east_m = _metres(nodes)
    course_rad, drift_mps = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(*world.drifts_mps)
    drift_north, drift_east = drift_mps * math.cos(course_rad), drift_mps * math.sin(course_rad)
    stream = SmoothNoise(
        (
            NoiseAxis(0.0, float(time_s[-1]), world.life_s),
            _axis(north_m, -drift_north * time_s[-1], world.system_m),
            _axis(east_m, -drift_east * time_s[-1], world.system_m),
        ),
        rng,
    )
    shares = _shares(world, time_s, rng)
    sheets = []
    for at_s, share in zip(time_s.tolist(), shares.tolist(), strict=True):
        (psi,) = stream.on(at_s, north_m - drift_north * at_s, east_m - drift_east * at_s)
        along_north, along_east = np.gradient(psi, north_m, east_m)
        wind = np.stack([along_east, -along_north])
        sheets.append(wind * world.threshold_mps / np.quantile(np.hypot(*wind), 1.0 - share))
    north_mps, east_mps = np.array(sheets, dtype=np.float32).transpose(1, 0, 2, 3)
    return WindField(nodes, clock.departure_s + time_s, north_mps.copy(), east_mps.copy())


def _metres(grid: Grid) -> tuple[Floats, Floats]:
    return grid.north_cell_m[0] * np.arange(grid.rows), grid.east_cell_m[0] * np.arange(grid.columns)


def _axis(along_m: Floats, moved_m: float, length_m: float) -> NoiseAxis:
    """All places along an axis from which air can have come."""
    return NoiseAxis(min(0.0, moved_m), float(along_m[-1]) + max(0.0, moved_m), length_m)


def _shares(world: World, time_s: Floats, rng: np.random.Generator) -> Floats:
    """The share of the area over the threshold at each time: smooth, and between the world's two."""
    low, high = world.shares
    wave = SmoothNoise((NoiseAxis(0.0, float(time_s[-1]), world.life_s / 2.0),), rng).on(time_s)
    return low + (high - low) * (0.5 + 0.5 * np.tanh(wave))
