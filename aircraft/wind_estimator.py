"""The wind, from velocity over ground, airspeed and heading: an extended Kalman filter of four states.

States are the wind north and east, the factor from the airspeed as read to the true one (Cho, Kim, Lee, Kee,
*Wind estimation and airspeed calibration using a UAV with a single-antenna GPS and pitot tube*, 2011), and
the heading's slow error. With v the velocity over ground, w the wind, sideslip taken as none (as PX4's wind
estimator does), the two measurements are

    airspeed as read   |v - w| / factor
    heading as read    atan2(v_east - w_east, v_north - w_north) + heading error

On a straight leg the factor looks like wind along it and the heading's error like wind across; a turn tells
them apart. Gusts are in what is measured, and each lasts for many rounds: they are taken as noise, enlarged
for that.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from aircraft.estimator import Motion
from aircraft.sensors import Readings, SensorClass

_INTERVAL_S = 2.0
_WIND_UNKNOWN_MPS = 10.0
_SETTLING_S = 30.0  # at first, all that was learnt about the wind is kept uncertain
_SETTLING_MPS = 1.0  # per root second
_WIND_CHANGE_MPS = 0.2  # per root second; a storm flown through at 30 m/s
_GUST_MPS = 2.2
_GUST_S = 40.0  # so long a gust stands for one measurement: twice its length of 530 m at 27 m/s
_FACTOR_CHANGE = 1e-4  # per root second
_SMOOTHING_S = 2.0  # what is told changes gradually between two rounds
_TURN_RAD = 2.0 * math.pi


class Wind(NamedTuple):
    """Wind, toward, and the factor from the airspeed as read to the true airspeed."""

    north_mps: float
    east_mps: float
    airspeed_factor: float


class WindEstimator:
    """Follows one flight; call `update` at every round of guidance."""

    def __init__(self, figures: SensorClass) -> None:
        scale_rms = math.hypot(figures.airspeed_scale_rms, figures.airspeed_offset_rms_mps / 25.0)
        self.state = np.array([0.0, 0.0, 1.0, 0.0])
        self.covariance = np.diag(
            [_WIND_UNKNOWN_MPS**2, _WIND_UNKNOWN_MPS**2, scale_rms**2, figures.heading_rms_rad**2]
        )
        self._heading_rms_rad = figures.heading_rms_rad
        self._heading_decay = math.exp(-_INTERVAL_S / figures.heading_correlation_s)
        lasting = _GUST_S / _INTERVAL_S
        self._gust_variance = _GUST_MPS**2 * lasting
        self._noise = np.diag(
            [
                figures.airspeed_noise_mps**2 + self._gust_variance,
                figures.attitude_noise_rad**2,  # and the gusts' share, by airspeed
            ]
        )
        self._begin_s: float | None = None
        self._time_s = self._next_s = -math.inf
        self._told = Wind(0.0, 0.0, 1.0)

    def update(self, readings: Readings, motion: Motion) -> Wind:
        """The wind as far as it is known now."""
        if self._begin_s is None:
            self._begin_s = self._time_s = self._next_s = readings.time_s
        if readings.time_s >= self._next_s:
            self._next_s += _INTERVAL_S
            self._carry(readings.time_s - self._begin_s < _SETTLING_S)
            self._correct(readings, motion)
            north_mps, east_mps, self._factor, _ = self.state.tolist()
            self._aim = north_mps, east_mps
        share = 1.0 - math.exp((self._time_s - readings.time_s) / _SMOOTHING_S)
        self._time_s = readings.time_s
        told = self._told
        self._told = Wind(
            told.north_mps + share * (self._aim[0] - told.north_mps),
            told.east_mps + share * (self._aim[1] - told.east_mps),
            self._factor,
        )
        return self._told

    def _carry(self, settling: bool) -> None:
        """One interval on: the wind changes, the heading's error fades and comes anew."""
        wind = (_SETTLING_MPS if settling else _WIND_CHANGE_MPS) ** 2 * _INTERVAL_S
        decay = self._heading_decay
        self.state[3] *= decay
        self.covariance[3, :] *= decay
        self.covariance[:, 3] *= decay
        change = (wind, wind, _FACTOR_CHANGE**2 * _INTERVAL_S, self._heading_rms_rad**2 * (1.0 - decay**2))
        self.covariance[np.diag_indices(4)] += change

    def _correct(self, readings: Readings, motion: Motion) -> None:
        north_mps, east_mps = motion.north_mps - self.state[0], motion.east_mps - self.state[1]
        factor, level = self.state[2], max(math.hypot(north_mps, east_mps), 1.0)
        airspeed = math.hypot(level, motion.down_mps)
        course_rad = math.atan2(east_mps, north_mps)
        measured = np.array(
            [
                [-north_mps / airspeed / factor, -east_mps / airspeed / factor, -airspeed / factor**2, 0.0],
                [east_mps / level**2, -north_mps / level**2, 0.0, 1.0],
            ]
        )
        noise = self._noise.copy()
        noise[1, 1] += self._gust_variance / level**2
        difference_rad = readings.heading_rad - course_rad - self.state[3]
        innovation = (
            readings.airspeed_mps - airspeed / factor,
            math.remainder(difference_rad, _TURN_RAD),
        )
        across = self.covariance @ measured.T
        gain = across @ np.linalg.inv(measured @ across + noise)
        self.state += gain @ innovation
        kept = np.eye(4) - gain @ measured
        self.covariance = kept @ self.covariance @ kept.T + gain @ noise @ gain.T  # Joseph's form
