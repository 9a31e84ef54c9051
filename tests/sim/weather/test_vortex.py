"""The gridded, interpolated wind of Hurricane Ian, held against the published best track."""

import math
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pyproj
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.grid import Grid
from planner.windfield import WindField
from sim.errors import WeatherError
from sim.weather.best_track import (
    KNOT_MPS,
    QUADRANT_BEARINGS_RAD,
    RADIUS_SPEEDS_MPS,
    BestTrackFix,
)
from sim.weather.storms import HURRICANE_IAN, STORMS
from sim.weather.vortex import quadrant_profiles, vortex_field

GEOD = pyproj.Geod(ellps="WGS84")
AREA = Grid.covering(*map(math.radians, (22.5, 38.5, -91.5, -72.5)), rows=495, columns=517)  # cells of 3.6 km
INFLOW_RAD = math.radians(20.0)
FIXES = pytest.mark.parametrize(
    "fix", HURRICANE_IAN, ids=lambda fix: f"{datetime.fromtimestamp(fix.time_s, UTC):%d-%H%M}"
)
EVERY_FIX = pytest.mark.parametrize(
    "fix",
    [fix for fixes in STORMS.values() for fix in fixes],
    ids=lambda fix: f"{datetime.fromtimestamp(fix.time_s, UTC):%Y%m%d-%H%M}",
)
QUADRANTS = pytest.mark.parametrize("quadrant", range(4), ids=("NE", "SE", "SW", "NW"))


@pytest.fixture(scope="module")
def ian() -> WindField:
    """At the moments of the fixes."""
    return vortex_field(HURRICANE_IAN, AREA, [fix.time_s for fix in HURRICANE_IAN])


def away(fix: BestTrackFix, bearing_rad: float, distance_m: float) -> tuple[float, float]:
    """Latitude and longitude [rad] at a true bearing and distance from the centre."""
    lon_rad, lat_rad, _ = GEOD.fwd(fix.lon_rad, fix.lat_rad, bearing_rad, distance_m, radians=True)
    return lat_rad, lon_rad


def out_and_around(
    field: WindField, fix: BestTrackFix, bearing_rad: float, distance_m: float
) -> tuple[float, float]:
    """The wind's component away from the centre and the one counter-clockwise around it [m/s]."""
    lon_rad, lat_rad, back_rad = GEOD.fwd(fix.lon_rad, fix.lat_rad, bearing_rad, distance_m, radians=True)
    wind = field.at(fix.time_s, lat_rad, lon_rad)
    north, east = -math.cos(back_rad), -math.sin(back_rad)
    return (
        wind.north_mps * north + wind.east_mps * east,
        wind.north_mps * east - wind.east_mps * north,
    )


@FIXES
@QUADRANTS
def test_the_published_radii_have_the_published_winds(
    ian: WindField, fix: BestTrackFix, quadrant: int
) -> None:
    for speed_mps, radii_m in zip(RADIUS_SPEEDS_MPS, fix.radii_m, strict=True):
        if radii_m[quadrant]:
            place = away(fix, QUADRANT_BEARINGS_RAD[quadrant], radii_m[quadrant])
            assert ian.at(fix.time_s, *place).speed_mps == pytest.approx(speed_mps, rel=0.03)


@FIXES
@QUADRANTS
def test_a_quadrant_without_a_radius_stays_below_that_speed(
    ian: WindField, fix: BestTrackFix, quadrant: int
) -> None:
    missing = [v for v, radii_m in zip(RADIUS_SPEEDS_MPS, fix.radii_m, strict=True) if not radii_m[quadrant]]
    limit_mps = min([*missing, 1.01 * fix.max_wind_mps])
    along = [
        ian.at(fix.time_s, *away(fix, QUADRANT_BEARINGS_RAD[quadrant], distance_m)).speed_mps
        for distance_m in np.linspace(0.0, 200e3, 101)
    ]
    assert max(along) < limit_mps


@FIXES
def test_the_strongest_wind_is_the_published_one(ian: WindField, fix: BestTrackFix) -> None:
    sheet = HURRICANE_IAN.index(fix)
    speeds_mps = np.hypot(ian.north_mps[sheet], ian.east_mps[sheet])
    assert speeds_mps.max() == pytest.approx(fix.max_wind_mps, rel=0.03)
    row, column = np.unravel_index(int(speeds_mps.argmax()), speeds_mps.shape)
    distance_m = GEOD.inv(fix.lon_rad, fix.lat_rad, AREA.lon_rad[column], AREA.lat_rad[row], radians=True)[2]
    assert 0.5 * fix.max_wind_radius_m < distance_m < 1.3 * fix.max_wind_radius_m


