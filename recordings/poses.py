"""Where the aircraft is, once a second, in the messages that viewers know."""

from __future__ import annotations

import math

from aircraft.state import FlightState
from planner.grid import LocalFrame
from recordings.messages import new, serialised
from recordings.schema import BODY_FRAME, MAP_FRAME, POSE, POSITION, TRANSFORM


class PoseMessages:
    """Makes the three messages of one moment; the message objects are used again, for speed."""

    def __init__(self, frame: LocalFrame) -> None:
        self._frame = frame
        self._position = new(POSITION, frame_id=BODY_FRAME)
        self._pose = new(POSE, frame_id=MAP_FRAME)
        self._transform = new(TRANSFORM, parent_frame_id=MAP_FRAME, child_frame_id=BODY_FRAME)

    def of(self, state: FlightState, log_time: int) -> tuple[bytes, bytes, bytes]:
        """Position, pose and transform of the aircraft."""
        position, pose, transform = self._position, self._pose, self._transform
        for message in (position, pose, transform):
            message.timestamp.seconds, message.timestamp.nanos = divmod(log_time, 1_000_000_000)
        position.latitude, position.longitude = math.degrees(state.lat_rad), math.degrees(state.lon_rad)
        position.altitude, position.heading = state.altitude_m, state.heading_rad
        north_m = east_m = math.nan
        if math.isfinite(state.lat_rad + state.lon_rad):
            north_m, east_m, _ = self._frame.plane_point(state.lat_rad, state.lon_rad)
        quaternion = east_north_up_quaternion(state.roll_rad, state.pitch_rad, state.heading_rad)
        for place, turn in (
            (pose.pose.position, pose.pose.orientation),
            (transform.translation, transform.rotation),
        ):
            place.x, place.y, place.z = east_m, north_m, state.altitude_m
            turn.x, turn.y, turn.z, turn.w = quaternion
        return serialised(position), serialised(pose), serialised(transform)


def east_north_up_quaternion(
    roll_rad: float, pitch_rad: float, heading_rad: float
) -> tuple[float, float, float, float]:
    """The attitude as (x, y, z, w), from forward-left-up body axes to east-north-up.

    The rotations about body z, y and x in that order: heading is counted from east and anticlockwise, and
    nose up is a negative turn about the axis to the left. NaN of an attitude that is not finite.
    """
    if not math.isfinite(roll_rad + pitch_rad + heading_rad):
        return math.nan, math.nan, math.nan, math.nan
    roll, pitch, yaw = roll_rad / 2.0, -pitch_rad / 2.0, (math.pi / 2.0 - heading_rad) / 2.0
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return (
        cy * cp * sr - sy * sp * cr,
        cy * sp * cr + sy * cp * sr,
        sy * cp * cr - cy * sp * sr,
        cy * cp * cr + sy * sp * sr,
    )
