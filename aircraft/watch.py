"""What becomes of a plan in flight, in words: whether path and schedule are kept, and what is done if not.

Path following holds as long as the wind leaves an air speed across it (Stastny & Siegwart, *On flying
backwards*, 2019). Beyond that the aircraft heads into the wind as fast as it can and drifts by no more than
what the wind is faster; afterwards it returns. A schedule is kept by airspeed; where that is at its end, an
aircraft that is early enough for a circle holds (`aircraft.holding`), and otherwise it stays on its path and
the delay is reported.
"""

from __future__ import annotations

import math
from enum import Enum

from aircraft.envelope import Envelope
from aircraft.schedule import End

_CALMER_MPS = 1.0  # below the highest airspeed, for the wind to count as one that can be flown in again
_ON_PATH_M = 10.0
_TELL_S = 5.0  # off the schedule, with the airspeed at its end
_KEPT_S = 1.0
_STEPS_S = (
    _TELL_S,
    15.0,
    30.0,
    60.0,
    120.0,
    300.0,
    600.0,
    1200.0,
    1800.0,
    3600.0,
)  # off the schedule: told again


class Path(Enum):
    """How the path is followed."""

    FOLLOWED = "on the path"
    BLOWN_OFF = "wind above airspeed"
    RETURNING = "returning to the path"


_FOLLOWED, _BLOWN_OFF, _RETURNING = Path  # by themselves: a member of an `Enum` takes as long as ten names


class Watch:
    """Watches one flight.

    `path`: how its path is followed now. `off_schedule`: whether a delay was told and is not made good yet.
    `news`: what there is to tell, the oldest first.
    """

    def __init__(self, envelope: Envelope) -> None:
        self.path = _FOLLOWED
        self.news: list[str] = []
        self.off_schedule = False
        self._fastest_mps = envelope.airspeed_max_mps
        self._told_s = 0.0  # of the delay, early negative; zero while the schedule is kept

    def take(self) -> list[str]:
        """What there is to tell since the last time, the oldest first."""
        news, self.news = self.news, []
        return news

    def note_path(self, cross_m: float, tail_mps: float, cross_wind_mps: float) -> None:
        """Take in where the aircraft is, and the steady wind along its path and across it."""
        path = self.path
        blown_off = path is _BLOWN_OFF
        airspeed_mps = self._fastest_mps - _CALMER_MPS if blown_off else self._fastest_mps
        spare = airspeed_mps * airspeed_mps - cross_wind_mps * cross_wind_mps
        if spare <= 0.0 or tail_mps + math.sqrt(spare) <= 0.0:
            if not blown_off:
                self.path = _BLOWN_OFF
                wind_mps = math.hypot(tail_mps, cross_wind_mps)
                self.news.append(
                    f"wind above airspeed: {wind_mps:.0f} m/s, heading into it at {self._fastest_mps:.0f} m/s"
                )
        elif blown_off:
            self.path = _RETURNING
            self.news.append(f"wind below airspeed: returning to the path, {abs(cross_m):.0f} m off")
        elif path is _RETURNING and abs(cross_m) < _ON_PATH_M:
            self.path = _FOLLOWED
            self.news.append("back on the path")

    def note_schedule(self, late_s: float, end: End) -> None:
        """Take in the time error, late positive, and the end of the allowed airspeeds that is flown at."""
        if self.off_schedule and (late_s * self._told_s <= 0.0 or abs(late_s) < _KEPT_S):
            self.off_schedule = False
            self._told_s = 0.0
            self.news.append("schedule: kept again")
        elif (end is End.FASTEST and late_s > _TELL_S) or (end is End.SLOWEST and late_s < -_TELL_S):
            next_s = next((step for step in _STEPS_S if step > abs(self._told_s)), math.inf)
            if abs(late_s) >= next_s:
                self.off_schedule = True
                self._told_s = late_s
                word = "late" if late_s > 0.0 else "early"
                self.news.append(f"schedule: {end.value}, {word} by {abs(late_s):.0f} s")
