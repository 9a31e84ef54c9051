"""A recording as read back: everything that was known before take-off, and the flight as columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.grid import Grid
from recordings.recorder import FlightHeader, Layer, Outcome


@dataclass(frozen=True, slots=True, eq=False)
class HazardSheet:
    """The hazardous cells of one stage: `hazard` is [north, east] on `grid`, valid from `time_s`."""

    layer: Layer
    stage: int
    time_s: float
    threshold_mps: float
    grid: Grid
    hazard: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Event:
    """A line of the log; `time_s` since departure."""

    time_s: float
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """One flight, whole or what is left of it.

    `state`, `guidance`: numpy structured arrays, shape (samples,), fields as in `schema.STATE_COLUMNS` and
    `schema.GUIDANCE_COLUMNS`: `recording.state["lat_rad"]` is an array. `estimate`: what sensors and
    estimators made of the state, fields as in `schema.ESTIMATE_COLUMNS`, empty where they are perfect.
    `hazards`: by layer, in the order written. `outcome`: INCOMPLETE for a recording that just stops, and then
    `end_time_s` is the last sample's. `missing`: what an incomplete recording lacks, for people; empty if
    `complete`.
    """

    header: FlightHeader
    state: NDArray[np.void]
    guidance: NDArray[np.void]
    estimate: NDArray[np.void]
    hazards: tuple[HazardSheet, ...]
    events: tuple[Event, ...]
    outcome: Outcome
    outcome_detail: str
    end_time_s: float
    missing: str = ""

    @property
    def complete(self) -> bool:
        """Whether all that was written is there, to the outcome."""
        return not self.missing

    @property
    def limits(self) -> tuple[str, ...]:
        """The limits that the scenario set for its flight."""
        return self.header.limits
