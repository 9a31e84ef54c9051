"""Each sensor against the figures of its class: spread, correlation, rate and lag."""

import math
from dataclasses import fields, replace

import numpy as np
import pyproj
import pytest
from scipy import stats

from aircraft.sensors import GaussMarkov, SensorClass, Sensors, radii_m

CLASS = SensorClass()
FAULTLESS = replace(
    CLASS,
    **{field.name: 0.0 for field in fields(CLASS) if any(w in field.name for w in ("rms", "noise", "walk"))},
)
GEOD = pyproj.Geod(ellps="WGS84")
SEEDS = range(400)


def assert_rms(values, rms):
    """The root mean square is the one stated, as far as so many values can tell (99.9 %)."""
    values = np.asarray(values)
    low, high = stats.chi2.interval(0.999, len(values)) / np.float64(len(values))
    assert low < np.mean(values**2) / rms**2 < high


def readings(states, figures=CLASS, seed=1):
    sensors = Sensors(figures, seed)
    return [sensors.read(state) for state in states]


def with_each_seed(states, value, figures=CLASS):
    """A value of the readings of a flight, for many seeds."""
    return np.array([value(readings(states, figures, seed)) for seed in SEEDS])


@pytest.mark.parametrize("correlation_s", [5.0, 60.0])
def test_a_slow_error_has_its_spread_and_correlation(correlation_s):
    normals = iter(np.random.default_rng(3).standard_normal(300_000).tolist())
    process = GaussMarkov(2.0, correlation_s, normals)
    step_s = correlation_s / 20.0
    values = np.array([process.advance(step_s) for _ in range(250_000)])
    apart = values[::100]  # five correlation times: independent
    assert stats.kstest(apart, stats.norm(scale=2.0).cdf).pvalue > 1e-3
    assert_rms(apart, 2.0)
    later = np.corrcoef(values[:-20], values[20:])[0, 1]
    assert later == pytest.approx(math.exp(-1.0), abs=0.03)


def test_a_slow_error_begins_with_its_whole_spread():
    numbers = np.random.default_rng(4).standard_normal(2000).tolist()
    assert_rms([GaussMarkov(2.0, 1e6, iter([number])).value for number in numbers], 2.0)


def test_metres_per_radian_are_those_of_the_ellipsoid():
    for lat_deg in (-60.0, 0.0, 26.0, 75.0):
        north, east = radii_m(math.radians(lat_deg), 0.0)
        step_deg = 1e-4
        north_m = GEOD.inv(0.0, lat_deg - step_deg / 2, 0.0, lat_deg + step_deg / 2)[2]
        east_m = GEOD.inv(0.0, lat_deg, step_deg, lat_deg)[2]
        assert (north, east) == pytest.approx(
            (north_m / math.radians(step_deg), east_m / math.radians(step_deg)), rel=1e-7
        )


def test_position_velocity_and_height_of_a_fix(circling):
    states = circling(0.2)
    truth = states[0]
    fixes = [readings(states, seed=seed)[-1].fix for seed in SEEDS]
    north_m, east_m = [], []
    for fix in fixes:
        bearing_deg, _, distance_m = GEOD.inv(
            *map(math.degrees, (truth.lon_rad, truth.lat_rad, fix.lon_rad, fix.lat_rad))
        )
        north_m.append(distance_m * math.cos(math.radians(bearing_deg)))
        east_m.append(distance_m * math.sin(math.radians(bearing_deg)))
    assert_rms(north_m, math.hypot(CLASS.position_rms_m, CLASS.position_noise_m))
    assert_rms(east_m, math.hypot(CLASS.position_rms_m, CLASS.position_noise_m))
    assert abs(np.corrcoef(north_m, east_m)[0, 1]) < 0.2
    height_m = [fix.altitude_m - truth.altitude_m for fix in fixes]
    assert_rms(height_m, math.hypot(CLASS.height_rms_m, CLASS.height_noise_m))
    assert_rms([fix.north_mps - truth.north_mps for fix in fixes], CLASS.velocity_noise_mps)
    assert_rms([fix.east_mps - truth.east_mps for fix in fixes], CLASS.velocity_noise_mps)
    assert_rms([fix.down_mps - truth.down_mps for fix in fixes], CLASS.climb_noise_mps)


def test_the_stated_95_per_cent_is_that_of_the_slow_errors():
    """Between FAA's best and worst site: radially 0.610 and 1.062 m, in height 1.026 and 1.790 m."""
    middle_m = stats.rayleigh(scale=CLASS.position_rms_m).ppf(0.95)
    assert middle_m == pytest.approx((0.610 + 1.062) / 2.0, abs=0.002)
    middle_m = stats.halfnorm(scale=CLASS.height_rms_m).ppf(0.95)
    assert middle_m == pytest.approx((1.026 + 1.790) / 2.0, abs=0.002)


@pytest.mark.parametrize(
    ("hz", "interval_s"), [(1.0, 1.0), (4.0, 0.25), (6.0, 1 / 3), (10.0, 0.2), (60.0, 0.2)]
)
def test_fixes_are_taken_at_readings_and_no_closer_than_they_are(circling, hz, interval_s):
    figures = FAULTLESS.read_at(hz)
    assert figures.fix_interval_s == pytest.approx(interval_s)
    taken_s = [reading.fix.time_s for reading in readings(circling(6.0, hz=hz), figures) if reading.fix]
    assert np.diff(taken_s) == pytest.approx(interval_s)


