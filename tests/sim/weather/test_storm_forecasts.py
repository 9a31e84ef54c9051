"""Forecasts of Ian that turn out wrong: as wrong as published, smooth, alike from issue to issue."""

import math
from itertools import pairwise

import numpy as np
import pytest

from planner.grid import Grid
from sim.weather.best_track import KNOT_MPS, NAUTICAL_MILE_M
from sim.weather.issues import error_rng
from sim.weather.storm_forecasts import WEAKEST_MPS, ErrorTrack, StormForecasts
from sim.weather.storms import HURRICANE_IAN
from sim.weather.vortex import Shift, vortex_field

HOUR_S = 3600.0
BEGIN_S = HURRICANE_IAN[3].time_s
TIME_S = BEGIN_S + HOUR_S * np.arange(0.0, 49.0)
GRID = Grid.covering(*map(math.radians, (24.0, 34.0, -88.0, -76.0)), rows=41, columns=49)
SEEDS = range(200)


@pytest.fixture(scope="module")
def tracks():
    """The errors of 200 seeds: a track of each."""
    return [ErrorTrack(BEGIN_S, TIME_S[-1], error_rng(seed, 0)) for seed in SEEDS]


def few(seed=1, scale=1.0):
    return StormForecasts(HURRICANE_IAN, GRID, TIME_S[:19:6], HOUR_S, seed, scale)


@pytest.mark.parametrize(("lead_h", "miles", "knots"), [(12, 25.0, 5.0), (24, 40.0, 7.5), (36, 55.0, 9.0)])
def test_mean_errors_are_the_published_ones(tracks, lead_h, miles, knots):
    errors = np.array([track.at(BEGIN_S, TIME_S) for track in tracks])[:, :, lead_h]
    distances_m = np.hypot(errors[:, 0], errors[:, 1])
    assert distances_m.mean() / NAUTICAL_MILE_M == pytest.approx(miles, rel=0.12)  # 3.3 standard errors
    assert np.abs(errors[:, 2]).mean() / KNOT_MPS == pytest.approx(knots, rel=0.18)
    for component in errors.T:  # without bias
        assert abs(component.mean()) < 3.3 * component.std() / math.sqrt(len(SEEDS))


def test_a_later_forecast_has_the_errors_of_its_own_lead(tracks):
    issue_s = BEGIN_S + 6 * HOUR_S
    errors = np.array([track.at(issue_s, TIME_S) for track in tracks])
    assert (errors[:, :, :7] == 0.0).all()  # what has been is known
    distances_m = np.hypot(errors[:, 0, 18], errors[:, 1, 18])
    assert distances_m.mean() / NAUTICAL_MILE_M == pytest.approx(25.0, rel=0.12)


def test_a_forecasts_track_is_smooth(tracks):
    for track in tracks:
        north_m, east_m, _ = track.at(BEGIN_S, TIME_S)
        velocity_mps = np.hypot(np.diff(north_m), np.diff(east_m)) / HOUR_S
        turn_mps = np.hypot(np.diff(north_m, 2), np.diff(east_m, 2)) / HOUR_S
        assert velocity_mps.max() < 12.0
        assert turn_mps.max() < 2.5  # by which the velocity changes in an hour; 20 if errors were independent


def test_successive_forecasts_resemble_each_other_and_distant_ones_do_not(tracks):
    def correlation(hours):
        pairs = [[track.at(BEGIN_S + k * HOUR_S, TIME_S)[0][48] for k in (0, hours)] for track in tracks]
        return np.corrcoef(np.transpose(pairs))[0, 1]

    assert correlation(1) > 0.98
    assert 0.75 < correlation(6) < 0.95
    assert abs(correlation(36)) < 0.25


