"""Where the aircraft is, once a second, in the messages that viewers know."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.grid import LocalFrame
from recordings.message_template import MessageTemplate, mark
from recordings.messages import new
from recordings.schema import BODY_FRAME, MAP_FRAME, POSE, POSITION, STATE_COLUMNS, TRANSFORM, Topic

Floats = NDArray[np.float64]

_YELLOW = (0.96, 0.84, 0.27, 1.0)
"""Of the position on a map; where it has none, `rerun mcap convert` makes a file that Rerun finds wrong."""

_PLACES = {column.name: place for place, column in enumerate(STATE_COLUMNS)}
_GEODETIC, _IN_PLANE = 4, 7
"""Numbers of a position (latitude, longitude, altitude, heading) and of a pose (x, y, z; x, y, z, w)."""


class PoseMessages:
    """Makes the messages of many moments at once."""

    def __init__(self, frame: LocalFrame) -> None:
        self._frame = frame
        lat, lon, altitude, heading = map(mark, range(_GEODETIC))
        colour = dict(zip("rgba", _YELLOW, strict=True))
        position = new(POSITION, frame_id=BODY_FRAME, color=colour, latitude=lat, longitude=lon)
        position.altitude, position.heading = altitude, heading
        place = dict(zip("xyz", map(mark, range(3)), strict=True))
        turn = dict(zip("xyzw", map(mark, range(3, _IN_PLANE)), strict=True))
        pose = new(POSE, frame_id=MAP_FRAME, pose={"position": place, "orientation": turn})
        transform = new(TRANSFORM, parent_frame_id=MAP_FRAME, child_frame_id=BODY_FRAME)
        transform.translation.MergeFrom(pose.pose.position)
        transform.rotation.MergeFrom(pose.pose.orientation)
        self.templates: dict[Topic, MessageTemplate] = {
            POSITION: MessageTemplate(position, _GEODETIC),
            POSE: MessageTemplate(pose, _IN_PLANE),
            TRANSFORM: MessageTemplate(transform, _IN_PLANE),
        }

    def numbers(self, table: Floats) -> dict[Topic, Floats]:
        """What to fill the templates with, for rows of `STATE_COLUMNS`."""
        lat_rad, lon_rad, altitude_m, roll_rad, pitch_rad, heading_rad = (
            table[:, _PLACES[name]]
            for name in ("lat_rad", "lon_rad", "altitude_m", "roll_rad", "pitch_rad", "heading_rad")
        )
        somewhere = np.isfinite(lat_rad + lon_rad)
        north_m, east_m = np.full((2, len(table)), np.nan)
        north_m[somewhere], east_m[somewhere] = self._frame.to_plane(lat_rad[somewhere], lon_rad[somewhere])
        quaternion = east_north_up_quaternion(roll_rad, pitch_rad, heading_rad)
        in_plane = np.column_stack([east_m, north_m, altitude_m, quaternion])
        geodetic = np.column_stack([np.degrees(lat_rad), np.degrees(lon_rad), altitude_m, heading_rad])
        return {POSITION: geodetic, POSE: in_plane, TRANSFORM: in_plane}


def east_north_up_quaternion(roll_rad: ArrayLike, pitch_rad: ArrayLike, heading_rad: ArrayLike) -> Floats:
    """Attitudes as (x, y, z, w), shape (..., 4), from forward-left-up body axes to east-north-up.

    The rotations about body z, y and x in that order: heading is counted from east and anticlockwise, and
    nose up is a negative turn about the axis to the left. NaN of an attitude that is not finite.
    """
    roll, pitch, heading = (np.asarray(angle) / 2.0 for angle in (roll_rad, pitch_rad, heading_rad))
    with np.errstate(invalid="ignore"):
        cr, sr = np.cos(roll), np.sin(roll)
        cp, sp = np.cos(pitch), -np.sin(pitch)
        cy, sy = np.cos(np.pi / 4.0 - heading), np.sin(np.pi / 4.0 - heading)
    turns = (
        cy * cp * sr - sy * sp * cr,
        cy * sp * cr + sy * cp * sr,
        sy * cp * cr - cy * sp * sr,
        cy * cp * cr + sy * sp * sr,
    )
    return np.stack(turns, axis=-1)
