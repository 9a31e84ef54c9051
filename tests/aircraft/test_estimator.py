"""Position and velocity against the truth, and against what the filter says of its own error."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy import stats

from aircraft.estimator import Estimator, horizontal_gains, vertical_gains
from aircraft.sensors import SensorClass, Sensors, radii_m

CLASS = SensorClass()
SEEDS = 100
FAULTS = ("rms", "noise", "walk")
FAULTLESS = replace(
    CLASS, **{field.name: 0.0 for field in fields(CLASS) if any(word in field.name for word in FAULTS)}
)


def follow(states, figures=CLASS, seed=1, tuned=None):
    """What is believed at each state."""
    sensors, estimator = Sensors(figures, seed), Estimator(tuned or CLASS)
    return [estimator.update(sensors.read(state)) for state in states]


def off(truth, believed):
    """Error: north, east, up [m]; north, east, down [m/s]."""
    north_radii_m, east_radii_m = radii_m(truth.lat_rad, truth.altitude_m)
    return np.array(
        [
            (believed.lat_rad - truth.lat_rad) * north_radii_m,
            (believed.lon_rad - truth.lon_rad) * east_radii_m,
            believed.altitude_m - truth.altitude_m,
            believed.north_mps - truth.north_mps,
            believed.east_mps - truth.east_mps,
            believed.down_mps - truth.down_mps,
        ]
    )


def test_nothing_is_believed_before_the_first_fix(circling):
    states = circling(1.0)
    believed = follow(states)
    assert believed[0] is None
    assert [motion is None for motion in believed] == sorted(
        (motion is None for motion in believed), reverse=True
    )
    known_s = next(motion.time_s for motion in believed if motion)
    assert known_s - states[0].time_s == pytest.approx(0.2)


@pytest.mark.parametrize("hz", [1.0, 4.0, 10.0, 60.0])
def test_faultless_sensors_are_followed_exactly_through_turns_and_climbs(circling, hz):
    states = circling(60.0, hz=hz, wind=(8.0, -5.0), climb_mps=2.0)
    found = follow(states, FAULTLESS.read_at(hz), tuned=CLASS.read_at(hz))
    for truth, believed in list(zip(states, found, strict=True))[len(states) // 2 :]:
        assert off(truth, believed) == pytest.approx(np.zeros(6), abs=0.02)


def test_a_late_fix_is_no_place_behind(circling):
    """At 27 m/s a fix is more than three metres behind when it is known; the estimate must not be."""
    states = circling(20.0, hz=5.0, turn_radps=0.0)  # north
    behind_m = [off(states[-1], follow(states, seed=seed)[-1])[0] for seed in range(30)]
    spread_m = math.hypot(CLASS.position_rms_m, CLASS.position_noise_m)
    assert abs(np.mean(behind_m)) < 4.0 * spread_m / math.sqrt(30)


def test_errors_are_as_large_as_the_filter_says(circling):
    """Over many flights, errors squared over what is expected have a mean of one.

    Straight flights: in a steep turn the heading's error turns accelerations, which the filter does not know.
    """
    states = circling(30.0, hz=5.0, turn_radps=0.0, wind=(5.0, 5.0))
    errors = np.array([off(states[-1], follow(states, seed=seed)[-1]) for seed in range(SEEDS)])
    level, upright = horizontal_gains(CLASS).covariance, vertical_gains(CLASS).covariance
    expected = np.array(
        [
            CLASS.position_rms_m**2 + level[0, 0],
            CLASS.position_rms_m**2 + level[0, 0],
            CLASS.height_rms_m**2,  # as at the first fix: the barometer helps only in many minutes
            level[1, 1],
            level[1, 1],
            upright[1, 1],
        ]
    )
    normalised = np.mean(errors**2 / expected, axis=0)
    low, high = np.array(stats.chi2.interval(0.999, SEEDS)) / SEEDS
    assert np.all(normalised > low)
    assert np.all(
        normalised < 1.25 * high
    )  # what is believed is of now, what the filter says of the last fix
    assert np.all(np.abs(errors.mean(axis=0)) < 4.0 * np.sqrt(expected / SEEDS))


def test_the_barometer_helps_as_much_as_the_filter_says(circling):
    """With errors that are less slow, so that the filter settles in four minutes (its slowest mode: 83 s)."""
    quick = replace(CLASS, fix_correlation_s=5.0, barometer_rate_rms_mps=0.02, barometer_correlation_s=30.0)
    states = circling(250.0, hz=5.0, turn_radps=0.0)
    above_m = np.array([off(states[-1], follow(states, quick, seed, quick)[-1])[2] for seed in range(24)])
    variance = vertical_gains(quick).covariance[0, 0]
    assert variance < 0.3 * quick.height_rms_m**2
    low, high = np.array(stats.chi2.interval(0.999, 24)) / 24
    assert low < np.mean(above_m**2) / variance < high


def test_the_gains_are_those_that_a_filter_settles_at():
    for settled in (horizontal_gains(CLASS), vertical_gains(CLASS)):
        assert np.all(np.linalg.eigvalsh(settled.covariance) > 0.0)
        assert settled.gain[0, 0] > 0.0
        assert settled.gain[1, 1] > 0.0
        assert settled.covariance[1, 1] < CLASS.climb_noise_mps**2


def test_the_barometer_does_not_pull_the_altitude_away(circling):
    states = circling(300.0, hz=5.0)
    drifting = replace(FAULTLESS, barometer_offset_rms_m=30.0, barometer_rate_rms_mps=0.02)
    for seed in range(3):
        errors = [off(t, b)[2] for t, b in zip(states[50:], follow(states, drifting, seed)[50:], strict=True)]
        assert np.max(np.abs(errors)) < 0.5