def test_each_forecast_is_better_near_its_own_time(tracks):
    valid = 30
    means_m = [
        np.mean([math.hypot(*(part[valid] for part in track.at(issue_s, TIME_S)[:2])) for track in tracks])
        for issue_s in BEGIN_S + HOUR_S * np.array([0, 10, 20, 28])
    ]
    assert all(late < 0.85 * early for early, late in pairwise(means_m))


def test_the_forecast_is_the_storm_moved_and_strengthened():
    forecasts = few()
    off = ErrorTrack(BEGIN_S, forecasts.time_s[-1], error_rng(1, 0)).at(BEGIN_S, forecasts.time_s)
    fix_s = [fix.time_s for fix in HURRICANE_IAN]
    true_mps = np.interp(forecasts.time_s, fix_s, [fix.max_wind_mps for fix in HURRICANE_IAN])
    shifts = [Shift(n, e, (v + s) / v) for n, e, s, v in zip(*off, true_mps, strict=True)]
    expected = vortex_field(HURRICANE_IAN, GRID, forecasts.time_s, shifts=shifts)
    np.testing.assert_array_equal(forecasts.issued(0).north_mps, expected.north_mps)
    assert np.abs(forecasts.issued(0).north_mps - forecasts.truth().north_mps)[-1].max() > 3.0
    np.testing.assert_array_equal(forecasts.issued(0).north_mps[0], forecasts.truth().north_mps[0])


def test_a_shifted_storm_is_calm_at_its_own_centre_and_as_strong_as_it_is_told():
    fix = HURRICANE_IAN[3]
    fine = Grid.covering(*map(math.radians, (24.0, 31.0, -86.0, -77.0)), rows=261, columns=301)
    moved = vortex_field(HURRICANE_IAN, fine, [fix.time_s], shifts=[Shift(80e3, -120e3, 0.8)])
    lat_rad = fix.lat_rad + 80e3 / 6371008.8
    lon_rad = fix.lon_rad - 120e3 / (6371008.8 * math.cos(fix.lat_rad))
    assert moved.at(fix.time_s, lat_rad, lon_rad).speed_mps < 0.6
    speeds_mps = np.hypot(moved.north_mps, moved.east_mps)
    assert speeds_mps.max() == pytest.approx(0.8 * fix.max_wind_mps, rel=0.03)


def test_no_forecast_depends_on_what_was_asked_before():
    forward, backward = few(), few()
    there = [forward.issued(k).east_mps for k in (0, 3, 7)]
    back = [backward.issued(k).east_mps for k in (7, 3, 0)][::-1]
    np.testing.assert_array_equal(there, back)
    ensemble = forward.members(3, 4)
    last, first = ensemble[3], ensemble[0]
    np.testing.assert_array_equal(backward.members(3, 9)[0].east_mps, first.east_mps)
    np.testing.assert_array_equal(backward.members(3, 9)[3].east_mps, last.east_mps)
    assert np.abs(first.east_mps - last.east_mps).max() > 1.0
    assert np.abs(few(seed=2).issued(0).east_mps - there[0]).max() > 1.0


def test_an_ensemble_is_a_sequence():
    ensemble = few().members(0, 5)
    assert len(ensemble) == 5
    assert [member.east_mps.sum() for member in ensemble[1:4:2]] == [
        ensemble[1].east_mps.sum(),
        ensemble[3].east_mps.sum(),
    ]
    np.testing.assert_array_equal(ensemble[-1].east_mps, ensemble[4].east_mps)
    with pytest.raises(IndexError):
        ensemble[5]


def test_even_large_errors_leave_a_storm_with_wind():
    wide = Grid.covering(*map(math.radians, (0.0, 56.0, -110.0, -50.0)), rows=113, columns=121)
    for seed in range(6):
        field = StormForecasts(HURRICANE_IAN, wide, TIME_S[:19:9], HOUR_S, seed, scale=12.0).issued(0)
        strongest_mps = np.hypot(field.north_mps, field.east_mps).max(axis=(1, 2))
        assert (strongest_mps > 0.5 * WEAKEST_MPS).all()
