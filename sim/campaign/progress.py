"""How far a campaign is: a line for people."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from sim.campaign.row import Row


class Progress:
    """Counts flights, and the time since it was made."""

    def __init__(self, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._clock_s, self._begin_s = clock_s, clock_s()
        self.total = self.done = self._now = self._failed = 0

    def begin(self, total: int, landed: int) -> None:
        """See `Watch.begin`."""
        self.total, self.done = total, landed

    def landed(self, row: Row) -> None:
        """See `Watch.landed`."""
        self.done += 1
        self._now += 1
        self._failed += not row["passed"]

    def line(self) -> str:
        """Rate and time left, as from the flights that have landed since it was made."""
        failed = f"{self._failed} failed"
        if not self._now:
            return failed
        per_flight_s = (self._clock_s() - self._begin_s) / self._now
        left_s = (self.total - self.done) * per_flight_s
        return f"{failed}, {_rate(per_flight_s)}, {_left(left_s)} left"


def _rate(per_flight_s: float) -> str:
    per_hour = 3600.0 / max(per_flight_s, 1e-9)
    if per_hour >= 6000.0:
        return f"{per_hour / 60.0:.0f} flights a minute"
    return f"{per_hour:.0f} flights an hour" if per_hour >= 10.0 else f"{per_hour:.1f} flights an hour"


def _left(time_s: float) -> str:
    if time_s < 59.5:
        return f"{time_s:.0f} s"
    minutes = math.ceil(time_s / 60.0)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60}:{minutes % 60:02d} h"


def counted(flights: int) -> str:
    """In words."""
    return f"{flights} flight{'' if flights == 1 else 's'}"
