"""The spread of ensembles matches the error: the truth's rank among the members is as likely as any other.

A rank histogram (Hamill 2001, Monthly Weather Review 129, 550-560) over many seeds, one wind speed from each,
so that the ranks are independent and the chi-square test applies. What is compared is chosen by the forecast,
never by the truth, as a planner has only the forecast.
"""

import math

import numpy as np
import pytest
from scipy import stats

from planner.grid import Grid
from sim.weather.storm_forecasts import StormForecasts
from sim.weather.storms import HURRICANE_IAN

from .test_field_forecasts import GRID, HOUR_S, TIME_S, eddies, forecasts, spot_of

MEMBERS, SEEDS = 5, 110


def rank(truth_mps, members_mps):
    return int(np.sum(np.array(members_mps) < truth_mps))


def flat(ranks, members=MEMBERS):
    """The probability of a histogram at least as uneven, if all ranks are alike."""
    counts = np.bincount(ranks, minlength=members + 1)
    return stats.chisquare(counts).pvalue


@pytest.fixture(scope="module")
def storm_speeds():
    """For each seed, wind speeds 12 h ahead near where the forecast puts the storm: of truth and members."""
    return np.array([speeds_near_storm(seed) for seed in range(SEEDS)])


def speeds_near_storm(seed):
    fixes, rng = HURRICANE_IAN[5:8], np.random.default_rng([9, seed])
    time_s = np.array([fixes[0].time_s, fixes[2].time_s])
    assert time_s[1] - time_s[0] == 12 * HOUR_S
    north_m, east_m, _ = (
        float(part[1]) for part in StormForecasts(fixes, GRID, time_s, HOUR_S, seed).error(0, 0)
    )
    bearing, distance_m = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(20e3, 300e3)
    parallel_m = 6371008.8 * math.cos(fixes[2].lat_rad)
    lat_rad = fixes[2].lat_rad + (north_m + distance_m * math.cos(bearing)) / 6371008.8
    lon_rad = fixes[2].lon_rad + (east_m + distance_m * math.sin(bearing)) / parallel_m
    made = StormForecasts(fixes, Grid(lat_rad, lon_rad, 1e-4, 1e-4, 1, 1), time_s, HOUR_S, seed)
    fields = [made.truth(), *made.members(0, MEMBERS)]
    return [float(np.hypot(field.north_mps, field.east_mps)[1, 0, 0]) for field in fields]


def test_the_rank_histogram_of_storms_is_flat(storm_speeds):
    ranks = [rank(truth, members) for truth, *members in storm_speeds]
    assert flat(ranks) > 0.01


def test_the_histogram_is_not_flat_where_the_spread_is_half_or_twice_the_error(storm_speeds):
    """So the test can fail: the same members drawn towards their mean, or away from it."""
    truth, members = storm_speeds[:, 0], storm_speeds[:, 1:]
    middle = members.mean(axis=1, keepdims=True)
    for spread in (0.5, 2.0):
        wrong = middle + spread * (members - middle)
        assert flat([rank(t, m) for t, m in zip(truth, wrong, strict=True)]) < 1e-3


def test_the_rank_histogram_of_gridded_winds_is_flat():
    ranks = []
    for seed in range(SEEDS):
        truth = eddies(seed)
        spot = spot_of(*np.random.default_rng([10, seed]).integers(0, 17, 2))
        right = truth.at(TIME_S[4], spot.south_rad, spot.west_rad)
        members = [
            float(np.hypot(field.north_mps, field.east_mps)[4, 0, 0])
            for field in forecasts(seed, truth=truth, grid=spot).members(0, MEMBERS)
        ]
        ranks.append(rank(right.speed_mps, members))
    assert flat(ranks) > 0.01
