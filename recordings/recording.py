"""A recording as read back: everything that was known before take-off, and the flight as columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from aircraft.reference import Reference
from planner.grid import Grid
from planner.plans import Plan
from recordings.recorder import FlightHeader, Layer, Outcome, PlanIssue
from recordings.schema import ESTIMATE, GUIDANCE, STATE


@dataclass(frozen=True, slots=True, eq=False)
class HazardSheet:
    """The hazardous cells of one stage: `hazard` is [north, east] on `grid`, valid from `time_s`.

    `wind_north_mps`, `wind_east_mps`: of the same shape, toward, to sixteenths of m/s and linear between some
    of the cells; None in recordings that do not hold them.
    `closed`: those that are hazardous for another reason than the mean wind, likewise; None for none.
    `altitude_m`: that of the wind, above the ellipsoid, half-way where the flight is between two levels; None
    in recordings that do not hold it.
    """

    layer: Layer
    stage: int
    time_s: float
    threshold_mps: float
    grid: Grid
    hazard: NDArray[np.bool_]
    wind_north_mps: NDArray[np.float32] | None = None
    wind_east_mps: NDArray[np.float32] | None = None
    closed: NDArray[np.bool_] | None = None
    altitude_m: float | None = None


@dataclass(frozen=True, slots=True)
class Event:
    """A line of the log; `time_s` since departure."""

    time_s: float
    text: str


class Issue(NamedTuple):
    """A reference, and from when on it was followed, since departure.

    It passes the last waypoints of the plan that was in force then.
    """

    time_s: float
    reference: Reference


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """One flight, whole or what is left of it.

    `state`, `guidance`: numpy structured arrays, shape (samples,), fields as in `schema.STATE_COLUMNS` and
    `schema.GUIDANCE_COLUMNS`: `recording.state["lat_rad"]` is an array. `estimate`: what sensors and
    estimators made of the state, fields as in `schema.ESTIMATE_COLUMNS`, empty where they are perfect.
    `references`: in the order followed, the first that of the header; others begin where the aircraft was.
    `plans`: the first that of the header, then what each forecast issued in flight made of it.
    `hazards`: by layer, in the order written. `outcome`: INCOMPLETE for a recording that just stops, and then
    `end_time_s` is the last sample's. `missing`: what an incomplete recording lacks, for people; empty if
    `complete`.
    """

    header: FlightHeader
    state: NDArray[np.void]
    guidance: NDArray[np.void]
    estimate: NDArray[np.void]
    references: tuple[Issue, ...]
    plans: tuple[PlanIssue, ...]
    hazards: tuple[HazardSheet, ...]
    events: tuple[Event, ...]
    outcome: Outcome
    outcome_detail: str
    end_time_s: float
    missing: str = ""

    @property
    def plan(self) -> Plan:
        """The last one: what was flown, and what was still to be flown at the end."""
        return self.plans[-1].plan

    @property
    def first_waypoints(self) -> tuple[int, ...]:
        """Of each reference the first waypoint that it passes, counted in the plan that was in force then."""
        return tuple(
            len(self._plan_at(issue.time_s).waypoints) - len(issue.reference.waypoint_path_m)
            for issue in self.references
        )

    def _plan_at(self, time_s: float) -> Plan:
        return next(
            (issue.plan for issue in reversed(self.plans) if issue.time_s <= time_s), self.header.plan
        )

    @property
    def columns(self) -> Mapping[str, NDArray[np.void]]:
        """What was sampled, by topic: `recording.columns["/state"]["lat_rad"]`."""
        return {STATE.name: self.state, GUIDANCE.name: self.guidance, ESTIMATE.name: self.estimate}

    @property
    def complete(self) -> bool:
        """Whether all that was written is there, to the outcome."""
        return not self.missing

    @property
    def limits(self) -> tuple[str, ...]:
        """The limits that the scenario set for its flight."""
        return self.header.limits
