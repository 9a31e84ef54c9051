"""What the aircraft is doing, and what it is told to do: plain values, SI and radians."""

from __future__ import annotations

from typing import NamedTuple


class FlightState(NamedTuple):
    """One moment of flight. A named tuple, because a flight makes half a million of them.

    Position is geodetic WGS84; velocities are over ground in north-east-down; `wind_*` is the steady wind
    that the simulation put in, toward, and `gust_*` what turbulence added to it.
    """

    time_s: float
    lat_rad: float
    lon_rad: float
    altitude_m: float
    north_mps: float
    east_mps: float
    down_mps: float
    roll_rad: float
    pitch_rad: float
    heading_rad: float
    roll_rate_radps: float
    pitch_rate_radps: float
    yaw_rate_radps: float
    airspeed_mps: float
    angle_of_attack_rad: float
    sideslip_rad: float
    wind_north_mps: float
    wind_east_mps: float
    wind_down_mps: float
    gust_north_mps: float
    gust_east_mps: float
    gust_down_mps: float
    aileron: float
    elevator: float
    rudder: float
    throttle: float
    fuel_kg: float
    height_above_ground_m: float


ESTIMATED_FIELDS = (
    "lat_rad",
    "lon_rad",
    "altitude_m",
    "north_mps",
    "east_mps",
    "down_mps",
    "roll_rad",
    "pitch_rad",
    "heading_rad",
    "airspeed_mps",
    "wind_north_mps",
    "wind_east_mps",
)
"""What an aircraft without perfect sensors has only estimates of."""


class Command(NamedTuple):
    """What guidance asks of the autopilot.

    `roll_rad`: bank, right wing down positive. `airspeed_mps`: true airspeed. `altitude_m`: above the
    ellipsoid. `climb_mps`: feed-forward of vertical speed, up positive.
    """

    roll_rad: float
    airspeed_mps: float
    altitude_m: float
    climb_mps: float = 0.0
