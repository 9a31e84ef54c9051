"""Hazard matrices of the paper's size: patches that drift and change, 10 to 35 % of the cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Cell = tuple[int, int]


def drifting_patches(
    rows: int = 548, columns: int = 421, stages: int = 18, seed: int = 3
) -> NDArray[np.bool_]:
    """[stage, row, column]."""
    random = np.random.default_rng(seed)
    noise = random.standard_normal((stages + 6, rows, columns))
    smooth = ndimage.gaussian_filter(noise, (1.5, 14, 14), mode="wrap")[3:-3]
    shares = 0.225 + 0.125 * np.sin(2.0 * np.pi * np.arange(stages) / 9.0)
    return np.stack(
        [sheet > np.quantile(sheet, 1.0 - share) for sheet, share in zip(smooth, shares, strict=True)]
    )


def size_of(hazard: NDArray[np.bool_], steps_per_stage: int) -> str:
    """The world in words."""
    stages, rows, columns = hazard.shape
    shares = hazard.mean(axis=(1, 2))
    return (
        f"{rows} x {columns} cells, {stages} stages of {steps_per_stage} steps, "
        f"{shares.min():.0%} to {shares.max():.0%} of the cells hazardous"
    )


def start_and_goals(hazard: NDArray[np.bool_], count: int = 10, seed: int = 3) -> tuple[Cell, list[Cell]]:
    """A start that is safe at first, a quarter up and in the middle, and goals that are safe at some time."""
    random = np.random.default_rng(seed + 1)
    rows, columns = hazard.shape[1:]
    safe = np.argwhere(~hazard[0])
    nearest = safe[np.abs(safe - [rows // 4, columns // 2]).sum(axis=1).argmin()]
    goals = np.argwhere(~hazard.all(axis=0))
    picked = goals[random.choice(len(goals), count, replace=False)]
    return (int(nearest[0]), int(nearest[1])), [(int(row), int(column)) for row, column in picked]
