"""Random numbers that vary smoothly: Gaussian noise with a correlation length on each of its axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

_NODES_A_LENGTH = 1.5  # of white noise to a correlation length, dense enough that none of them shows
_REACH = 2.0  # correlation lengths past the range's ends: what lies farther weighs exp(-4) of the nearest


@dataclass(frozen=True, slots=True)
class NoiseAxis:
    """An axis of smooth noise: the range it is asked in, and the length over which it is correlated.

    Two values a distance d apart have the correlation exp(-d^2 / (2 length^2)), to a few thousandths.
    """

    low: float
    high: float
    length: float

    def nodes(self) -> Floats:
        """Where the white noise lies, shape (n,): two thirds of a length apart, reaching past both ends."""
        step = self.length / _NODES_A_LENGTH
        first = np.floor(self.low / step - _REACH * _NODES_A_LENGTH)
        last = np.ceil(self.high / step + _REACH * _NODES_A_LENGTH)
        return np.asarray(step * np.arange(first, last + 1.0), dtype=np.float64)

    def weights(self, values: ArrayLike) -> Floats:
        """What each node adds to the noise at each value, shape (len(values), n); squares add up to one."""
        distance = (np.atleast_1d(np.asarray(values, dtype=np.float64))[:, np.newaxis] - self.nodes()) / (
            self.length
        )
        weights = np.exp(-(distance**2))
        return np.asarray(weights / np.sqrt((weights**2).sum(axis=1, keepdims=True)), dtype=np.float64)


class SmoothNoise:
    """A Gaussian random function of mean 0 and variance 1 everywhere, smooth on each of its axes.

    White noise on a lattice, blurred along each axis with a Gaussian and scaled by the weights' squares. So
    it can be asked anywhere, in any order, and answers the same.
    """

    def __init__(self, axes: Sequence[NoiseAxis], rng: np.random.Generator) -> None:
        self._axes = tuple(axes)
        self._white = rng.standard_normal([axis.nodes().size for axis in axes])

    def on(self, *values: ArrayLike) -> Floats:
        """The noise where lists of values, one for each axis, cross; shape (len(first), len(second), ...)."""
        noise = self._white
        for axis, asked in zip(self._axes, values, strict=True):  # each turn moves one axis to the end
            noise = np.tensordot(noise, axis.weights(asked), axes=(0, 1))
        return np.asarray(noise, dtype=np.float64)
