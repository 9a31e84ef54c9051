"""Forecasts as they are issued: one at the beginning of each stage, each with an ensemble of members."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import overload

import numpy as np

from planner.windfield import WindField

FORECAST_STREAM = 6
"""Seeds the errors of forecasts, together with the scenario's seed and the number of a member."""


def error_rng(seed: int, member: int) -> np.random.Generator:
    """The random numbers of the forecast itself (member 0), or of one of its members (1, 2, ...)."""
    return np.random.default_rng(np.random.SeedSequence([seed, FORECAST_STREAM, member]))


class LazyMembers(Sequence[WindField]):
    """The members of an ensemble, each made when it is asked for and kept by nobody."""

    def __init__(self, count: int, make: Callable[[int], WindField]) -> None:
        self._count, self._make = count, make

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> WindField: ...
    @overload
    def __getitem__(self, index: slice) -> LazyMembers: ...
    def __getitem__(self, index: int | slice) -> WindField | LazyMembers:
        chosen = range(self._count)[index]
        if isinstance(chosen, range):
            return LazyMembers(len(chosen), lambda member: self._make(chosen[member]))
        return self._make(chosen)
