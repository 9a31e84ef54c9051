"""The route as MAVLink mission items, which both mission formats hold.

Source of the commands and their parameters: MAVLink's common message set.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from planner.export.schedule import Stop
from planner.grid import geodesic_m

NAV_WAYPOINT = 16
NAV_LOITER_TIME = 19
DO_CHANGE_SPEED = 178
FRAME_GLOBAL = 0  # altitude above mean sea level
FRAME_MISSION = 2  # no position
SPEED_TOLERANCE_MPS = 0.1

_GROUND_SPEED = 1.0
_SAME_THROTTLE = -1.0


class Item(NamedTuple):
    """A mission item: command, frame and the seven parameters; a position is [deg, deg, m]."""

    command: int
    frame: int
    parameters: tuple[float, float, float, float, float, float, float]


def mission_items(route: tuple[Stop, ...]) -> Iterator[Item]:
    """One item a stop, a waypoint or a loiter, and the ground speed of each leg where it changes.

    A speed is commanded for the first leg, and again for every leg whose ground speed differs by more than
    `SPEED_TOLERANCE_MPS` from the last one commanded; a leg slower than that, straight up for instance, gets
    none. Around Ian (506 stops in 17 h) this makes 212 commands that meet every time within 1.5 s; 0.5 m/s
    would make 92 and miss by 200 s. A loiter's radius is left to the vehicle.
    """
    commanded_mps = 0.0
    yield _stop_item(route[0])
    for before, after in pairwise(route):
        speed_mps = leg_speed_mps(before, after)
        if speed_mps > SPEED_TOLERANCE_MPS and abs(speed_mps - commanded_mps) > SPEED_TOLERANCE_MPS:
            commanded_mps = round(speed_mps, 3)
            parameters = (_GROUND_SPEED, commanded_mps, _SAME_THROTTLE, 0.0, 0.0, 0.0, 0.0)
            yield Item(DO_CHANGE_SPEED, FRAME_MISSION, parameters)
        yield _stop_item(after)


def leg_speed_mps(before: Stop, after: Stop) -> float:
    """Ground speed along the geodesic from one stop to the next [m/s]."""
    lat_1_rad, lon_1_rad = math.radians(before.lat_deg), math.radians(before.lon_deg)
    lat_2_rad, lon_2_rad = math.radians(after.lat_deg), math.radians(after.lon_deg)
    length_m = float(geodesic_m(lat_1_rad, lon_1_rad, lat_2_rad, lon_2_rad))
    return length_m / (after.arrive_s - before.leave_s)


def _stop_item(stop: Stop) -> Item:
    command = NAV_LOITER_TIME if stop.waiting_s > 0.0 else NAV_WAYPOINT
    return Item(command, FRAME_GLOBAL, (stop.waiting_s, 0.0, 0.0, 0.0, *stop.position))