@FIXES
def test_the_centre_is_calm(ian: WindField, fix: BestTrackFix) -> None:
    assert ian.at(fix.time_s, fix.lat_rad, fix.lon_rad).speed_mps < 0.5


@FIXES
@pytest.mark.parametrize("bearing_deg", [0, 45, 120, 200, 315])
def test_the_wind_turns_counter_clockwise_and_inward(
    ian: WindField, fix: BestTrackFix, bearing_deg: int
) -> None:
    bearing_rad = math.radians(bearing_deg)
    for radii, share in ((0.5, 0.2), (1.0, 0.4), (1.3, 1.0), (2.0, 1.0)):
        out_mps, around_mps = out_and_around(ian, fix, bearing_rad, radii * fix.max_wind_radius_m)
        assert around_mps > 0.0
        assert math.atan2(-out_mps, around_mps) == pytest.approx(share * INFLOW_RAD, abs=math.radians(2.5))


def test_no_inflow_gives_circles() -> None:
    fix = HURRICANE_IAN[3]
    field = vortex_field(HURRICANE_IAN, AREA, [fix.time_s], inflow_rad=0.0)
    out_mps, around_mps = out_and_around(field, fix, 1.0, 200e3)
    assert abs(out_mps) < 0.01 * around_mps


@FIXES
def test_there_is_no_seam_between_quadrants(ian: WindField, fix: BestTrackFix) -> None:
    bearings_rad = np.radians(np.arange(0.0, 360.0, 1.0))
    for distance_m in (60e3, 150e3, 250e3):
        north, east = np.transpose(
            [
                ian.at(fix.time_s, *away(fix, bearing_rad, distance_m))[:2]
                for bearing_rad in bearings_rad.tolist()
            ]
        )
        # A smooth wind that turns once around the centre changes by about its speed x 1 deg at every step.
        change = np.hypot(north - np.roll(north, 1), east - np.roll(east, 1))
        assert change.max() < 3.0 * math.radians(1.0) * np.hypot(north, east).max()


def test_the_wind_changes_gradually_in_time_across_fixes() -> None:
    coarse = Grid.covering(*map(math.radians, (22.5, 34.5, -91.5, -76.5)), rows=60, columns=75)
    begin_s, end_s = HURRICANE_IAN[0].time_s, HURRICANE_IAN[-1].time_s
    field = vortex_field(HURRICANE_IAN, coarse, np.arange(begin_s, end_s + 1.0, 60.0))
    # A storm that moves at 12 m/s with 66 m/s at 37 km: 1.8 m/s a km, so 1.3 m/s a minute at the very core.
    change = np.hypot(np.diff(field.north_mps, axis=0), np.diff(field.east_mps, axis=0))
    assert change.max() < 3.0
    assert np.quantile(change, 0.99) < 0.15


@given(hours=st.floats(0.0, 54.0))
def test_the_wind_is_finite_and_no_stronger_than_the_fixes_around(hours: float) -> None:
    moment_s = HURRICANE_IAN[0].time_s + 3600.0 * hours
    coarse = Grid.covering(*map(math.radians, (22.5, 36.5, -91.5, -72.5)), rows=57, columns=77)
    field = vortex_field(HURRICANE_IAN, coarse, [moment_s])  # refuses what is not finite
    after = next(i for i, fix in enumerate(HURRICANE_IAN) if fix.time_s >= moment_s)
    limit_mps = max(fix.max_wind_mps for fix in HURRICANE_IAN[max(after - 1, 0) : after + 1])
    speeds_mps = np.hypot(field.north_mps, field.east_mps)
    assert speeds_mps.max() <= 1.001 * limit_mps
    assert speeds_mps.min() < 0.5 * limit_mps


def test_between_fixes_the_centre_moves_evenly() -> None:
    before, after = HURRICANE_IAN[5], HURRICANE_IAN[6]
    moment_s = (before.time_s + after.time_s) / 2.0
    field = vortex_field(HURRICANE_IAN, AREA, [moment_s])
    lat_rad, lon_rad = (before.lat_rad + after.lat_rad) / 2.0, (before.lon_rad + after.lon_rad) / 2.0
    assert field.at(moment_s, lat_rad, lon_rad).speed_mps < 0.5
    assert field.at(moment_s, before.lat_rad, before.lon_rad).speed_mps > 10.0


