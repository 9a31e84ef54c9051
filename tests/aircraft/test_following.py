"""The whole of `aircraft`: JSBSim, guidance and reference, in a moving vortex with turbulence.

The bounds are about twice the worst of eight seeds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pyproj
import pytest
from numpy.typing import NDArray

from aircraft.guidance import Guidance, Progress
from aircraft.jsbsim_aircraft import JsbsimAircraft, Turbulence
from aircraft.reference import PathPoint, Phase, Reference

Floats = NDArray[np.float64]
LEAD_IN_S, WIND_RAMP_S = 40.0, 10.0
LAT_DEG, LON_DEG = 26.0, -84.0
MERCATOR = pyproj.Proj(proj="merc", ellps="WGS84", lat_ts=LAT_DEG, lon_0=LON_DEG)
ORIGIN_EAST_M, ORIGIN_NORTH_M = MERCATOR(LON_DEG, LAT_DEG)


def to_plane(lat_rad: float, lon_rad: float) -> tuple[float, float]:
    east_m, north_m = MERCATOR(lon_rad, lat_rad, radians=True)
    return north_m - ORIGIN_NORTH_M, east_m - ORIGIN_EAST_M


def scale_at(lat_rad: float) -> float:
    return float(MERCATOR.get_factors(LON_DEG, math.degrees(lat_rad)).parallel_scale)


def vortex(north_m: float, east_m: float, time_s: float) -> tuple[float, float]:
    """Up to 8 m/s around a centre that passes east of the route; toward (north_mps, east_mps)."""
    from_n, from_e = north_m - 5000.0 - 4.0 * time_s, east_m - 20000.0 + 3.0 * time_s
    radii = math.hypot(from_n, from_e) / 15000.0
    turning = 16.0 / (1.0 + radii * radii) / 15000.0  # per second: solid rotation inside, fading outside
    return turning * from_e, -turning * from_n


class Flight(NamedTuple):
    reference: Reference
    time_s: Floats
    position: Floats  # [sample, (north, east)]
    progress: list[Progress]
    airspeed_mps: Floats

    def column(self, name: str) -> Floats:
        return np.array([getattr(progress, name) for progress in self.progress])


@pytest.fixture(scope="module")
def flight() -> Flight:
    """Eleven minutes: three corners, a climb, and a wait of two minutes."""
    corners = [(0, 0), (3600, 0), (3600, 3600), (7200, 3600), (7200, 3600), (10800, 3600)]
    altitudes = [1000.0, 1000.0, 1000.0, 1060.0, 1060.0, 1060.0]
    points = []
    for i, ((north_m, east_m), altitude_m) in enumerate(zip(corners, altitudes, strict=True)):
        _, lat_rad = MERCATOR(ORIGIN_EAST_M + east_m, ORIGIN_NORTH_M + north_m, inverse=True, radians=True)
        points.append(PathPoint(float(north_m), float(east_m), altitude_m, 120.0 * i, scale_at(lat_rad)))
    aircraft = JsbsimAircraft("aerosonde", turbulence=Turbulence("milspec", 3), seed=7, rate_hz=60.0)
    reference = Reference.through(
        points,
        turn_radius_m=300.0,
        loiter_radius_m=550.0,
        lead_in_s=LEAD_IN_S,
        wind_at=vortex,
        loiter_airspeed_mps=aircraft.envelope.cruise_mps,
    )
    return fly(aircraft, reference)


def fly(aircraft: JsbsimAircraft, reference: Reference) -> Flight:
    start = reference.at(0.0)
    lon_rad, lat_rad = MERCATOR(
        ORIGIN_EAST_M + start.east_m, ORIGIN_NORTH_M + start.north_m, inverse=True, radians=True
    )
    aircraft.start(
        lat_rad=lat_rad,
        lon_rad=lon_rad,
        altitude_m=start.altitude_m,
        heading_rad=start.course_rad,
        airspeed_mps=start.speed_mps,
        time_s=start.time_s,
    )
    guidance = Guidance(reference, aircraft.envelope)
    times, positions, progresses, airspeeds = [], [], [], []
    while True:
        state = aircraft.state()
        position = to_plane(state.lat_rad, state.lon_rad)
        command, progress = guidance.update(
            state, *position, scale_at(state.lat_rad), state.wind_north_mps, state.wind_east_mps
        )
        aircraft.command(command)
        times.append(state.time_s)
        positions.append(position)
        progresses.append(progress)
        airspeeds.append(state.airspeed_mps)
        if progress.path_m >= reference.end_m or state.time_s > reference.end_time_s[-1] + 60.0:
            return Flight(reference, np.array(times), np.array(positions), progresses, np.array(airspeeds))
        share = min((state.time_s + LEAD_IN_S) / WIND_RAMP_S, 1.0)
        north_mps, east_mps = vortex(*position, max(state.time_s, 0.0))
        aircraft.set_wind(share * north_mps, share * east_mps, 0.0)
        for _ in range(6):
            aircraft.step()


def test_it_arrives(flight: Flight) -> None:
    assert flight.progress[-1].path_m == flight.reference.end_m
    assert set(flight.column("phase").tolist()) == set(Phase)


def test_cross_track(flight: Flight) -> None:
    off_m = np.abs(flight.column("cross_track_m")[flight.time_s >= 0.0])
    assert np.percentile(off_m, 95) < 1.0
    assert off_m.max() < 4.0


def test_altitude(flight: Flight) -> None:
    off_m = np.abs(flight.column("altitude_error_m")[flight.time_s >= 0.0])
    assert np.percentile(off_m, 95) < 1.0
    assert off_m.max() < 2.0


def test_waypoints_are_passed_on_time(flight: Flight) -> None:
    passed_s = np.interp(flight.reference.waypoint_path_m, flight.column("path_m"), flight.time_s)
    late_s = passed_s - 120.0 * np.arange(len(passed_s))
    assert np.abs(late_s).max() < 4.0


def test_it_has_settled_before_departure(flight: Flight) -> None:
    settled = flight.time_s >= -20.0
    assert np.abs(flight.column("cross_track_m")[settled]).max() < 4.0


def test_airspeed_stays_above_the_stall(flight: Flight) -> None:
    assert flight.airspeed_mps.min() > 17.0


def test_the_track_read_back_from_positions_is_what_guidance_saw(flight: Flight) -> None:
    expected_m = flight.reference.path_at_times(flight.time_s)
    path_m, cross_m = flight.reference.project_many(flight.position[:, 0], flight.position[:, 1], expected_m)
    np.testing.assert_allclose(path_m, flight.column("path_m"), atol=1e-3)
    np.testing.assert_allclose(cross_m, flight.column("cross_track_m"), atol=1e-3)
