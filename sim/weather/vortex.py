"""The wind of a tropical cyclone on a grid, from the fixes of its best track.

Each quadrant of each fix has a profile of wind speed over distance from the centre, made of power laws
V ~ r^n, which are straight lines in logarithms:

- from the centre to the radius of maximum wind n = 1, a core in solid rotation; outward from there power
  laws lead through the published radii of 64, 50 and 34 kt: a modified Rankine vortex (Depperman 1947,
  Bulletin of the American Meteorological Society 28) whose exponent changes from piece to piece;
- beyond the outermost radius n = -1, constant angular momentum, unless another exponent is asked for.

The published maximum belongs to the strongest quadrant. In the others the wind at the radius of maximum wind
is no more than the innermost published radius allows if wind falls no faster than 1/r, the Rankine vortex's
constant angular momentum, and it stays below a published speed that the quadrant does not reach.

Between the middles of the quadrants, and between fixes around the moving centre, the logarithms of speed are
blended. A published radius is the quadrant's largest; here it is taken for that of the quadrant's middle, so
that near a seam the weaker quadrant gets some of its neighbour's wind. The storm's motion needs no term of
its own: the published speeds and radii are relative to the ground.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.grid import Grid
from planner.windfield import WindField
from sim.errors import WeatherError
from sim.weather.best_track import QUADRANT_BEARINGS_RAD, RADIUS_SPEEDS_MPS, BestTrackFix

Floats = NDArray[np.float64]

_EARTH_RADIUS_M = 6371008.8  # mean radius, IUGG; the sphere errs by 0.4 % and saves 0.1 s a field time
_NEAREST_M, _FARTHEST_M = 1.0, 1e8
_UNREACHED = 0.95  # share of a speed that a quadrant does not reach, which it is given at most
_CORE_INFLOW = 0.4  # share of the inflow angle at the radius of maximum wind ...
_FULL_INFLOW_RADII = 1.2  # ... and multiple of that radius where it is whole


class Profile(NamedTuple):
    """Wind speed over distance from the centre: straight lines between nodes (ln m, ln m/s), shape (n,)."""

    log_radius: Floats
    log_speed: Floats

    def speed_mps(self, radius_m: ArrayLike) -> Floats:
        """The speed at distances from the centre [m]."""
        log_radius = np.log(np.clip(radius_m, _NEAREST_M, _FARTHEST_M))
        return np.asarray(np.exp(np.interp(log_radius, *self)), dtype=np.float64)

    def blended(self, other: Profile, weight: float) -> Profile:
        """Between this profile (weight 0) and another (weight 1), exactly: on the nodes of both."""
        nodes = np.union1d(self.log_radius, other.log_radius)
        mine, others = np.interp(nodes, *self), np.interp(nodes, *other)
        return Profile(nodes, (1.0 - weight) * mine + weight * others)


class Shift(NamedTuple):
    """How a storm differs from its best track at one moment: where it lies, and how strong it is.

    `strength`: factor on every wind speed; the radii of given speeds grow or shrink with it.
    """

    north_m: float
    east_m: float
    strength: float


_UNSHIFTED = Shift(0.0, 0.0, 1.0)


def quadrant_profiles(fix: BestTrackFix, outer_exponent: float = -1.0) -> tuple[Profile, ...]:
    """The profile of each quadrant of a fix, in the order of `QUADRANT_BEARINGS_RAD`; see `vortex_field`."""
    quadrants = [
        [
            (radius_m, speed_mps)
            for radius_m, speed_mps in zip(radii_m, RADIUS_SPEEDS_MPS, strict=True)
            if radius_m
        ]
        for radii_m in zip(*fix.radii_m, strict=True)
    ]
    allowed_mps = [_allowed_peak_mps(fix, reached) for reached in quadrants]
    strongest = max(allowed_mps)
    return tuple(
        _profile(
            fix,
            reached,
            fix.max_wind_mps if allowed == strongest else min(allowed, fix.max_wind_mps),
            outer_exponent,
        )
        for reached, allowed in zip(quadrants, allowed_mps, strict=True)
    )


def vortex_field(
    fixes: Sequence[BestTrackFix],
    grid: Grid,
    time_s: ArrayLike,
    *,
    inflow_rad: float = math.radians(20.0),
    outer_exponent: float = -1.0,
    flight_level_ratio: float = 1.0,
    shifts: Sequence[Shift] | None = None,
) -> WindField:
    """The cyclone's wind at 10 m, the same at every altitude: float32, shape (T, rows, columns), toward.

    The wind turns counter-clockwise and inward. The inflow angle has the shape that Sobey, Harper and Stark
    (1977, James Cook University Research Bulletin CS14) give it: rising linearly to 0.4 of the whole at the
    radius of maximum wind and to the whole at 1.2 of that radius, which here is `inflow_rad`, not their 25
    deg. Inflow turns the wind; it does not change its speed.

    Args:
        fixes: of one storm, rising in time.
        grid: where the wind is wanted.
        time_s: when, rising, shape (T,) [s since 1970-01-01 UTC].
        inflow_rad: angle between the wind and the circle around the centre, outside the core.
        outer_exponent: n in V ~ r^n beyond a quadrant's outermost published radius: -1 keeps the angular
            momentum; -1/2, the steady vortex of Riehl (1963, Journal of the Atmospheric Sciences 20), reaches
            farther out.
        flight_level_ratio: factor on the speed, 1 for the published surface wind as it stands. In eyewalls
            dropsondes put the surface wind at about 0.75 of the wind at 750 m and 0.8 of that at 1500 m:
            ratios of 1.3 and 1.25 (Franklin, Black and Valde 2003, Weather and Forecasting 18).
        shifts: how far the storm is off its fixes at each of the times; without, it keeps to them.

    Raises:
        WeatherError: if there are less than two fixes, they do not rise in time, or a time lies outside them.
    """
    times_s = np.atleast_1d(np.asarray(time_s, dtype=np.float64))
    fix_time_s = np.array([fix.time_s for fix in fixes])
    if not outer_exponent < 0.0:
        raise WeatherError(
            f"wind must fall with distance: give an outer exponent below zero, not {outer_exponent}"
        )
    if len(fixes) < 2 or not (np.diff(fix_time_s) > 0.0).all():
        raise WeatherError(
            f"a storm's wind needs two or more fixes that rise in time, not {len(fixes)} fixes"
        )
    if not (times_s.size and fix_time_s[0] <= times_s.min() and times_s.max() <= fix_time_s[-1]):
        asked, known = (
            " to ".join(
                str(np.datetime64(round(end), "s")) if math.isfinite(end) else "nothing" for end in ends
            )
            for ends in ((times_s.min(), times_s.max()), (fix_time_s[0], fix_time_s[-1]))
        )
        raise WeatherError(
            f"wind of {asked} UTC was asked for, but the fixes are of {known} UTC; move or shorten it"
        )
    north_mps = np.empty((times_s.size, *grid.shape), dtype=np.float32)
    east_mps = np.empty_like(north_mps)
    profiles = [quadrant_profiles(fix, outer_exponent) for fix in fixes]
    offs = [_UNSHIFTED] * times_s.size if shifts is None else shifts
    for sheet, (moment_s, off) in enumerate(zip(times_s, offs, strict=True)):
        storm = _storm(fixes, profiles, float(moment_s)).shifted(off)
        around = _around(storm, grid)
        speed_mps = off.strength * flight_level_ratio * _speed_mps(around, storm.quadrants)
        inflow = inflow_rad * np.interp(
            around.distance_m / storm.core_m, (0.0, 1.0, _FULL_INFLOW_RADII), (0.0, _CORE_INFLOW, 1.0)
        )
        along, inward = speed_mps * np.cos(inflow), speed_mps * np.sin(inflow)
        north_mps[sheet] = along * around.out_east - inward * around.out_north
        east_mps[sheet] = -along * around.out_north - inward * around.out_east
    return WindField(grid, times_s, north_mps, east_mps)


class _Storm(NamedTuple):
    """The storm at one moment: its centre, radius of maximum wind and the profiles of its quadrants."""

    lat_rad: float
    lon_rad: float
    core_m: float
    quadrants: tuple[Profile, ...]

    def shifted(self, by: Shift) -> _Storm:
        """The same storm elsewhere."""
        north_rad = by.north_m / _EARTH_RADIUS_M
        east_rad = by.east_m / (_EARTH_RADIUS_M * math.cos(self.lat_rad))
        return self._replace(lat_rad=self.lat_rad + north_rad, lon_rad=self.lon_rad + east_rad)


def _storm(fixes: Sequence[BestTrackFix], profiles: Sequence[tuple[Profile, ...]], time_s: float) -> _Storm:
    """The storm between the two fixes around a moment."""
    first = min(bisect_right(fixes, time_s, key=lambda fix: fix.time_s) - 1, len(fixes) - 2)
    before, after = fixes[first], fixes[first + 1]
    weight = (time_s - before.time_s) / (after.time_s - before.time_s)
    return _Storm(
        before.lat_rad + weight * (after.lat_rad - before.lat_rad),
        before.lon_rad + weight * (after.lon_rad - before.lon_rad),
        before.max_wind_radius_m + weight * (after.max_wind_radius_m - before.max_wind_radius_m),
        tuple(one.blended(other, weight) for one, other in zip(*profiles[first : first + 2], strict=True)),
    )


class _Around(NamedTuple):
    """Cells as seen from the centre, and the way out from the centre as seen at the cell, shape (R, C)."""

    distance_m: Floats
    bearing_north: Floats  # unit vector at the centre, towards the cell
    bearing_east: Floats
    out_north: Floats  # unit vector at the cell, away from the centre
    out_east: Floats


def _around(storm: _Storm, grid: Grid) -> _Around:
    """Great circles from the centre to the cells, on the sphere."""
    sine, cosine = math.sin(storm.lat_rad), math.cos(storm.lat_rad)
    sines, cosines = np.sin(grid.lat_rad)[:, np.newaxis], np.cos(grid.lat_rad)[:, np.newaxis]
    east, ahead = np.sin(grid.lon_rad - storm.lon_rad), np.cos(grid.lon_rad - storm.lon_rad)
    bearing_north, bearing_east = cosine * sines - sine * cosines * ahead, east * cosines
    sine_of_distance = np.hypot(bearing_north, bearing_east)
    distance_m = _EARTH_RADIUS_M * np.arctan2(sine_of_distance, sine * sines + cosine * cosines * ahead)
    unit = 1.0 / np.maximum(
        sine_of_distance, 1e-12
    )  # at the centre itself no way is out, and the air is calm
    out_north, out_east = cosine * sines * ahead - sine * cosines, np.broadcast_to(cosine * east, unit.shape)
    return _Around(distance_m, bearing_north * unit, bearing_east * unit, out_north * unit, out_east * unit)


def _speed_mps(around: _Around, quadrants: Sequence[Profile]) -> Floats:
    """The quadrants' profiles blended by the squared cosine of the angle from each quadrant's middle."""
    log_radius = np.log(np.clip(around.distance_m, _NEAREST_M, _FARTHEST_M))
    log_speed = np.zeros_like(log_radius)
    for bearing_rad, profile in zip(QUADRANT_BEARINGS_RAD, quadrants, strict=True):
        cosine = math.cos(bearing_rad) * around.bearing_north + math.sin(bearing_rad) * around.bearing_east
        near = np.maximum(cosine, 0.0) ** 2  # two neighbours' weights add up to one: cos^2 + sin^2
        log_speed += near * np.interp(log_radius, *profile)
    return np.asarray(np.exp(log_speed), dtype=np.float64)


def _allowed_peak_mps(fix: BestTrackFix, reached: Sequence[tuple[float, float]]) -> float:
    """The highest wind that a quadrant's published (radius_m, speed_mps) pairs, outermost first, allow."""
    speeds_missed = RADIUS_SPEEDS_MPS[len(reached) :]
    below_mps = _UNREACHED * speeds_missed[0] if speeds_missed else math.inf
    if not reached:
        return below_mps
    radius_m, speed_mps = reached[-1]
    return min(below_mps, speed_mps * max(1.0, radius_m / fix.max_wind_radius_m))


def _profile(
    fix: BestTrackFix, reached: Sequence[tuple[float, float]], peak_mps: float, outer_exponent: float
) -> Profile:
    """Through the peak and a quadrant's published (radius_m, speed_mps) pairs, outermost first."""
    outward = list(reversed(reached))
    core_m = fix.max_wind_radius_m
    if outward:  # a radius inside the core draws the quadrant's core in
        core_m = min(core_m, outward[0][0] * outward[0][1] / peak_mps)
    if not outward or core_m < 0.999 * outward[0][0]:
        outward.insert(0, (core_m, peak_mps))
    edge_m, edge_mps = outward[-1]
    outward.append((_FARTHEST_M, edge_mps * (_FARTHEST_M / edge_m) ** outer_exponent))
    core_m, core_mps = outward[0]
    outward.insert(0, (_NEAREST_M, core_mps * _NEAREST_M / core_m))
    log_radius, log_speed = np.log(np.array(outward)).T
    return Profile(log_radius, log_speed)
