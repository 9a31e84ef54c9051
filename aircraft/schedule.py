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

from aircraft.envelope import Envelope
from aircraft.path import GRAVITY_MPS2
from aircraft.reference import Reference, ReferencePoint


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
        self.reference = reference
        self.envelope = envelope
        self.gains = gains or ScheduleGains()
        self.at_fastest = self.at_slowest = False  # whether the airspeed was at an end of what is allowed
        self._gust_mps = 0.0
        self._tan_bank_max = math.tan(envelope.bank_max_rad)
        self._starts: list[float] = reference.start_m.tolist()
        self._limits = self._speed_limits()

    def airspeed_mps(
        self,
        path_m: float,
        onward_mps: float,
        time_error_s: float,
        tan_bank: float,
        wind_north_mps: float,
        wind_east_mps: float,
    ) -> float:
        """The true airspeed to command, as the aircraft feels it.

        Args:
            path_m: where along the reference, plane metres.
            onward_mps: plane metres along it a second.
            time_error_s: late positive.
            tan_bank: tangent of the bank that is commanded.
            wind_north_mps: steady wind, toward.
            wind_east_mps: steady wind, toward.
        """
        gains, envelope = self.gains, self.envelope
        ahead = self.reference.at(path_m + gains.preview_s * onward_mps)
        cosine, sine = math.cos(ahead.course_rad), math.sin(ahead.course_rad)

        def airspeed_for(speed_mps: float) -> float:
            return math.hypot(speed_mps * cosine - wind_north_mps, speed_mps * sine - wind_east_mps)

        limit_mps = self.speed_limit_mps(path_m)
        scheduled_mps = airspeed_for(min(ahead.speed_mps, limit_mps))
        share = min(max(gains.late_per_s * time_error_s, -gains.early_max), gains.late_max)
        wanted_mps = airspeed_for(min(ahead.speed_mps * (1.0 + share), limit_mps))
        highest_mps = envelope.airspeed_max_mps
        if share > 0.0:
            catching_up_mps = max(highest_mps - gains.reserve_mps, scheduled_mps + gains.hurry_mps)
            highest_mps = min(catching_up_mps, highest_mps)
        lowest_mps = self._lowest_mps(tan_bank, ahead)
        self.at_fastest, self.at_slowest = wanted_mps >= highest_mps, wanted_mps <= lowest_mps
        wanted_mps = min(wanted_mps, highest_mps)
        if wanted_mps >= envelope.airspeed_max_mps:  # in a strong wind no gust is a reason to yield
            return envelope.airspeed_max_mps
        return min(max(wanted_mps + self._gust_mps, lowest_mps), envelope.airspeed_max_mps)

    def note_gust(self, felt_mps: float, steady_mps: float, step_s: float) -> None:
        """Smooth the gust along: the airspeed that is felt, less that through the steady wind alone."""
        gains = self.gains
        gust_mps = min(max(felt_mps - steady_mps, -gains.gust_max_mps), gains.gust_max_mps)
        self._gust_mps += step_s / (step_s + gains.gust_filter_s) * (gust_mps - self._gust_mps)

    def speed_limit_mps(self, path_m: float) -> float:
        """The highest ground speed from which every curve ahead can still be held."""
        i = max(0, bisect_right(self._starts, path_m) - 1)
        turning_mps, next_squared, end_m, scale = self._limits[i]
        to_go_m = max(end_m - path_m, 0.0) / scale
        return min(turning_mps, math.sqrt(next_squared + 2.0 * self.gains.slowing_mps2 * to_go_m))

    def _speed_limits(self) -> list[tuple[float, float, float, float]]:
        """For each segment its own limit, the squared limit at its end, its end and its scale."""
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
            limits.append((math.sqrt(squared), next_squared, start_m + length_m, scale))
            next_squared = min(squared, next_squared + 2.0 * gains.slowing_mps2 * length_m / scale)
        return limits[::-1]

    def _lowest_mps(self, tan_bank: float, ahead: ReferencePoint) -> float:
        """The lowest airspeed that carries the aircraft in its turn and in the one ahead."""
        tan_ahead = ahead.speed_mps * ahead.speed_mps * ahead.curvature_radpm / GRAVITY_MPS2
        steepest = max(abs(tan_bank), min(abs(tan_ahead), self._tan_bank_max))
        stall = math.sqrt(math.hypot(1.0, steepest))  # lift carries 1/cos(bank) weights
        return min(self.envelope.airspeed_min_mps * stall, self.envelope.airspeed_max_mps)
