"""The two timelines of a Rerun recording: time since departure, and the same moments as dates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr
from numpy.typing import NDArray

TIMELINE = "flight_time"
"""Time since departure, a duration."""

UTC_TIMELINE = "utc"
"""The same moments as dates."""


@dataclass(frozen=True)
class FlightTimes:
    """Puts seconds since departure on both timelines. `departure_s`: seconds since 1970-01-01 UTC."""

    departure_s: float

    def set(self, stream: rr.RecordingStream, time_s: float) -> None:
        """What is logged next is of this time."""
        stream.set_time(TIMELINE, duration=np.timedelta64(_nanoseconds(time_s), "ns"))
        stream.set_time(UTC_TIMELINE, timestamp=self.utc(time_s))

    def columns(self, time_s: NDArray[np.float64]) -> list[rr.TimeColumn]:
        """The times of many rows."""
        dates = self.utc(0.0) + _durations(time_s)
        return [*self.since_departure(time_s), rr.TimeColumn(UTC_TIMELINE, timestamp=dates)]

    def since_departure(self, time_s: NDArray[np.float64]) -> list[rr.TimeColumn]:
        """The times of many rows on the first timeline alone, where eight bytes a row count."""
        return [rr.TimeColumn(TIMELINE, duration=_durations(time_s))]

    def utc(self, time_s: float) -> np.datetime64:
        """The date, to a nanosecond."""
        return np.datetime64(_nanoseconds(self.departure_s) + _nanoseconds(time_s), "ns")


def _durations(time_s: NDArray[np.float64]) -> NDArray[np.timedelta64]:
    return np.rint(time_s * 1e9).astype("timedelta64[ns]")


def _nanoseconds(time_s: float) -> int:
    return round(time_s * 1e9)
