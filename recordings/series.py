"""A flight measured sample by sample and waypoint by waypoint against its plan and reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.grid import geodesic_m
from recordings.figures import Places
from recordings.passing import passing_times_s, progress_m
from recordings.recording import Recording

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """What was measured after departure.

    Of samples, shape (samples,): `path_m` is the progress along the reference in plane metres, cross-track
    right positive, altitude error above positive, wind the speed of the steady wind at the aircraft. Of
    waypoints, shape (waypoints,): time error late positive and NaN where never reached, and the true distance
    from the waypoint to the reference, which corners cut off.
    """

    time_s: Floats
    lat_rad: Floats
    lon_rad: Floats
    path_m: Floats
    cross_track_m: Floats
    altitude_error_m: Floats
    airspeed_mps: Floats
    wind_mps: Floats
    waypoint_lat_deg: Floats
    waypoint_lon_deg: Floats
    waypoint_time_s: Floats
    waypoint_time_error_s: Floats
    corner_cut_m: Floats

    @property
    def samples(self) -> Places:
        """When and where the samples were taken."""
        return Places(self.time_s, np.degrees(self.lat_rad), np.degrees(self.lon_rad))

    @property
    def planned(self) -> Places:
        """When and where the waypoints are planned."""
        return Places(self.waypoint_time_s, self.waypoint_lat_deg, self.waypoint_lon_deg)

    @property
    def passed(self) -> Places:
        """When the waypoints were passed, and where they are."""
        passed_s = self.waypoint_time_s + self.waypoint_time_error_s
        return Places(passed_s, self.waypoint_lat_deg, self.waypoint_lon_deg)


def measure(recording: Recording) -> Series:
    """Measure a sound recording."""
    header, state = recording.header, recording.state
    frame, reference = header.grid.frame, header.reference
    time_s, lat_rad, lon_rad = state["time_s"], state["lat_rad"], state["lon_rad"]
    north_m, east_m = frame.to_plane(lat_rad, lon_rad)
    path_m, cross_track_m = reference.project_many(north_m, east_m, reference.path_at_times(time_s))
    altitude_error_m = state["altitude_m"] - reference.at_many(path_m).altitude_m
    wind_mps = np.hypot(state["wind_north_mps"], state["wind_east_mps"], dtype=np.float64)
    planned = np.array([(point.time_s, point.lat_deg, point.lon_deg) for point in header.plan.waypoints])
    waypoint_time_s, waypoint_lat_deg, waypoint_lon_deg = planned.T
    passed_s = passing_times_s(
        reference.waypoint_path_m, time_s, progress_m(reference, north_m, east_m, path_m)
    )
    nearest = reference.at_many(reference.waypoint_path_m)
    nearest_lat_rad, nearest_lon_rad = frame.to_geodetic(nearest.north_m, nearest.east_m)
    flight = time_s >= 0.0
    return Series(
        time_s=time_s[flight],
        lat_rad=lat_rad[flight],
        lon_rad=lon_rad[flight],
        path_m=path_m[flight],
        cross_track_m=cross_track_m[flight],
        altitude_error_m=altitude_error_m[flight],
        airspeed_mps=state["airspeed_mps"][flight].astype(np.float64),
        wind_mps=wind_mps[flight],
        waypoint_lat_deg=waypoint_lat_deg,
        waypoint_lon_deg=waypoint_lon_deg,
        waypoint_time_s=waypoint_time_s,
        waypoint_time_error_s=passed_s - waypoint_time_s,
        corner_cut_m=geodesic_m(
            np.radians(waypoint_lat_deg), np.radians(waypoint_lon_deg), nearest_lat_rad, nearest_lon_rad
        ),
    )
