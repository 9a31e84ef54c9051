"""A flight made of arithmetic: circles or a straight line through the air, in steady wind and gusts."""

import math

import numpy as np
import pyproj
import pytest

from aircraft.path import along
from aircraft.state import FlightState

GEOD = pyproj.Geod(ellps="WGS84")
LAT_RAD, LON_RAD, ALTITUDE_M, AIRSPEED_MPS = math.radians(26.0), math.radians(-84.0), 1000.0, 27.0
NOTHING = FlightState(*[0.0] * len(FlightState._fields))


def metres_per_radian(lat_rad, lon_rad):
    """North and east, at sea level, from geodesics of a ten thousandth of a degree."""
    lat_deg, lon_deg, step_deg = math.degrees(lat_rad), math.degrees(lon_rad), 1e-4
    north_m = GEOD.inv(lon_deg, lat_deg - step_deg / 2, lon_deg, lat_deg + step_deg / 2)[2]
    east_m = GEOD.inv(lon_deg, lat_deg, lon_deg + step_deg, lat_deg)[2]
    return north_m / math.radians(step_deg), east_m / math.radians(step_deg)


@pytest.fixture(scope="session")
def circling():
    """Makes the states of a flight: (duration_s, ...) -> list of FlightState."""

    def made(
        duration_s,
        *,
        hz=10.0,
        turn_radps=0.1,
        wind=(0.0, 0.0),
        gust_rms_mps=0.0,
        gust_s=20.0,
        climb_mps=0.0,
        seed=0,
    ):
        step_s, random = 1.0 / hz, np.random.default_rng(seed)
        lat_rad, lon_rad, altitude_m = LAT_RAD, LON_RAD, ALTITUDE_M
        kept = math.exp(-step_s / gust_s)
        gust = gust_rms_mps * random.standard_normal(2)
        states, before = [], None
        for tick in range(round(duration_s * hz) + 1):
            heading_rad = math.remainder(turn_radps * tick * step_s, 2.0 * math.pi)
            north_mps = AIRSPEED_MPS * math.cos(heading_rad) + wind[0]
            east_mps = AIRSPEED_MPS * math.sin(heading_rad) + wind[1]
            if before is not None:
                # metres per radian grow with height by a metre each
                north_per_rad, east_per_rad = metres_per_radian(lat_rad, lon_rad)
                lat_rad += 0.5 * (before[0] + north_mps) * step_s / (north_per_rad + altitude_m)
                lon_rad += (
                    0.5 * (before[1] + east_mps) * step_s / (east_per_rad + altitude_m * math.cos(lat_rad))
                )
                altitude_m += climb_mps * step_s
            before = north_mps, east_mps
            through = north_mps - wind[0] - gust[0], east_mps - wind[1] - gust[1]
            states.append(
                NOTHING._replace(
                    time_s=tick * step_s - 60.0,
                    lat_rad=lat_rad,
                    lon_rad=lon_rad,
                    altitude_m=altitude_m,
                    north_mps=north_mps,
                    east_mps=east_mps,
                    down_mps=-climb_mps,
                    roll_rad=math.atan(AIRSPEED_MPS * turn_radps / 9.80665),
                    heading_rad=math.atan2(through[1], through[0]) % (2.0 * math.pi),
                    airspeed_mps=math.hypot(*through, climb_mps),
                    wind_north_mps=wind[0],
                    wind_east_mps=wind[1],
                )
            )
            gust = kept * gust + gust_rms_mps * math.sqrt(1.0 - kept * kept) * random.standard_normal(2)
        return states

    return made


@pytest.fixture(scope="session")
def assert_continuous():
    """Checks a reference in itself."""

    def check(reference):
        """Position, course, time and altitude at a segment's end are those at the next one's beginning."""
        for i in range(len(reference.start_m) - 1):
            end_m = reference.length_m[i]
            north_m, east_m = along(
                reference.north_m[i],
                reference.east_m[i],
                reference.course_rad[i],
                reference.curvature[i],
                end_m,
            )
            assert north_m == pytest.approx(reference.north_m[i + 1], abs=1e-5)
            assert east_m == pytest.approx(reference.east_m[i + 1], abs=1e-5)
            turn_rad = reference.course_rad[i] + reference.curvature[i] * end_m - reference.course_rad[i + 1]
            assert math.remainder(turn_rad, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-8)
            assert reference.end_time_s[i] == pytest.approx(reference.start_time_s[i + 1], abs=1e-7)
            assert reference.end_altitude_m[i] == pytest.approx(reference.start_altitude_m[i + 1], abs=1e-7)
        assert np.all(reference.end_time_s > reference.start_time_s)

    return check


@pytest.fixture(scope="session")
def assert_same_place():
    """Checks two references against each other."""

    def check(old, old_m, new, new_m, later_s):
        """Both are at the same place, on the same course, at times that differ by so much."""
        was, now = old.at(old_m), new.at(new_m)
        assert (now.north_m, now.east_m) == pytest.approx((was.north_m, was.east_m), abs=1e-5)
        assert now.altitude_m == pytest.approx(was.altitude_m, abs=1e-6)
        assert math.remainder(now.course_rad - was.course_rad, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-8)
        assert now.time_s == pytest.approx(was.time_s + later_s, abs=1e-6)

    return check
