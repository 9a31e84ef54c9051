"""Time of arrival: the airspeed that brings an aircraft along its reference on time.

The ground speed wanted is what the schedule asks a little ahead, and a share of the time error; the wind
triangle turns it into airspeed, within the envelope. Three things are added to that old rule (Beard & McLain,
*Small Unmanned Aircraft*, section 10; the wind triangle is theirs, too):

- What turbulence blows along is made good: the autopilot holds the airspeed that the aircraft feels; so the
  gust along, smoothed, is added to the command, and what is held is ground speed.
- A curve that a bank limit cannot hold is not entered: before it the ground speed is brought down in time,
  v^2 = v_curve^2 + 2 a d with the distance d to go.
- Time is caught up at no more than some airspeed below the highest, so that power is left for the height.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from enum import Enum

from aircraft.envelope import Envelope
from aircraft.path import GRAVITY_MPS2
from aircraft.reference import Reference, Target


class End(Enum):
    """The end of the allowed airspeeds that the schedule would go beyond."""

    NEITHER = "within the airspeeds"
    FASTEST = "at the fastest"
    SLOWEST = "at the slowest"


_NEITHER, _FASTEST, _SLOWEST = End  # by themselves: a member of an `Enum` takes as long as ten other names


@dataclass(frozen=True, slots=True)
class ScheduleGains:
    """How the schedule is kept.

    Attributes:
        preview_s: how far ahead the schedule's speed is taken.
        late_per_s: share of ground speed added per second late.
        early_max, late_max: bounds of that share, slower and faster.
        reserve_mps: time is caught up at no more than so much below the highest airspeed, ...
        hurry_mps: ... or so much above the scheduled one, if that is more.
        gust_filter_s: time constant in which the gust along is smoothed.
        gust_max_mps: bound of its effect.
        bank_share: how much of the tangent of the highest bank a curve may need.
        slowing_mps2: how fast the ground speed is brought down before a curve.
    """

    preview_s: float = 3.5
    late_per_s: float = 0.2
    early_max: float = 0.4
    late_max: float = 1.0
    reserve_mps: float = 5.0
    hurry_mps: float = 3.0
    gust_filter_s: float = 0.5
    gust_max_mps: float = 4.0
    bank_share: float = 0.85
    slowing_mps2: float = 0.5


class Schedule:
    """Keeps one flight to the times of its reference; call `airspeed_mps` at regular times."""

    def __init__(self, reference: Reference, envelope: Envelope, gains: ScheduleGains | None = None) -> None:
        self.envelope = envelope
        self.gains = gains or ScheduleGains()
        self.end = _NEITHER  # of the airspeeds allowed, at which the last one was
        self._fastest_mps = envelope.airspeed_max_mps
        self._gust_mps = 0.0
        self._tan_bank_max = math.tan(envelope.bank_max_rad)
        self.follow(reference)

    def follow(self, reference: Reference) -> None:
        """Keep to the times of this reference from now on."""
        self.reference = reference
        self._target = reference.target
        self._starts: list[float] = reference.start_m.tolist()
        self._limits = self._speed_limits()

    def airspeed_mps(
        self,
        path_m: float,
        here: Target,
        onward_mps: float,
        time_error_s: float,
        tan_bank: float,
        wind_north_mps: float,
        wind_east_mps: float,
    ) -> float:
        """The true airspeed to command, as the aircraft feels it.

        Args:
            path_m: where along the reference, plane metres.
            here: what the reference asks for there.
            onward_mps: plane metres along it a second.
            time_error_s: late positive.
            tan_bank: tangent of the bank that is commanded.
            wind_north_mps: steady wind, toward.
            wind_east_mps: steady wind, toward.
        """
        gains = self.gains
        ahead_m = path_m + gains.preview_s * onward_mps
        _, _, course_rad, curvature, speed_mps, _, _, straight_to_m = here
        if ahead_m >= straight_to_m:
            _, _, course_rad, curvature, speed_mps, _, _, _ = self._target(ahead_m)
        cosine, sine = math.cos(course_rad), math.sin(course_rad)
        limit_mps = self.speed_limit_mps(path_m)
        share, slower, faster = gains.late_per_s * time_error_s, -gains.early_max, gains.late_max
        hurried_mps = speed_mps * (1.0 + (slower if share < slower else faster if share > faster else share))
        if hurried_mps > limit_mps:
            hurried_mps = limit_mps
        wanted_mps = math.hypot(hurried_mps * cosine - wind_north_mps, hurried_mps * sine - wind_east_mps)
        lowest_mps, highest_mps = self._lowest_mps(tan_bank, speed_mps, curvature), self._fastest_mps
        most_mps = highest_mps
        if share > 0.0 and wanted_mps > highest_mps - gains.reserve_mps:
            if speed_mps > limit_mps:
                speed_mps = limit_mps
            planned_mps = math.hypot(speed_mps * cosine - wind_north_mps, speed_mps * sine - wind_east_mps)
            most_mps = max(highest_mps - gains.reserve_mps, planned_mps + gains.hurry_mps)
        if wanted_mps >= most_mps:
            self.end, wanted_mps = _FASTEST, most_mps
        else:
            self.end = _SLOWEST if wanted_mps <= lowest_mps else _NEITHER
        if wanted_mps >= highest_mps:  # in a strong wind no gust is a reason to yield
            return highest_mps
        wanted_mps += self._gust_mps
        if wanted_mps < lowest_mps:
            wanted_mps = lowest_mps
        return wanted_mps if wanted_mps < highest_mps else highest_mps

    def note_gust(self, felt_mps: float, steady_mps: float, step_s: float) -> None:
        """Smooth the gust along: the airspeed that is felt, less that through the steady wind alone."""
        gains = self.gains
        gust_mps, most = felt_mps - steady_mps, gains.gust_max_mps
        gust_mps = -most if gust_mps < -most else most if gust_mps > most else gust_mps
        self._gust_mps += step_s / (step_s + gains.gust_filter_s) * (gust_mps - self._gust_mps)

    def speed_limit_mps(self, path_m: float) -> float:
        """The highest ground speed from which every curve ahead can still be held."""
        i = bisect_right(self._starts, path_m) - 1
        turning_mps, next_squared, end_m, slope = self._limits[i if i > 0 else 0]
        if next_squared != math.inf:
            to_go_m = end_m - path_m
            slowed_mps = math.sqrt(next_squared + (slope * to_go_m if to_go_m > 0.0 else 0.0))
            if slowed_mps < turning_mps:
                return slowed_mps
        return turning_mps

    def _speed_limits(self) -> list[tuple[float, float, float, float]]:
        """For each segment its own limit, the squared limit at its end, its end, and the slope before."""
        reference, gains = self.reference, self.gains
        across_mps2 = gains.bank_share * GRAVITY_MPS2 * self._tan_bank_max
        columns = zip(
            self._starts,
            reference.length_m.tolist(),
            reference.curvature.tolist(),
            reference.scale.tolist(),
            strict=True,
        )
        limits = []
        next_squared = math.inf
        for start_m, length_m, curvature, scale in reversed(list(columns)):
            squared = across_mps2 / (abs(curvature) * scale) if curvature else math.inf
            slope = 2.0 * gains.slowing_mps2 / scale
            limits.append((math.sqrt(squared), next_squared, start_m + length_m, slope))
            next_squared = min(squared, next_squared + slope * length_m)
        return limits[::-1]

    def _lowest_mps(self, tan_bank: float, speed_mps: float, curvature: float) -> float:
        """The lowest airspeed that carries the aircraft in its turn and in the one ahead."""
        steepest = abs(speed_mps * speed_mps * curvature) / GRAVITY_MPS2
        if steepest > self._tan_bank_max:
            steepest = self._tan_bank_max
        if steepest < abs(tan_bank):
            steepest = abs(tan_bank)
        stall = math.sqrt(math.hypot(1.0, steepest))  # lift carries 1/cos(bank) weights
        lowest_mps = self.envelope.airspeed_min_mps * stall
        return lowest_mps if lowest_mps < self._fastest_mps else self._fastest_mps
