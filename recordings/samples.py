"""Collects samples and gives them as tables, in the precision in which they are recorded."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from aircraft.state import FlightState
from recordings.recorder import GuidanceSample
from recordings.schema import (
    ESTIMATE_COLUMNS,
    GUIDANCE_COLUMNS,
    SAMPLES_PER_CHUNK,
    STATE_COLUMNS,
    Column,
)

Floats = NDArray[np.float64]

ESTIMATE_PLACES = [STATE_COLUMNS.index(column) for column in ESTIMATE_COLUMNS]
"""Which fields of a state are estimated."""

MOST = 5 * SAMPLES_PER_CHUNK
"""Samples that are kept at a time: a whole number of the chunks of an MCAP file, five minutes at 10 Hz."""

_STATE = struct.Struct(f"={len(STATE_COLUMNS)}d")
_GUIDANCE = struct.Struct(f"={len(GUIDANCE_COLUMNS)}d")
_SECOND_SLACK_S = 1e-6  # times that should be whole seconds may be off by rounding


class Samples:
    """The last samples of a flight: of one recorder, or shared by several, for which each is kept once.

    When `MOST` are kept they make room for the next one: every recorder has to have taken them by then.
    They are kept as plain numbers in one place, where the objects they came in would fill the memory that the
    processor has at hand.

    `total`: how many there were since the flight began.
    """

    __slots__ = ("_begin", "_guidance", "_guidance_table", "_rounded", "_state_table", "_states", "total")

    def __init__(self) -> None:
        self._states, self._guidance = bytearray(MOST * _STATE.size), bytearray(MOST * _GUIDANCE.size)
        self._state_table = np.frombuffer(self._states).reshape(MOST, -1)
        self._guidance_table = np.frombuffer(self._guidance).reshape(MOST, -1)
        self._begin = self._rounded = self.total = 0

    def add(self, state: FlightState, guidance: GuidanceSample) -> None:
        """Keep one sample."""
        count = self.total - self._begin
        if count == MOST:
            self._begin, self._rounded, count = self.total, 0, 0
        path_m, across_m, above_m, late_s, phase, command = guidance
        _STATE.pack_into(self._states, count * _STATE.size, *state)
        _GUIDANCE.pack_into(
            self._guidance,
            count * _GUIDANCE.size,
            state[0],
            path_m,
            across_m,
            above_m,
            late_s,
            phase,
            *command,
        )
        self.total += 1  # the last of all, so that half a sample is none

    def between(self, begin: int, end: int) -> tuple[Floats, Floats]:
        """The samples of the flight from number `begin` to before number `end`, which have to be kept still.

        Returns:
            Their columns, `STATE_COLUMNS` and `GUIDANCE_COLUMNS`, each of shape (samples, columns); good
            until the next sample comes.
        """
        count = self.total - self._begin
        new = slice(self._rounded, count)
        self._rounded = count
        for table, columns in ((self._state_table, STATE_COLUMNS), (self._guidance_table, GUIDANCE_COLUMNS)):
            table[new] = rounded(table[new], columns)
        wanted = slice(begin - self._begin, end - self._begin)
        return self._state_table[wanted], self._guidance_table[wanted]


def rounded(table: Floats, columns: Sequence[Column]) -> Floats:
    """A table with its columns rounded to their steps; what is not finite stays so."""
    per_step = np.array([1.0 / column.step if column.step else 1.0 for column in columns])
    with np.errstate(over="ignore"):
        result: Floats = table * per_step
        np.rint(result, out=result)
        result /= per_step
    for index, column in enumerate(columns):
        if not column.step:
            result[:, index] = table[:, index]
    return result


def firsts(times_s: Floats, last_s: float) -> NDArray[np.intp]:
    """The places of the first samples of all seconds that begin after the second of `last_s`."""
    seconds = np.floor(times_s + _SECOND_SLACK_S)
    return np.flatnonzero(np.diff(seconds, prepend=np.floor(last_s + _SECOND_SLACK_S)) > 0.0)