@pytest.mark.parametrize("hz", [4.0, 10.0, 30.0, 60.0])
def test_fixes_come_at_their_rate_and_after_their_latency(circling, hz):
    states = circling(5.0, hz=hz)
    found = [(reading.time_s, reading.fix) for reading in readings(states, FAULTLESS) if reading.fix]
    late_s = [time_s - fix.time_s for time_s, fix in found]
    assert min(late_s) >= CLASS.fix_latency_s - 1e-6
    assert max(late_s) <= CLASS.fix_latency_s + 1.0 / hz + 1e-6
    apart_s = np.diff([fix.time_s for _, fix in found])
    assert apart_s == pytest.approx(max(CLASS.fix_interval_s, 1.0 / hz))
    by_time = {round(state.time_s, 6): state for state in states}
    for _, fix in found:
        truth = by_time[round(fix.time_s, 6)]
        assert fix.lat_rad == truth.lat_rad
        assert fix.north_mps == truth.north_mps


def test_attitude_and_heading(circling):
    states = circling(0.1)
    truth, noise = states[-1], CLASS.attitude_noise_rad
    for name, rms in (
        ("roll_rad", CLASS.tilt_rms_rad),
        ("pitch_rad", CLASS.tilt_rms_rad),
        ("heading_rad", CLASS.heading_rms_rad),
    ):
        errors = with_each_seed(
            states, lambda found, name=name: getattr(found[-1], name) - getattr(truth, name)
        )
        assert_rms(errors, math.hypot(rms, noise))


def test_airspeed_has_scale_offset_and_noise(circling):
    states = circling(0.1, turn_radps=0.0)
    errors = with_each_seed(states, lambda found: found[-1].airspeed_mps - states[-1].airspeed_mps)
    scale_mps = CLASS.airspeed_scale_rms * states[-1].airspeed_mps
    assert_rms(errors, math.hypot(scale_mps, CLASS.airspeed_offset_rms_mps, CLASS.airspeed_noise_mps))


def test_airspeed_lags(circling):
    states = [
        state._replace(airspeed_mps=20.0 if state.time_s < -59.0 else 30.0)
        for state in circling(3.0, hz=100.0, turn_radps=0.0)
    ]
    found = readings(states, FAULTLESS)
    there_s = next(reading.time_s for reading in found if reading.airspeed_mps >= 30.0 - 10.0 / math.e)
    assert there_s + 59.0 == pytest.approx(CLASS.airspeed_lag_s, abs=0.011)
    assert found[-1].airspeed_mps == pytest.approx(30.0, abs=0.01)


def test_the_barometer_is_off_and_drifts(circling):
    states = circling(100.0, hz=1.0)
    runs = [readings(states, seed=seed) for seed in range(200)]
    off_m = np.array([[reading.barometer_m for reading in run] for run in runs]) - states[0].altitude_m
    assert_rms(off_m[:, 0], math.hypot(CLASS.barometer_offset_rms_m, CLASS.barometer_noise_m))
    drift_m = 100.0 * CLASS.barometer_rate_rms_mps
    assert_rms(off_m[:, -1] - off_m[:, 0], math.hypot(drift_m, math.sqrt(2.0) * CLASS.barometer_noise_m))


def test_what_accelerometers_gain_is_the_change_of_velocity(circling):
    states = circling(20.0, climb_mps=1.0)
    found = readings(states, FAULTLESS)
    for axis in ("north", "east", "down"):
        gained_mps = sum(getattr(reading, f"gained_{axis}_mps") for reading in found)
        change_mps = getattr(states[-1], f"{axis}_mps") - getattr(states[0], f"{axis}_mps")
        assert gained_mps == pytest.approx(change_mps, abs=1e-9)


def test_a_tilt_is_taken_for_an_acceleration(circling):
    """Rolled right more than it is: lift seems to pull to the right. Pitched up more: to pull back."""
    states = circling(1.0, turn_radps=0.0, wind=(3.0, 0.0))  # heading north
    tilted = replace(FAULTLESS, tilt_rms_rad=0.01, tilt_correlation_s=1e9)
    found = readings(states, tilted)
    roll_rad, pitch_rad = found[-1].roll_rad - states[-1].roll_rad, found[-1].pitch_rad - states[-1].pitch_rad
    assert roll_rad != pitch_rad
    assert sum(reading.gained_east_mps for reading in found) == pytest.approx(9.80665 * roll_rad, rel=1e-3)
    assert sum(reading.gained_north_mps for reading in found) == pytest.approx(-9.80665 * pitch_rad, rel=1e-3)


def test_noise_of_the_accelerometers_adds_up_like_a_walk(circling):
    states = circling(4.0, turn_radps=0.0)
    walking = replace(FAULTLESS, velocity_walk_mps=CLASS.velocity_walk_mps)
    gained = with_each_seed(states, lambda found: sum(reading.gained_down_mps for reading in found), walking)
    assert_rms(gained, CLASS.velocity_walk_mps * math.sqrt(4.0))


def test_faultless_sensors_tell_the_truth(circling):
    states = circling(2.0, turn_radps=0.0, climb_mps=1.0)
    for truth, told in zip(states, readings(states, FAULTLESS), strict=True):
        assert (told.roll_rad, told.pitch_rad, told.heading_rad) == (
            truth.roll_rad,
            truth.pitch_rad,
            truth.heading_rad,
        )
        assert told.airspeed_mps == pytest.approx(truth.airspeed_mps)
        assert told.barometer_m == truth.altitude_m


def test_the_seed_decides_the_errors(circling):
    states = circling(10.0)
    assert readings(states, seed=5) == readings(states, seed=5)
    assert readings(states, seed=5) != readings(states, seed=6)
