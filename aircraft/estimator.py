"""Position, altitude and velocity from the sensors: accelerometers carried forward, corrected by each fix.

One Kalman filter an axis, with constant gains: those that it would settle at (the discrete algebraic
Riccati equation; Gelb, *Applied Optimal Estimation*, 1974, chapter 4). Horizontal axes have position,
velocity and the accelerometer's slow error as states: the slow error of the fixes passes through, since
nothing on board could tell it from a movement. In the vertical there is a barometer, which drifts even
more slowly: the heights of fixes are averaged against it. So the states there are also the barometer's
offset, the rate of that, and the slow error of a fix's height.

A fix is of the past: it is compared with what was believed then, and the difference is added to what is
believed now. That is right as long as a fix is known before the next one is taken.
"""

from __future__ import annotations

import math
from collections import deque
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_discrete_are

from aircraft.sensors import GRAVITY_MPS2, Fix, Readings, SensorClass, radii_m

Floats = NDArray[np.float64]
_SLACK_S = 1e-6


class Motion(NamedTuple):
    """What is believed at one moment. `barometer_m`: the reading there was."""

    time_s: float
    lat_rad: float
    lon_rad: float
    altitude_m: float
    north_mps: float
    east_mps: float
    down_mps: float
    barometer_m: float


class SteadyGains(NamedTuple):
    """The settled Kalman filter of one axis.

    `gain`: [state, measurement]; states are position, velocity and accelerometer error (vertically also the
    barometer's offset, its rate, and the slow error of a fix), measurements the position and the velocity of
    a fix (and the barometer). `covariance`: [state, state], after a fix. `decay`: of slow errors to the next
    one: the accelerometer's (and the barometer's rate, and the fix's).
    """

    gain: Floats
    covariance: Floats
    decay: tuple[float, ...]


class Estimator:
    """Follows one flight; call `update` with every reading, in order."""

    def __init__(self, figures: SensorClass) -> None:
        self.horizontal = horizontal_gains(figures)
        self.vertical = vertical_gains(figures)
        self._believed: deque[Motion] = deque()
        self._north_mps2 = self._east_mps2 = self._down_mps2 = 0.0
        self._barometer_offset_m = self._barometer_rate_mps = self._fix_down_m = 0.0
        self._fix_s = 0.0
        self._now: Motion | None = None

    def update(self, readings: Readings) -> Motion | None:
        """What is believed now; None until the first fix is known."""
        if self._now is None:
            if readings.fix is None:
                return None
            self._now = self._begin(readings, readings.fix)
        else:
            self._now = self._carried(self._now, readings)
            if readings.fix is not None:
                self._now = self._corrected(self._now, readings.fix)
        self._believed.append(self._now)
        return self._now

    def _begin(self, readings: Readings, fix: Fix) -> Motion:
        """The first fix, carried to now at the velocity it has."""
        age_s = readings.time_s - fix.time_s
        north_radii_m, east_radii_m = radii_m(fix.lat_rad, fix.altitude_m)
        altitude_m = fix.altitude_m - fix.down_mps * age_s
        self._barometer_offset_m = readings.barometer_m - altitude_m
        self._fix_s = fix.time_s
        return Motion(
            readings.time_s,
            fix.lat_rad + fix.north_mps * age_s / north_radii_m,
            fix.lon_rad + fix.east_mps * age_s / east_radii_m,
            altitude_m,
            fix.north_mps,
            fix.east_mps,
            fix.down_mps,
            readings.barometer_m,
        )

    def _carried(self, before: Motion, readings: Readings) -> Motion:
        """From the last readings to these by what the accelerometers gained, less their error."""
        step_s = readings.time_s - before.time_s
        north_mps = readings.gained_north_mps - self._north_mps2 * step_s
        east_mps = readings.gained_east_mps - self._east_mps2 * step_s
        down_mps = readings.gained_down_mps - self._down_mps2 * step_s
        north_radii_m, east_radii_m = radii_m(before.lat_rad, before.altitude_m)
        return Motion(
            readings.time_s,
            before.lat_rad + (before.north_mps + 0.5 * north_mps) * step_s / north_radii_m,
            before.lon_rad + (before.east_mps + 0.5 * east_mps) * step_s / east_radii_m,
            before.altitude_m - (before.down_mps + 0.5 * down_mps) * step_s,
            before.north_mps + north_mps,
            before.east_mps + east_mps,
            before.down_mps + down_mps,
            readings.barometer_m,
        )

    def _corrected(self, now: Motion, fix: Fix) -> Motion:
        then = self._believed_at(fix.time_s)
        self._fade(fix.time_s)
        north_radii_m, east_radii_m = radii_m(now.lat_rad, now.altitude_m)
        off_level = (
            ((fix.lat_rad - then.lat_rad) * north_radii_m, (fix.lon_rad - then.lon_rad) * east_radii_m),
            (fix.north_mps - then.north_mps, fix.east_mps - then.east_mps),
        )
        barometer_m = then.barometer_m - self._barometer_offset_m
        off_down = (
            then.altitude_m - fix.altitude_m - self._fix_down_m,
            fix.down_mps - then.down_mps,
            then.altitude_m - barometer_m,
        )
        (north_m, east_m), (north_mps, east_mps), (north_mps2, east_mps2) = (
            self.horizontal.gain @ off_level
        ).tolist()
        down_m, down_mps, down_mps2, offset_m, rate_mps, fix_m = (self.vertical.gain @ off_down).tolist()
        self._north_mps2 += north_mps2
        self._east_mps2 += east_mps2
        self._down_mps2 += down_mps2
        self._barometer_offset_m -= offset_m
        self._barometer_rate_mps -= rate_mps
        self._fix_down_m += fix_m
        return Motion(
            now.time_s,
            now.lat_rad + north_m / north_radii_m,
            now.lon_rad + east_m / east_radii_m,
            now.altitude_m - down_m,
            now.north_mps + north_mps,
            now.east_mps + east_mps,
            now.down_mps + down_mps,
            now.barometer_m,
        )

    def _fade(self, time_s: float) -> None:
        """Slow errors from the last fix to this one."""
        level, (upright, rate, fix) = self.horizontal.decay[0], self.vertical.decay
        self._barometer_offset_m += self._barometer_rate_mps * (time_s - self._fix_s)
        self._fix_s = time_s
        self._north_mps2 *= level
        self._east_mps2 *= level
        self._down_mps2 *= upright
        self._barometer_rate_mps *= rate
        self._fix_down_m *= fix

    def _believed_at(self, time_s: float) -> Motion:
        """What was believed when a fix was taken; what is older is forgotten."""
        believed = self._believed
        while len(believed) > 1 and believed[0].time_s < time_s - _SLACK_S:
            believed.popleft()
        return believed[0]


