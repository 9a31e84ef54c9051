"""Colours of the weather: bands of wind speed, blue where it is safe and red where it is hazard."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Bytes = NDArray[np.uint8]
Speeds = NDArray[np.float32]
Colour = tuple[int, int, int]

_CALM_MPS = (5.0, 10.0, 15.0, 20.0, 25.0)
_CALM_COLOURS: tuple[Colour, ...] = (
    (15, 21, 33),
    (19, 29, 46),
    (24, 37, 59),
    (29, 45, 72),
    (34, 53, 85),
    (39, 61, 98),
)
_HAZARD_MPS = (17.5, 25.0, 33.0, 43.0)  # gale, storm, and hurricanes of categories 1 and 2
_HAZARD_COLOURS: tuple[Colour, ...] = (
    (104, 28, 33),
    (136, 36, 33),
    (168, 46, 32),
    (200, 62, 32),
    (232, 88, 38),
)
_OFF_MPS = (-5.0, -2.0, -1.0, -0.1, 0.1, 1.0, 2.0, 5.0)
_OFF_COLOURS: tuple[Colour, ...] = (
    (64, 214, 190),
    (34, 160, 142),
    (22, 108, 98),
    (18, 62, 62),
    (24, 27, 34),
    (74, 44, 88),
    (126, 62, 148),
    (180, 84, 206),
    (236, 130, 255),
)


class Band(NamedTuple):
    """A colour of the scale; it ends where the next band begins. `from_mps`: None in the lowest."""

    from_mps: float | None
    colour: Colour


def wind_scale(threshold_mps: float) -> list[Band]:
    """The bands of wind speed from calm up, split at the threshold."""
    calm = [0.0, *(edge for edge in _CALM_MPS if edge < threshold_mps)]
    hazard = [threshold_mps, *(edge for edge in _HAZARD_MPS if edge > threshold_mps)]
    reds = _HAZARD_COLOURS[len(_HAZARD_COLOURS) - len(hazard) :]
    return [Band(*band) for band in zip([*calm, *hazard], [*_CALM_COLOURS[: len(calm)], *reds], strict=True)]


def difference_scale() -> list[Band]:
    """The bands of how much stronger the wind truly is than forecast."""
    return [Band(*band) for band in zip([None, *_OFF_MPS], _OFF_COLOURS, strict=True)]


def wind_picture(hazard: Bools, speed_mps: Speeds, threshold_mps: float) -> Bytes:
    """Hazard in reds, other wind in blues, brighter where it blows stronger; shape (*shape, 3).

    Args:
        hazard: whether the wind exceeds the threshold at any time of the stage.
        speed_mps: at one time of it, of the same shape.
        threshold_mps: the least that hazard is drawn with.
    """
    bad = len(_CALM_COLOURS) + _band(np.maximum(speed_mps, threshold_mps), _HAZARD_MPS)
    band = np.where(hazard, bad, _band(speed_mps, _CALM_MPS))
    return np.array([*_CALM_COLOURS, *_HAZARD_COLOURS], np.uint8).take(band, axis=0)


def difference_picture(truth_mps: Speeds, forecast_mps: Speeds) -> Bytes:
    """Where the true wind is stronger than forecast, and where weaker; grey where it is as forecast."""
    off_mps = truth_mps.astype(np.float64) - forecast_mps
    return np.array(_OFF_COLOURS, np.uint8).take(_band(off_mps, _OFF_MPS), axis=0)


def _band(values: NDArray[np.floating], edges: Sequence[float]) -> NDArray[np.uint8]:
    """The number of edges at or below each value: for a few, several times faster than `np.digitize`."""
    band = np.zeros(values.shape, np.uint8)
    for edge in edges:
        band += values >= edge
    return band
