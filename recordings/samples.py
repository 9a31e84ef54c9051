"""Collects samples and gives them as tables, in the precision in which they are recorded."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from aircraft.state import FlightState
from recordings.recorder import GuidanceSample
from recordings.schema import GUIDANCE_COLUMNS, STATE_COLUMNS, Column

Floats = NDArray[np.float64]


class Samples:
    """What was sampled since it was last taken."""

    __slots__ = ("_guidance", "_states")

    def __init__(self) -> None:
        self._states: list[FlightState] = []
        self._guidance: list[GuidanceSample] = []

    def __len__(self) -> int:
        return len(self._states)

    def add(self, state: FlightState, guidance: GuidanceSample) -> int:
        """Keep one sample; returns how many there are now."""
        states = self._states
        states.append(state)
        self._guidance.append(guidance)
        return len(states)

    def take(self) -> tuple[Floats, Floats]:
        """The samples' columns, `STATE_COLUMNS` and `GUIDANCE_COLUMNS`, each of shape (samples, columns)."""
        states, guidance = self._states, self._guidance
        self._states, self._guidance = [], []
        state = _table(chain.from_iterable(states), len(states), STATE_COLUMNS)
        flat = chain.from_iterable(
            (flown[0], path_m, across_m, above_m, late_s, phase, *command)
            for flown, (path_m, across_m, above_m, late_s, phase, command) in zip(
                states, guidance, strict=True
            )
        )
        return state, _table(flat, len(states), GUIDANCE_COLUMNS)


def rounded(table: Floats, columns: Sequence[Column]) -> Floats:
    """A table with its columns rounded to their steps; what is not finite stays so."""
    which = [index for index, column in enumerate(columns) if column.step]
    per_step = 1.0 / np.array([columns[index].step for index in which])
    result = table.copy()
    with np.errstate(over="ignore"):
        result[:, which] = np.rint(table[:, which] * per_step) / per_step
    return result


def _table(values: chain[float], count: int, columns: Sequence[Column]) -> Floats:
    return rounded(np.fromiter(values, np.float64, count * len(columns)).reshape(count, -1), columns)
