"""Path following in wind: bank, airspeed, altitude and climb that keep an aircraft on its reference, on time.

Three published ideas, put together:

- The way back to the path is a field of wanted courses, steeper the farther off, at most `approach_max_rad`
  (the vector field of Nelson, Barber, McLain, Beard 2007 and of Beard & McLain, *Small Unmanned Aircraft*,
  chapter 10). Near the path it is a proportional-derivative law, like L1 (Park, Deyst, How 2004), and the
  curvature of the path is fed forward (Beard & McLain, section 10.2).
- It is followed by turning the velocity through the air, not that over ground (Stastny & Siegwart, *On flying
  backwards*, 2019): the wind triangle gives the air's course that has the wanted drift over ground, and where
  the wind leaves none, the nearest to it. So a wind as strong as the airspeed never turns the aircraft away:
  it faces the wind across the path at its highest airspeed, drifts by what that wind is faster, and closes in
  again when the wind has dropped. What has become of path and schedule is said by `aircraft.watch`.
- The time of arrival is held by ground speed, see `aircraft.schedule`. Where the aircraft is late and slower
  than that asks, since all power goes into sinking air, some metres of height are given for airspeed: eight
  metres are 3 m/s at 25 (v dv = g dh), and cost the schedule less than the crawl back up would.

With chi the course of the path, eta the angle from it to the velocity through the air (true airspeed V), w_t
and w_n the wind along and to the right of it, and v the ground speed along it:

    to close in at a speed e     sin(eta_wanted) = (e - w_n) / V                            [rad]
    turn rate through the air    omega = (v^2 kappa + (w_n / V) dV/dt) / (V cos(eta))
                                         + k_course (eta_wanted - eta)                     [rad/s]
    bank                         tan(bank) = V omega / g                                    [rad]

Kappa is taken a little ahead, so that the bank is there when the curve begins; the term with dV/dt keeps the
drift at rest while the airspeed changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from aircraft.envelope import Envelope
from aircraft.path import GRAVITY_MPS2
from aircraft.reference import Phase, Reference
from aircraft.schedule import End, Schedule
from aircraft.state import Command, FlightState
from aircraft.watch import Watch

_TURN_RAD = 2.0 * math.pi
_LATE_S = 1.0  # from here on height is given, all of it at twice that
_SHORT_FROM_MPS, _SHORT_TO_MPS = 2.0, 5.0  # of the airspeed asked for: from here on, all of it from there on
_GIVING_S = 1.0  # time constant of that height
_COSINE_MIN = 0.3  # beyond 72 degrees of crab the feed-forward is no longer worth its growth


@dataclass(frozen=True, slots=True)
class Gains:
    """How guidance is tuned.

    Attributes:
        cross_track_per_s: wanted speed back to the path, per distance off it.
        course_per_s: turn rate per error of course.
        roll_lead_s: how far ahead that error is predicted from the bank there is; it damps the roll's lag.
        integral_per_s2: of the cross-track error, for what bank does not hold exactly.
        integral_max_mps: bound of its effect, a speed across the path.
        approach_max_rad: steepest wanted course to the path, from the path's.
        crab_max_rad: largest angle between the path and the velocity through the air.
        bank_preview_s: how far ahead the curvature is taken.
        bank_blend_s: the flight time over which that is averaged, around there; the climb is its end's.
        acceleration_filter_s: time constant of the measured change of airspeed.
        height_for_time_m: given at most, below the reference, where it is late and power does not hold the
            airspeed that the schedule asks for.
    """

    cross_track_per_s: float = 0.6
    course_per_s: float = 2.5
    roll_lead_s: float = 0.15
    integral_per_s2: float = 0.02
    integral_max_mps: float = 1.0
    approach_max_rad: float = math.radians(60.0)
    crab_max_rad: float = math.radians(89.0)
    bank_preview_s: float = 0.45
    bank_blend_s: float = 0.4
    acceleration_filter_s: float = 0.3
    height_for_time_m: float = 4.5


class Progress(NamedTuple):
    """Where the aircraft is on its reference, as guidance sees it.

    `path_m`: distance along it, plane metres. `cross_track_m`: true metres, right positive.
    `altitude_error_m`: above positive. `time_error_s`: late positive. `phase`: of the reference there.
    """

    path_m: float
    cross_track_m: float
    altitude_error_m: float
    time_error_s: float
    phase: Phase


_Motion = tuple[float, float, float, float]
"""Velocity over ground along the path and to its right, then that of the wind [m/s]."""

_NEITHER = End.NEITHER  # by itself, since a member of a class of names takes as long as ten other names
_new_tuple = tuple.__new__  # makes a named tuple of a tuple in a third of the time of its constructor


class Guidance:
    """Follows one reference, once, and others from some place on; call `update` 5 to 20 times a second.

    `end_m`: where along its reference the last waypoint is passed; `end_s`: when that ends.

    `update` is half of what a flight costs beside JSBSim itself: in it, comparisons stand where `min` and
    `max` would, which take five times as long, and named tuples are taken apart at once, since each field
    asked for by its name takes as long as ten that are taken apart.
    """

    def __init__(self, reference: Reference, envelope: Envelope, gains: Gains | None = None) -> None:
        self.envelope = envelope
        self.gains = gains or Gains()
        self.schedule = Schedule(reference, envelope)
        self.watch = Watch(envelope)
        self._path_m: float | None = None
        self._take(reference)
        self._time_s = 0.0
        self._airspeed_mps = 0.0
        self._acceleration_mps2 = 0.0
        self._integral_mps = 0.0
        self._given_m = 0.0
        self._tan_bank_max = math.tan(envelope.bank_max_rad)
        self._crab_max = math.sin(self.gains.crab_max_rad)
        self._approach_max = math.sin(self.gains.approach_max_rad)

    def follow(self, reference: Reference, path_m: float) -> None:
        """Go over to another reference at a place where both agree in position and course.

        Args:
            reference: to follow from the next update on.
            path_m: where along it the aircraft is.
        """
        self._take(reference)
        self.schedule.follow(reference)
        self._path_m = path_m

    def _take(self, reference: Reference) -> None:
        self.reference, self.end_m = reference, float(reference.waypoint_path_m[-1])
        self.end_s = float(reference.end_time_s[-1])
        self._project, self._target = reference.project, reference.target

    def update(
        self,
        state: FlightState,
        north_m: float,
        east_m: float,
        scale: float,
        wind_north_mps: float,
        wind_east_mps: float,
    ) -> tuple[Command, Progress]:
        """What to fly until the next update.

        Args:
            state: its time, velocity over ground, altitude and bank are used.
            north_m: position in the reference's plane.
            east_m: position in the reference's plane.
            scale: plane metres per true metre there.
            wind_north_mps: wind, toward.
            wind_east_mps: wind, toward.
        """
        target, gains, near_m = self._target, self.gains, self._path_m
        time_s, _, _, height_m, north_mps, east_mps, down_mps, roll_rad = state[:8]
        felt_mps = state.airspeed_mps
        if near_m is None:
            near_m = self.reference.path_at_time(time_s)
            self._time_s = time_s
            self._airspeed_mps = math.hypot(north_mps - wind_north_mps, east_mps - wind_east_mps)
        step_s = time_s - self._time_s
        self._time_s = time_s

        path_m, cross_m = self._project(north_m, east_m, near_m)
        self._path_m = path_m
        here = target(path_m)
        altitude_m, here_s, course_rad, curvature, speed_mps, climb_mps, phase, straight_to_m = here
        cosine, sine = math.cos(course_rad), math.sin(course_rad)
        forward_mps = north_mps * cosine + east_mps * sine
        tail_mps = wind_north_mps * cosine + wind_east_mps * sine
        cross_wind_mps = wind_east_mps * cosine - wind_north_mps * sine
        motion = forward_mps, east_mps * cosine - north_mps * sine, tail_mps, cross_wind_mps
        onward = forward_mps * scale if forward_mps > 0.0 else 0.0  # plane metres a second
        time_error_s = time_s - here_s

        blend_m = gains.bank_blend_s * onward
        if blend_m < 0.1:
            blend_m = 0.1
        blend_to_m = path_m + gains.bank_preview_s * onward + 0.5 * blend_m
        curvature_ahead = 0.0
        if blend_to_m >= straight_to_m:
            _, _, soon_rad, _, speed_mps, climb_mps, _, _ = target(blend_to_m)
            turned_rad = math.remainder(soon_rad - target(blend_to_m - blend_m).course_rad, _TURN_RAD)
            curvature_ahead = turned_rad / blend_m * scale
        tan_bank = self._tan_bank(motion, cross_m, curvature, curvature_ahead, roll_rad, step_s)
        schedule, watch = self.schedule, self.watch
        schedule.note_gust(felt_mps, math.hypot(self._airspeed_mps, down_mps), step_s)
        airspeed_mps = schedule.airspeed_mps(
            path_m, here, onward, time_error_s, tan_bank, wind_north_mps, wind_east_mps
        )
        watch.note_path(cross_m, tail_mps, cross_wind_mps)
        if watch.off_schedule or schedule.end is not _NEITHER:
            watch.note_schedule(time_error_s, schedule.end)
        if time_error_s > _LATE_S or self._given_m > 0.0:
            self._give_height(time_error_s, airspeed_mps - felt_mps, step_s)
        wanted_m, wanted_mps = altitude_m - self._given_m, climb_mps * forward_mps / speed_mps
        return (
            _new_tuple(Command, (math.atan(tan_bank), airspeed_mps, wanted_m, wanted_mps)),
            _new_tuple(Progress, (path_m, cross_m, height_m - altitude_m, time_error_s, phase)),
        )

    def _tan_bank(
        self,
        motion: _Motion,
        cross_m: float,
        curvature: float,
        curvature_ahead: float,
        roll_rad: float,
        step_s: float,
    ) -> float:
        """Tangent of the bank that turns the velocity through the air to where it closes in on the path."""
        gains = self.gains
        forward_mps, right_mps, tail_mps, cross_wind_mps = motion
        air_forward_mps, air_right_mps = forward_mps - tail_mps, right_mps - cross_wind_mps
        airspeed_mps = math.hypot(air_forward_mps, air_right_mps)
        if airspeed_mps < 1.0:
            airspeed_mps = 1.0
        self._note_acceleration(airspeed_mps, step_s)
        crab_max = self._crab_max
        closing_mps = self._closing_speed(cross_m, math.hypot(forward_mps, right_mps), step_s)
        crab = (closing_mps - cross_wind_mps) / airspeed_mps
        crab = -crab_max if crab < -crab_max else crab_max if crab > crab_max else crab
        angle_rad = math.atan2(air_right_mps, air_forward_mps)

        # accelerations across the velocity through the air
        cosine, bend = math.cos(angle_rad), 1.0 - curvature * cross_m
        per_across = 1.0 / (cosine if cosine > _COSINE_MIN else _COSINE_MIN)
        curving = per_across * forward_mps * abs(forward_mps) / (bend if bend > 0.5 else 0.5)
        speeding = per_across * cross_wind_mps / airspeed_mps * self._acceleration_mps2
        excess = GRAVITY_MPS2 * math.tan(roll_rad) - curving * curvature - speeding
        error_rad = math.remainder(math.asin(crab) - angle_rad, _TURN_RAD)
        error_rad -= gains.roll_lead_s * excess / airspeed_mps
        wanted = curving * curvature_ahead + speeding + airspeed_mps * gains.course_per_s * error_rad
        tan_bank, steepest = wanted / GRAVITY_MPS2, self._tan_bank_max
        return -steepest if tan_bank < -steepest else steepest if tan_bank > steepest else tan_bank

    def _give_height(self, late_s: float, short_mps: float, step_s: float) -> None:
        """How much of the height is given for airspeed now."""
        late = min(max(late_s / _LATE_S - 1.0, 0.0), 1.0)
        short = min(max((short_mps - _SHORT_FROM_MPS) / (_SHORT_TO_MPS - _SHORT_FROM_MPS), 0.0), 1.0)
        wanted_m = self.gains.height_for_time_m * late * short
        self._given_m += step_s / (step_s + _GIVING_S) * (wanted_m - self._given_m)
        if self._given_m < 0.01:
            self._given_m = 0.0

    def _note_acceleration(self, airspeed_mps: float, step_s: float) -> None:
        """Smooth the change of airspeed (through the steady wind, so free of gusts themselves)."""
        if step_s > 0.0:
            measured = (airspeed_mps - self._airspeed_mps) / step_s
            weight = step_s / (step_s + self.gains.acceleration_filter_s)
            self._acceleration_mps2 += weight * (measured - self._acceleration_mps2)
        self._airspeed_mps = airspeed_mps

    def _closing_speed(self, cross_m: float, ground_speed_mps: float, step_s: float) -> float:
        """Wanted speed to the right, over ground, toward the path."""
        gains = self.gains
        limit_mps = self._approach_max * (ground_speed_mps if ground_speed_mps > 10.0 else 10.0)
        back_mps, most = -gains.cross_track_per_s * cross_m, gains.integral_max_mps
        if abs(back_mps) < most:  # far off, the integral would only wind up
            wound = self._integral_mps - gains.integral_per_s2 * cross_m * step_s
            self._integral_mps = -most if wound < -most else most if wound > most else wound
        closing_mps = back_mps + self._integral_mps
        return (
            -limit_mps if closing_mps < -limit_mps else limit_mps if closing_mps > limit_mps else closing_mps
        )
