"""A vortex that wanders over a course of right angles: weather, route and scenario of the tracking benchmark.

The vortex is a core in solid rotation inside 20 km and falls with distance outside, 15 m/s at the most; its
centre goes round a circle of 25 km in six hours. The course of 3.6 km legs turns left or right at random
and stays within 25 km of the middle, so that every leg lies in strong wind that shears and turns. Each leg
has the time that the wind triangle gives it at cruise airspeed in the forecast.
"""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np

from planner.grid import Grid
from planner.plans import GoalOutcome, Plan, Waypoint
from planner.windfield import WindField
from planner.windtriangle import ground_speed
from sim.scenario import LoadedScenario, parse_scenario

LEG_M = 3600.0
BOX_M = 25_000.0
STRONGEST_MPS = 15.0
CORE_M = 20_000.0
ORBIT_M, ORBIT_S = 25_000.0, 6 * 3600.0
SHEET_S = 900.0
DEPARTURE_S = 1_664_409_600.0  # 2022-09-29T00:00:00Z
CENTRE_LAT_DEG, CENTRE_LON_DEG = 26.0, -84.0
HALF_DEG = 0.6
ALTITUDE_M = 1000.0

_SCENARIO = """
name = "vortex-course"
[mission]
departure = 2022-09-29T00:00:00Z
start = {{ name = "Start", lat_deg = 26.0, lon_deg = -84.0 }}
goals = [{{ name = "End", lat_deg = 26.1, lon_deg = -84.0 }}]
goal = "End"
[weather]
file = "vortex.nc"
[stages]
count = {hours}
[hazard]
threshold_mps = 100.0
"""


def scenario_text(hours: int) -> str:
    return _SCENARIO.format(hours=hours)


def load(folder: Path, hours: int, overrides: tuple[str, ...] = ()) -> LoadedScenario:
    """The scenario whose weather `write_weather` left in a folder; overrides are lines of TOML tables."""
    text = "\n".join([scenario_text(hours), *overrides])
    return LoadedScenario(parse_scenario(tomllib.loads(text), "vortex-course"), text, folder)


def write_weather(folder: Path, hours: int) -> None:
    """The vortex as a CF file, so that the flights take the way of a user's own weather."""
    import xarray as xr

    grid = Grid.covering(
        *(math.radians(CENTRE_LAT_DEG + side) for side in (-HALF_DEG, HALF_DEG)),
        *(math.radians(CENTRE_LON_DEG + side) for side in (-HALF_DEG, HALF_DEG)),
        rows=41,
        columns=41,
    )
    lat_rad, lon_rad = np.meshgrid(grid.lat_rad, grid.lon_rad, indexing="ij")
    north_m, east_m = grid.frame.to_plane(lat_rad, lon_rad)
    time_s = np.arange(0.0, (hours + 2) * 3600.0 + 1.0, SHEET_S)
    angle = 2.0 * np.pi * time_s[:, np.newaxis, np.newaxis] / ORBIT_S
    from_n, from_e = north_m - ORBIT_M * np.cos(angle), east_m - ORBIT_M * np.sin(angle)
    radii = np.hypot(from_n, from_e) / CORE_M
    turning = STRONGEST_MPS / CORE_M / np.maximum(radii, 1.0) ** 1.5
    axes = ("time", "latitude", "longitude")
    xr.Dataset(
        {
            "u10": (axes, -turning * from_n, {"standard_name": "eastward_wind", "units": "m s-1"}),
            "v10": (axes, turning * from_e, {"standard_name": "northward_wind", "units": "m s-1"}),
        },
        coords={
            "time": ("time", DEPARTURE_S + time_s, {"units": "seconds since 1970-01-01"}),
            "latitude": ("latitude", np.degrees(grid.lat_rad), {"units": "degrees_north"}),
            "longitude": ("longitude", np.degrees(grid.lon_rad), {"units": "degrees_east"}),
        },
    ).to_netcdf(folder / "vortex.nc", engine="netcdf4")


def corners(legs: int) -> list[tuple[float, float]]:
    """Places (north_m, east_m) on a square lattice: at each a right angle, left or right as a die falls."""
    random = np.random.default_rng(11)
    places, step = [(0.0, 0.0)], (1, 0)
    for _ in range(legs):
        north, east = places[-1][0] + LEG_M * step[0], places[-1][1] + LEG_M * step[1]
        places.append((north, east))
        sides = [(-step[1], step[0]), (step[1], -step[0])]
        random.shuffle(sides)
        inside = [
            side for side in sides if max(abs(north + LEG_M * side[0]), abs(east + LEG_M * side[1])) <= BOX_M
        ]
        step = inside[0]
    return places


def make_course(forecast: WindField, legs: int, cruise_mps: float) -> Plan:
    """The course as a plan, on time for the forecast."""
    frame = forecast.grid.frame
    time_s, waypoints = 0.0, []
    places = corners(legs)
    geodetic = [frame.to_geodetic(*place) for place in places]
    for i, (lat_rad, lon_rad) in enumerate(geodetic):
        waypoints.append(
            Waypoint(math.degrees(lat_rad), math.degrees(lon_rad), ALTITUDE_M, time_s, int(time_s // 3600.0))
        )
        if i < legs:
            time_s += _leg_s(forecast, places[i], places[i + 1], time_s, cruise_mps)
    lat_deg, lon_deg = waypoints[-1].lat_deg, waypoints[-1].lon_deg
    return Plan(
        planner="course",
        objective="earliest",
        departure_s=DEPARTURE_S,
        goal="End",
        waypoints=tuple(waypoints),
        goals=(GoalOutcome("End", lat_deg, lon_deg, reachable=True, arrival_s=time_s),),
    )


def _leg_s(
    forecast: WindField,
    start: tuple[float, float],
    end: tuple[float, float],
    leave_s: float,
    cruise_mps: float,
) -> float:
    """Time of a leg at cruise airspeed in the forecast wind, by midpoints of 36 parts."""
    frame, parts = forecast.grid.frame, 36
    north, east = (end[0] - start[0]) / parts, (end[1] - start[1]) / parts
    length_m = math.hypot(north, east)
    taken_s = 0.0
    for i in range(parts):
        lat_rad, lon_rad = frame.to_geodetic(start[0] + (i + 0.5) * north, start[1] + (i + 0.5) * east)
        wind = forecast.at(DEPARTURE_S + leave_s + taken_s, lat_rad, lon_rad, ALTITUDE_M)
        along = (wind.north_mps * north + wind.east_mps * east) / length_m
        across = (wind.east_mps * north - wind.north_mps * east) / length_m
        taken_s += length_m / frame.scale(lat_rad) / float(ground_speed(along, across, cruise_mps))
    return taken_s