@FIXES
def test_profiles_rise_to_one_peak_and_fall_no_slower_than_they_may(fix: BestTrackFix) -> None:
    for profile in quadrant_profiles(fix):
        assert (np.diff(profile.log_radius) > 0.0).all()
        slope = np.diff(profile.log_speed) / np.diff(profile.log_radius)
        assert slope[0] == pytest.approx(1.0)  # solid rotation in the core
        assert (slope[1:] <= 1e-12).all()
        assert slope[-1] == pytest.approx(-1.0)
        assert profile.log_radius[1] <= math.log(fix.max_wind_radius_m) + 1e-12


def test_profiles_blend_exactly_in_logarithms() -> None:
    one, other = quadrant_profiles(HURRICANE_IAN[3])[0], quadrant_profiles(HURRICANE_IAN[5])[0]
    radius_m = np.geomspace(100.0, 2e6, 500)
    expected = one.speed_mps(radius_m) ** 0.7 * other.speed_mps(radius_m) ** 0.3
    np.testing.assert_allclose(one.blended(other, 0.3).speed_mps(radius_m), expected, rtol=1e-12)


def test_a_storm_without_radii_stays_below_gale_force_but_for_its_published_maximum() -> None:
    weak = replace(HURRICANE_IAN[5], max_wind_mps=30.0 * KNOT_MPS, radii_m=((0.0,) * 4,) * 3)
    for profile in quadrant_profiles(weak, outer_exponent=-0.5):
        assert np.exp(profile.log_speed.max()) == pytest.approx(30.0 * KNOT_MPS)
        assert profile.speed_mps(4.0 * weak.max_wind_radius_m) == pytest.approx(15.0 * KNOT_MPS)  # r^-1/2


def test_the_outer_exponent_moves_only_the_wind_beyond_the_published_radii() -> None:
    fix = HURRICANE_IAN[4]
    near, far = (quadrant_profiles(fix, exponent) for exponent in (-1.0, -0.5))
    for quadrant in range(4):
        edge_m = fix.radii_m[0][quadrant]
        inside_m = np.linspace(1e3, edge_m, 50)
        np.testing.assert_allclose(near[quadrant].speed_mps(inside_m), far[quadrant].speed_mps(inside_m))
        assert near[quadrant].speed_mps(4.0 * edge_m) == pytest.approx(34.0 * KNOT_MPS / 4.0)
        assert far[quadrant].speed_mps(4.0 * edge_m) == pytest.approx(34.0 * KNOT_MPS / 2.0)


def test_flight_level_wind_is_the_surface_wind_times_the_ratio() -> None:
    time_s = [HURRICANE_IAN[3].time_s]
    surface, aloft = (
        vortex_field(HURRICANE_IAN, AREA, time_s, flight_level_ratio=ratio) for ratio in (1.0, 1.25)
    )
    np.testing.assert_allclose(aloft.north_mps, 1.25 * surface.north_mps, rtol=1e-5, atol=1e-5)


def test_fields_are_float32_without_heights(ian: WindField) -> None:
    assert ian.north_mps.dtype == ian.east_mps.dtype == np.float32
    assert ian.north_mps.shape == (len(HURRICANE_IAN), *AREA.shape)
    assert ian.height_m is None
    assert ian.down_mps is None


def test_times_and_fixes_that_do_not_fit_are_refused() -> None:
    begin_s = HURRICANE_IAN[0].time_s
    with pytest.raises(WeatherError, match="fixes are of 2022-09-28T18:00:00 to 2022-10-01T00:00:00 UTC"):
        vortex_field(HURRICANE_IAN, AREA, [begin_s - 1.0])
    with pytest.raises(WeatherError, match="wind of nothing to nothing"):
        vortex_field(HURRICANE_IAN, AREA, [begin_s, math.nan])
    with pytest.raises(WeatherError, match="two or more fixes"):
        vortex_field(HURRICANE_IAN[:1], AREA, [begin_s])
    with pytest.raises(WeatherError, match=r"below zero, not 0\.5"):
        vortex_field(HURRICANE_IAN, AREA, [begin_s], outer_exponent=0.5)
    with pytest.raises(WeatherError, match="rise in time"):
        vortex_field(HURRICANE_IAN[::-1], AREA, [begin_s])