@cache
def horizontal_gains(figures: SensorClass) -> SteadyGains:
    """Of the north and of the east axis; the accelerometers' slow error is gravity's, through the tilt."""
    transition, drive = _kinematics(figures, GRAVITY_MPS2 * figures.tilt_rms_rad)
    measured = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    return _settled(transition, drive, measured, (figures.position_noise_m, figures.velocity_noise_mps))


@cache
def vertical_gains(figures: SensorClass) -> SteadyGains:
    """Of the vertical axis, all down; the barometer's offset is what it reads too little."""
    transition, drive = np.eye(6), np.zeros((6, 6))
    transition[:3, :3], drive[:3, :3] = _kinematics(figures, figures.accelerometer_rms_mps2)
    transition[3, 4] = figures.fix_interval_s
    for state, rms, correlation_s in (
        (4, figures.barometer_rate_rms_mps, figures.barometer_correlation_s),
        (5, figures.height_rms_m, figures.fix_correlation_s),
    ):
        transition[state, state] = math.exp(-figures.fix_interval_s / correlation_s)
        drive[state, state] = rms**2 * (1.0 - transition[state, state] ** 2)
    measured = np.zeros((3, 6))
    measured[0, [0, 5]] = measured[1, 1] = measured[2, [0, 3]] = 1.0
    noise_rms = (figures.height_noise_m, figures.climb_noise_mps, figures.barometer_noise_m)
    return _settled(transition, drive, measured, noise_rms)


def _kinematics(figures: SensorClass, slow_mps2: float) -> tuple[Floats, Floats]:
    """Transition and process noise of position, velocity and accelerometer error, from fix to fix."""
    step_s, walk = figures.fix_interval_s, figures.velocity_walk_mps**2
    decay = math.exp(-step_s / figures.tilt_correlation_s)
    transition = np.array([[1.0, step_s, -0.5 * step_s**2], [0.0, 1.0, -step_s], [0.0, 0.0, decay]])
    drive = np.zeros((3, 3))
    drive[:2, :2] = walk * np.array([[step_s**3 / 3.0, step_s**2 / 2.0], [step_s**2 / 2.0, step_s]])
    drive[2, 2] = slow_mps2**2 * (1.0 - decay**2)
    return transition, drive


def _settled(
    transition: Floats, drive: Floats, measured: Floats, noise_rms: tuple[float, ...]
) -> SteadyGains:
    noise = np.diag(np.square(noise_rms))
    before = solve_discrete_are(transition.T, measured.T, drive, noise)
    gain = before @ measured.T @ np.linalg.inv(measured @ before @ measured.T + noise)
    covariance = (np.eye(len(before)) - gain @ measured) @ before
    fading = [value for value in np.diagonal(transition).tolist() if value < 1.0]
    return SteadyGains(gain, 0.5 * (covariance + covariance.T), tuple(fading))
