"""A flight measured sample by sample and waypoint by waypoint against its plan and reference."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from planner.grid import geodesic_m
from recordings.figures import Places
from recordings.following import follow
from recordings.recording import Recording

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Series:
    """What was measured after departure.

    Of samples, shape (samples,): `to_go_m` is the way left to the last waypoint along the reference in plane
    metres, cross-track right positive, altitude error above positive, time error late positive and `phase`
    those of the nearest point, each by the reference that was followed at the time; wind the speed of the
    steady wind at the aircraft; `state` the rows of the recording. Of the last plan's waypoints, which begins
    with what was flown of those before, each at the time of the plan then in force, shape (waypoints,): time
    error late positive and NaN where never reached, and the true distance from the waypoint to the reference,
    which corners cut off.
    """

    time_s: Floats
    lat_rad: Floats
    lon_rad: Floats
    to_go_m: Floats
    cross_track_m: Floats
    altitude_error_m: Floats
    time_error_s: Floats
    phase: NDArray[np.int64]
    airspeed_mps: Floats
    wind_mps: Floats
    waypoint_lat_deg: Floats
    waypoint_lon_deg: Floats
    waypoint_time_s: Floats
    waypoint_time_error_s: Floats
    waypoint_phase: NDArray[np.int64]
    corner_cut_m: Floats
    state: NDArray[np.void]

    @cached_property
    def samples(self) -> Places:
        """When and where the samples were taken."""
        return Places(self.time_s, np.degrees(self.lat_rad), np.degrees(self.lon_rad), self.phase)

    @property
    def planned(self) -> Places:
        """When and where the waypoints are planned."""
        return Places(self.waypoint_time_s, self.waypoint_lat_deg, self.waypoint_lon_deg, self.waypoint_phase)

    @property
    def passed(self) -> Places:
        """When the waypoints were passed, NaN if never, and where they are."""
        passed_s = self.waypoint_time_s + self.waypoint_time_error_s
        return replace(self.planned, time_s=passed_s)


def measure(recording: Recording) -> Series:
    """Measure a sound recording."""
    header, state = recording.header, recording.state
    time_s, lat_rad, lon_rad = state["time_s"], state["lat_rad"], state["lon_rad"]
    north_m, east_m = header.grid.frame.to_plane(lat_rad, lon_rad)
    planned = np.array([(point.time_s, point.lat_deg, point.lon_deg) for point in recording.plan.waypoints])
    waypoint_time_s, waypoint_lat_deg, waypoint_lon_deg = planned.T
    wind_mps = np.hypot(state["wind_north_mps"], state["wind_east_mps"], dtype=np.float64)
    flown = follow(
        recording.references, recording.first_waypoints, time_s, north_m, east_m, state["altitude_m"]
    )
    nearest_lat_rad, nearest_lon_rad = header.grid.frame.to_geodetic(
        flown.nearest_north_m, flown.nearest_east_m
    )
    flight = time_s >= 0.0
    return Series(
        time_s=time_s[flight],
        lat_rad=lat_rad[flight],
        lon_rad=lon_rad[flight],
        to_go_m=flown.to_go_m[flight],
        cross_track_m=flown.cross_track_m[flight],
        altitude_error_m=flown.altitude_error_m[flight],
        time_error_s=flown.time_error_s[flight],
        phase=flown.phase[flight],
        airspeed_mps=state["airspeed_mps"][flight].astype(np.float64),
        wind_mps=wind_mps[flight],
        waypoint_lat_deg=waypoint_lat_deg,
        waypoint_lon_deg=waypoint_lon_deg,
        waypoint_time_s=waypoint_time_s,
        waypoint_time_error_s=flown.passed_s - waypoint_time_s,
        waypoint_phase=flown.waypoint_phase,
        corner_cut_m=geodesic_m(
            np.radians(waypoint_lat_deg), np.radians(waypoint_lon_deg), nearest_lat_rad, nearest_lon_rad
        ),
        state=state[flight],
    )
