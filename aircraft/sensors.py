"""What the aircraft's sensors say of its true state: bias, slow drift, noise, rate and lag of a stated class.

The class is that of a small UAV's autopilot: a single-frequency GNSS receiver with SBAS corrections under
open sky, a MEMS attitude and heading reference, a pitot-static tube and a barometer. Each error is white
noise, a constant of the flight, or a first-order Gauss-Markov process (Rankin, *An error model for sensor
simulation: GPS and differential GPS*, 1994; Beard & McLain, *Small Unmanned Aircraft*, chapter 7):

    e[k + 1] = exp(-T / tau) e[k] + rms sqrt(1 - exp(-2 T / tau)) w[k],    w ~ N(0, 1)

Where the figures are from stands in docs/sensors.md.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from aircraft.state import FlightState

GRAVITY_MPS2 = 9.80665
_BLOCK = 4096  # a draw alone costs a microsecond, from a block a twentieth of it
_SLACK_S = 1e-6  # of times that should be whole multiples of the fix interval


@dataclass(frozen=True, slots=True)
class SensorClass:
    """Figures of one class of sensors, each one standard deviation of one axis.

    Slow errors (`_rms_`) are Gauss-Markov processes with the correlation time that follows them, or constant
    in a flight where there is none; noise is white, a new value at every reading.

    Attributes:
        fix_interval_s: from one fix of the GNSS receiver to the next.
        fix_latency_s: from the moment of a fix until it is known.
        position_rms_m: horizontal position of a fix.
        height_rms_m: its height.
        fix_correlation_s: of both.
        position_noise_m: horizontal position of a fix.
        height_noise_m: its height.
        velocity_noise_mps: its horizontal velocity.
        climb_noise_mps: its vertical velocity.
        tilt_rms_rad: roll and pitch; through gravity, it is also the slow error of the level accelerometers.
        tilt_correlation_s: of that, and of the vertical accelerometer's.
        heading_rms_rad: heading.
        heading_correlation_s: of that.
        attitude_noise_rad: roll, pitch and heading.
        velocity_walk_mps: what the accelerometers' noise adds up to in one second; grows as its root.
        accelerometer_rms_mps2: the vertical accelerometer.
        airspeed_scale_rms: factor of the airspeed, relative, constant.
        airspeed_offset_rms_mps: constant.
        airspeed_noise_mps: airspeed.
        airspeed_lag_s: time constant of the tube and its filter.
        barometer_offset_rms_m: when the flight begins.
        barometer_rate_rms_mps: speed at which that changes.
        barometer_correlation_s: of that speed.
        barometer_noise_m: barometric altitude.
    """

    fix_interval_s: float = 0.2
    fix_latency_s: float = 0.12
    position_rms_m: float = 0.342
    height_rms_m: float = 0.718
    fix_correlation_s: float = 300.0
    position_noise_m: float = 0.1
    height_noise_m: float = 0.15
    velocity_noise_mps: float = 0.05
    climb_noise_mps: float = 0.08
    tilt_rms_rad: float = math.radians(0.5)
    tilt_correlation_s: float = 60.0
    heading_rms_rad: float = math.radians(2.0)
    heading_correlation_s: float = 600.0
    attitude_noise_rad: float = math.radians(0.1)
    velocity_walk_mps: float = 0.02
    accelerometer_rms_mps2: float = 0.05
    airspeed_scale_rms: float = 0.02
    airspeed_offset_rms_mps: float = 0.3
    airspeed_noise_mps: float = 0.2
    airspeed_lag_s: float = 0.15
    barometer_offset_rms_m: float = 8.0
    barometer_rate_rms_mps: float = 0.006
    barometer_correlation_s: float = 3600.0
    barometer_noise_m: float = 0.3

    def read_at(self, rate_hz: float) -> SensorClass:
        """The class where fixes are taken at readings, and never closer than they are."""
        readings = math.ceil(self.fix_interval_s * rate_hz - _SLACK_S)
        return replace(self, fix_interval_s=readings / rate_hz)


class Fix(NamedTuple):
    """A fix of the GNSS receiver, WGS84, and the past moment it is of."""

    time_s: float
    lat_rad: float
    lon_rad: float
    altitude_m: float
    north_mps: float
    east_mps: float
    down_mps: float


class Readings(NamedTuple):
    """All that is known at one moment.

    `gained_*`: change of velocity since the last readings, from accelerometers, gravity taken out, turned to
    north-east-down by attitude and heading as measured. `fix`: one that has just become known, or None.
    """

    time_s: float
    gained_north_mps: float
    gained_east_mps: float
    gained_down_mps: float
    roll_rad: float
    pitch_rad: float
    heading_rad: float
    airspeed_mps: float
    barometer_m: float
    fix: Fix | None


class GaussMarkov:
    """A first-order Gauss-Markov process, begun in its stationary state."""

    def __init__(self, rms: float, correlation_s: float, normals: Iterator[float]) -> None:
        self._rms = rms
        self._correlation_s = correlation_s
        self._normals = normals
        self._step_s, self._decay, self._drive = math.nan, 1.0, 0.0
        self.value = rms * next(normals)

    def advance(self, step_s: float) -> float:
        """The value so much later."""
        if step_s != self._step_s:
            self._step_s, self._decay = step_s, math.exp(-step_s / self._correlation_s)
            self._drive = self._rms * math.sqrt(1.0 - self._decay * self._decay)
        self.value = self._decay * self.value + self._drive * next(self._normals)
        return self.value


class Sensors:
    """The sensors of one flight; the same seed gives the same errors."""

    def __init__(self, figures: SensorClass, seed: int) -> None:
        self.figures = figures
        self._normals = normals = _normals(seed)
        self._scale = 1.0 + figures.airspeed_scale_rms * next(normals)
        self._airspeed_offset_mps = figures.airspeed_offset_rms_mps * next(normals)
        self._barometer_offset_m = figures.barometer_offset_rms_m * next(normals)
        self._barometer_rate = GaussMarkov(
            figures.barometer_rate_rms_mps, figures.barometer_correlation_s, normals
        )
        self._north = GaussMarkov(figures.position_rms_m, figures.fix_correlation_s, normals)
        self._east = GaussMarkov(figures.position_rms_m, figures.fix_correlation_s, normals)
        self._height = GaussMarkov(figures.height_rms_m, figures.fix_correlation_s, normals)
        self._roll = GaussMarkov(figures.tilt_rms_rad, figures.tilt_correlation_s, normals)
        self._pitch = GaussMarkov(figures.tilt_rms_rad, figures.tilt_correlation_s, normals)
        self._heading = GaussMarkov(figures.heading_rms_rad, figures.heading_correlation_s, normals)
        self._down = GaussMarkov(figures.accelerometer_rms_mps2, figures.tilt_correlation_s, normals)
        self._last: FlightState | None = None
        self._next_fix_s = -math.inf
        self._fix_s: float | None = None
        self._on_the_way: deque[Fix] = deque()

    def read(self, truth: FlightState) -> Readings:
        """What the sensors say now; call it at every round of guidance."""
        figures, normals = self.figures, self._normals
        last = self._last or truth
        step_s = truth.time_s - last.time_s
        if self._last is None:
            self._airspeed_mps = truth.airspeed_mps
        self._last = truth
        roll = self._roll.advance(step_s)
        pitch = self._pitch.advance(step_s)
        heading = self._heading.advance(step_s)

        # attitude is what gravity is taken out with: a tilt is an acceleration, g times it
        ahead_mps, right_mps = -GRAVITY_MPS2 * pitch * step_s, GRAVITY_MPS2 * roll * step_s
        cosine, sine = math.cos(truth.heading_rad), math.sin(truth.heading_rad)
        noise_mps = figures.velocity_walk_mps * math.sqrt(step_s)
        north_mps, east_mps = truth.north_mps - last.north_mps, truth.east_mps - last.east_mps
        gained_north = north_mps - heading * east_mps + ahead_mps * cosine - right_mps * sine
        gained_east = east_mps + heading * north_mps + ahead_mps * sine + right_mps * cosine
        gained_down = truth.down_mps - last.down_mps + self._down.advance(step_s) * step_s

        share = 1.0 - math.exp(-step_s / figures.airspeed_lag_s)
        self._airspeed_mps += share * (truth.airspeed_mps - self._airspeed_mps)
        self._barometer_offset_m += self._barometer_rate.advance(step_s) * step_s
        noise_rad = figures.attitude_noise_rad
        return Readings(
            truth.time_s,
            gained_north + noise_mps * next(normals),
            gained_east + noise_mps * next(normals),
            gained_down + noise_mps * next(normals),
            truth.roll_rad + roll + noise_rad * next(normals),
            truth.pitch_rad + pitch + noise_rad * next(normals),
            truth.heading_rad + heading + noise_rad * next(normals),
            self._scale * self._airspeed_mps
            + self._airspeed_offset_mps
            + figures.airspeed_noise_mps * next(normals),
            truth.altitude_m + self._barometer_offset_m + figures.barometer_noise_m * next(normals),
            self._fix(truth),
        )

    def _fix(self, truth: FlightState) -> Fix | None:
        """Take a fix if it is time to, and hand over the one that has been on its way for long enough."""
        interval_s, time_s = self.figures.fix_interval_s, truth.time_s + _SLACK_S
        if time_s >= self._next_fix_s:
            self._on_the_way.append(self._take_fix(truth))
            self._next_fix_s = (math.floor(time_s / interval_s) + 1.0) * interval_s
        if self._on_the_way and self._on_the_way[0].time_s + self.figures.fix_latency_s <= time_s:
            return self._on_the_way.popleft()
        return None

    def _take_fix(self, truth: FlightState) -> Fix:
        figures, normals = self.figures, self._normals
        step_s = truth.time_s - self._fix_s if self._fix_s is not None else figures.fix_interval_s
        self._fix_s = truth.time_s
        position_m = figures.position_noise_m
        north_m = self._north.advance(step_s) + position_m * next(normals)
        east_m = self._east.advance(step_s) + position_m * next(normals)
        height_m = self._height.advance(step_s) + figures.height_noise_m * next(normals)
        north_radii_m, east_radii_m = radii_m(truth.lat_rad, truth.altitude_m)
        return Fix(
            truth.time_s,
            truth.lat_rad + north_m / north_radii_m,
            truth.lon_rad + east_m / east_radii_m,
            truth.altitude_m + height_m,
            truth.north_mps + figures.velocity_noise_mps * next(normals),
            truth.east_mps + figures.velocity_noise_mps * next(normals),
            truth.down_mps + figures.climb_noise_mps * next(normals),
        )


def radii_m(lat_rad: float, altitude_m: float) -> tuple[float, float]:
    """Metres per radian of latitude and per radian of longitude, WGS84 (Groves 2013, section 2.4)."""
    sine = math.sin(lat_rad)
    flat = 1.0 - 6.69437999014e-3 * sine * sine
    across_m = 6378137.0 / math.sqrt(flat)
    along_m = across_m * (1.0 - 6.69437999014e-3) / flat
    return along_m + altitude_m, (across_m + altitude_m) * math.cos(lat_rad)


def _normals(seed: int) -> Iterator[float]:
    """Standard normal numbers without end."""
    generator = np.random.default_rng((seed, 0x5E45))  # not the numbers of anything else with this seed
    while True:
        yield from generator.standard_normal(_BLOCK).tolist()
