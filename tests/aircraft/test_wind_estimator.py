"""The wind that is estimated, in turns and on legs, with the sensors' errors and in gusts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aircraft.estimator import Estimator
from aircraft.sensors import SensorClass, Sensors
from aircraft.wind_estimator import WindEstimator

CLASS = SensorClass()
WINDS = [(0.0, 0.0), (12.0, -9.0), (-15.0, 3.0)]


def estimate(states, figures=CLASS, seed=1):
    """The estimator after a flight, and all that it told."""
    sensors, estimator, wind = Sensors(figures, seed), Estimator(CLASS), WindEstimator(figures)
    told = []
    for state in states:
        readings = sensors.read(state)
        motion = estimator.update(readings)
        if motion is not None:
            told.append(wind.update(readings, motion))
    return wind, told


def off_mps(told, wind):
    return math.hypot(told.north_mps - wind[0], told.east_mps - wind[1])


@pytest.mark.parametrize("wind", WINDS)
def test_a_minute_of_turning_is_enough(circling, wind):
    states = circling(60.0, wind=wind)
    for seed in range(8):
        _, told = estimate(states, seed=seed)
        assert off_mps(told[-1], wind) < 1.0


def test_a_straight_minute_is_not_where_airspeed_and_heading_are_wrong(circling):
    """Along the leg the airspeed's error is taken for wind, across it the heading's: turning helps."""
    wrong = replace(CLASS, airspeed_scale_rms=0.08, heading_rms_rad=math.radians(8.0))
    straight, turning = circling(60.0, turn_radps=0.0), circling(60.0)
    errors = [
        [off_mps(estimate(states, wrong, seed)[1][-1], (0.0, 0.0)) for seed in range(8)]
        for states in (straight, turning)
    ]
    assert np.mean(errors[0]) > 2.0 * np.mean(errors[1])


@pytest.mark.parametrize("seed", [2, 3])
def test_turns_find_the_airspeed_that_is_read_too_low_or_high(circling, seed):
    wrong = replace(CLASS, airspeed_scale_rms=0.05, airspeed_offset_rms_mps=0.0)
    wind = (10.0, 4.0)
    scale = Sensors(wrong, seed)._scale
    assert abs(scale - 1.0) > 0.01
    _, told = estimate(circling(1200.0, hz=5.0, wind=wind), wrong, seed)
    assert told[-1].airspeed_factor * scale == pytest.approx(1.0, abs=0.01)
    assert off_mps(told[-1], wind) < 0.7


def test_it_is_no_surer_than_it_should_be_in_gusts(circling):
    """Squared error over the variance that the filter gives: below one in gusts as rough as it allows for."""
    wind, normalised = np.array([6.0, -10.0]), []
    for seed in range(16):
        states = circling(150.0, hz=2.0, wind=tuple(wind), gust_rms_mps=2.2, seed=seed)
        filtered, _ = estimate(states, seed=seed)
        error = filtered.state[:2] - wind
        normalised.append(error @ np.linalg.solve(filtered.covariance[:2, :2], error) / 2.0)
        assert np.all(np.linalg.eigvalsh(filtered.covariance) > 0.0)
    assert 0.1 < np.mean(normalised) < 1.2


def test_it_follows_a_wind_that_changes(circling):
    calm, blown = circling(120.0, wind=(0.0, 0.0)), circling(240.0, wind=(10.0, 0.0))
    later = [state._replace(time_s=state.time_s + 120.1) for state in blown]
    # the position jumps, which the estimator of motion would not take: give it one flight of each
    motion = {id(state): belief for states in (calm, later) for state, belief in _motions(states)}
    sensors, wind = Sensors(CLASS, 1), WindEstimator(CLASS)
    told = [wind.update(sensors.read(state), motion[id(state)]) for state in [*calm[5:], *later[5:]]]
    assert off_mps(told[len(calm) - 6], (0.0, 0.0)) < 1.0
    assert off_mps(told[-1], (10.0, 0.0)) < 1.0


def _motions(states):
    sensors, estimator = Sensors(CLASS, 1), Estimator(CLASS)
    return [(state, estimator.update(sensors.read(state))) for state in states]


def test_what_is_told_has_no_steps(circling):
    _, told = estimate(circling(120.0, wind=(10.0, 5.0), gust_rms_mps=2.2))
    steps = np.abs(np.diff([(w.north_mps, w.east_mps) for w in told[600:]], axis=0))
    assert steps.max() < 0.1
