"""What becomes of a plan in flight, in words: whether path and schedule are kept, and what is done if not.

Path following holds as long as the wind leaves an air speed across it (Stastny & Siegwart, *On flying
backwards*, 2019). Beyond that the aircraft heads into the wind as fast as it can and drifts by no more than
what the wind is faster; afterwards it returns. A schedule is kept by airspeed alone; where the airspeed is at
its end, the aircraft stays on its path and the delay is reported.
"""

from __future__ import annotations

import math
from enum import Enum

from aircraft.envelope import Envelope

_CALMER_MPS = 1.0  # below the highest airspeed, for the wind to count as one that can be flown in again
_ON_PATH_M = 10.0
_TELL_S = 5.0  # off the schedule, with the airspeed at its end
_KEPT_S = 1.0
_STEPS_S = (15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 1800.0, 3600.0)  # off the schedule: told again


class Path(Enum):
    """How the path is followed."""

    FOLLOWED = "on the path"
    BLOWN_OFF = "wind above airspeed"
    RETURNING = "returning to the path"


class Watch:
    """Watches one flight; `path` is how its path is followed now."""

    def __init__(self, envelope: Envelope) -> None:
        self.path = Path.FOLLOWED
        self._news: list[str] = []
        self._fastest_mps = envelope.airspeed_max_mps
        self._told_s = 0.0  # of the delay, early negative; zero while the schedule is kept

    def take(self) -> list[str]:
        """What there is to tell since the last time, the oldest first."""
        if not self._news:
            return []
        news, self._news = self._news, []
        return news

    def note_path(self, cross_m: float, tail_mps: float, cross_wind_mps: float) -> None:
        """Take in where the aircraft is, and the steady wind along its path and across it."""
        blown_off = self.path is Path.BLOWN_OFF
        airspeed_mps = self._fastest_mps - (_CALMER_MPS if blown_off else 0.0)
        spare = airspeed_mps * airspeed_mps - cross_wind_mps * cross_wind_mps
        if spare <= 0.0 or tail_mps + math.sqrt(spare) <= 0.0:
            if not blown_off:
                self.path = Path.BLOWN_OFF
                wind_mps = math.hypot(tail_mps, cross_wind_mps)
                self._news.append(
                    f"wind above airspeed: {wind_mps:.0f} m/s, heading into it at {self._fastest_mps:.0f} m/s"
                )
        elif blown_off:
            self.path = Path.RETURNING
            self._news.append(f"wind below airspeed: returning to the path, {abs(cross_m):.0f} m off")
        elif self.path is Path.RETURNING and abs(cross_m) < _ON_PATH_M:
            self.path = Path.FOLLOWED
            self._news.append("back on the path")

    def note_schedule(self, late_s: float, *, at_fastest: bool, at_slowest: bool) -> None:
        """Take in the time error, late positive, and whether the airspeed is at an end of what is allowed."""
        told_s = self._told_s
        if told_s and (late_s * told_s <= 0.0 or abs(late_s) < _KEPT_S):
            self._told_s = 0.0
            self._news.append("schedule: kept again")
        elif (late_s > _TELL_S and at_fastest) or (late_s < -_TELL_S and at_slowest):
            next_s = next((step for step in _STEPS_S if step > abs(told_s)), math.inf) if told_s else _TELL_S
            if abs(late_s) >= next_s:
                self._told_s = late_s
                end, word = ("fastest", "late") if late_s > 0.0 else ("slowest", "early")
                self._news.append(f"schedule: at the {end}, {word} by {abs(late_s):.0f} s")