@EVERY_FIX
def test_the_profiles_of_every_storm_meet_its_published_radii_and_maximum(fix: BestTrackFix) -> None:
    profiles = quadrant_profiles(fix)
    for quadrant, profile in enumerate(profiles):
        for speed_mps, radii_m in zip(RADIUS_SPEEDS_MPS, fix.radii_m, strict=True):
            if radii_m[quadrant]:
                assert profile.speed_mps(radii_m[quadrant]) == pytest.approx(speed_mps, rel=1e-9)
    strongest_mps = max(float(np.exp(profile.log_speed.max())) for profile in profiles)
    assert strongest_mps == pytest.approx(fix.max_wind_mps, rel=0.1)


@EVERY_FIX
def test_the_gridded_wind_of_every_storm_has_its_published_radii(fix: BestTrackFix) -> None:
    """On cells of 3.6 km around each place alone, read between the cells."""
    for quadrant, bearing_rad in enumerate(QUADRANT_BEARINGS_RAD):
        for speed_mps, radii_m in zip(RADIUS_SPEEDS_MPS, fix.radii_m, strict=True):
            if not radii_m[quadrant]:
                continue
            lat_rad, lon_rad = away(fix, bearing_rad, radii_m[quadrant])
            step = 3600.0 / 6371e3
            here = Grid(lat_rad - 0.6 * step, lon_rad - 0.6 * step, step, step, 2, 2)
            field = vortex_field(around(fix), here, [fix.time_s])
            assert field.at(fix.time_s, lat_rad, lon_rad).speed_mps == pytest.approx(speed_mps, rel=0.1)
    centre = Grid(fix.lat_rad, fix.lon_rad, 1e-4, 1e-4, 1, 1)
    calm = vortex_field(around(fix), centre, [fix.time_s])
    assert calm.at(fix.time_s, fix.lat_rad, fix.lon_rad).speed_mps < 0.05


def around(fix: BestTrackFix) -> tuple[BestTrackFix, ...]:
    """The fix and the one before or after it: all that its moment needs."""
    fixes = next(fixes for fixes in STORMS.values() if fix in fixes)
    first = min(fixes.index(fix), len(fixes) - 2)
    return fixes[first : first + 2]


STORM_AND_SHARE = {"storm": st.sampled_from(sorted(STORMS)), "share": st.floats(0.0, 1.0)}


@given(**STORM_AND_SHARE, distance_m=st.floats(2e3, 600e3), bearing_deg=st.floats(0.0, 360.0))
def test_no_storm_has_a_seam_between_quadrants_at_any_time(
    storm: str, share: float, distance_m: float, bearing_deg: float
) -> None:
    """Two places a tenth of a degree of bearing apart have nearly one wind, wherever they lie."""
    fixes = STORMS[storm]
    moment_s = fixes[0].time_s + share * (fixes[-1].time_s - fixes[0].time_s)
    lat_rad, lon_rad = (
        float(np.interp(moment_s, [fix.time_s for fix in fixes], [getattr(fix, name) for fix in fixes]))
        for name in ("lat_rad", "lon_rad")
    )
    winds = []
    for bearing_rad in np.radians((bearing_deg - 0.05, bearing_deg + 0.05)):
        lon, lat, _ = GEOD.fwd(lon_rad, lat_rad, bearing_rad, distance_m, radians=True)
        here = Grid(lat, lon, 1e-4, 1e-4, 1, 1)
        field = vortex_field(fixes, here, [moment_s])  # refuses what is not finite
        winds.append((float(field.north_mps[0, 0, 0]), float(field.east_mps[0, 0, 0])))
    change_mps = math.dist(*winds)
    assert change_mps < 4.0 * math.radians(0.1) * math.hypot(*winds[0]) + 1e-4


@given(**STORM_AND_SHARE)
def test_no_storm_jumps_in_time(storm: str, share: float) -> None:
    """Not at a fix either: within a minute wind changes by what a minute can move it."""
    fixes = STORMS[storm]
    moment_s = fixes[0].time_s + share * (fixes[-1].time_s - fixes[0].time_s - 60.0)
    nearest = min(fixes[1:-1], key=lambda fix: abs(fix.time_s - moment_s))
    for begin_s in (moment_s, nearest.time_s - 30.0):
        step = 0.012
        area = Grid(nearest.lat_rad - 7 * step, nearest.lon_rad - 7 * step, step, step, 15, 15)
        field = vortex_field(fixes, area, [begin_s, begin_s + 60.0])
        change_mps = np.hypot(np.diff(field.north_mps, axis=0), np.diff(field.east_mps, axis=0))
        assert change_mps.max() < 4.0
