"""What a flight has to say on limits: its quantities, and what happened in it, over any part of it."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from aircraft.path import Phase
from recordings.figures import Moment, Places
from recordings.limit_kinds import PHASES, During, Happening, Span, Window
from recordings.quantities import DURATIONS, QUANTITIES, Measured
from recordings.recorder import Outcome
from recordings.tracking import Tracking

Mask = NDArray[np.bool_]

ON_GROUND_M = 1.0
"""Height of the centre of gravity above ground from which on downward an aircraft has come down."""


class Evidence:
    """One flight. What is measured is measured once, however many limits are on it."""

    def __init__(self, tracking: Tracking) -> None:
        self.tracking, self.recording = tracking, tracking.recording
        series = tracking.series
        self.quantity = cache(lambda name: QUANTITIES[name].measure(series, self.recording))

    def duration(self, name: str) -> tuple[Measured, Measured]:
        """How far beyond its bound a figure of time lay, and what is shown of it."""
        series = self.tracking.series
        beyond, shown = DURATIONS[name].measure(series, self.recording)
        return Measured(beyond, series.samples), Measured(shown, series.samples)

    def within(self, window: Window, places: Places) -> Mask:
        """Which places lie in a part of the flight."""
        inside = np.ones(len(places.time_s), np.bool_)
        for clause in window:
            if isinstance(clause, During):
                part = np.isin(places.phase, [PHASES[name] for name in clause.phases])
            else:
                part = self._between(clause, places)
            inside &= part ^ clause.excepted
        return inside

    def _between(self, clause: Span, places: Places) -> Mask:
        departure_s = self.recording.header.plan.departure_s
        inside = np.ones(len(places.time_s), np.bool_)
        if clause.start is not None:
            inside &= places.time_s >= clause.start.since(departure_s)
        if clause.end is not None:
            inside &= places.time_s <= clause.end.since(departure_s)
        return inside

    def happened(self, happening: Happening) -> Places:
        """When and where it did, in the order of time; the lead-in counts for events."""
        if happening.quoted:
            words = happening.words.casefold()
            return self._at(
                [event.time_s for event in self.recording.events if words in event.text.casefold()]
            )
        if happening.words == Outcome.ARRIVED:
            return self._arrival()
        ended = self._at([self.recording.end_time_s] if self.tracking.outcome == happening.words else [])
        if happening.words == Outcome.CRASHED and not len(ended.time_s):
            return self._came_down()
        return ended

    def lowest(self) -> Moment | None:
        """The moment of least height above ground."""
        heights, places = self.quantity("height_above_ground_m")
        if not len(heights):
            return None
        lowest = int(heights.argmin())
        return places.moment(lowest, float(heights[lowest]), "m above ground")

    def _arrival(self) -> Places:
        """The passing of the last waypoint, or, if it ended a step before, the nearest moment."""
        if not self.tracking.arrived:
            return self._at([])
        passed, nearest = self.tracking.series.passed.chosen(np.array([-1])), self.tracking.worst["arrived"]
        return self._at([nearest.time_s]) if np.isnan(passed.time_s).any() else passed

    def _came_down(self) -> Places:
        """Where the flight was on the ground first, whatever it was that ended it."""
        heights, places = self.quantity("height_above_ground_m")
        return places.chosen(np.flatnonzero(heights <= ON_GROUND_M)[:1])

    def _at(self, times_s: list[float]) -> Places:
        """Where the aircraft was at these times."""
        state, series = self.recording.state, self.tracking.series
        at = (np.searchsorted(state["time_s"], times_s, side="right") - 1).clip(0)
        lead_in = np.full(len(state) - len(series.phase), Phase.LEAD_IN, np.int64)
        return Places(
            np.array(times_s, np.float64),
            np.degrees(state["lat_rad"][at]),
            np.degrees(state["lon_rad"][at]),
            np.concatenate([lead_in, series.phase])[at],
        )
