"""Which fields of Foxglove's messages are filled, and with what; what is not here is left empty.

`timestamp`, the log time, is in all that have one. Angles are degrees in `/position`, as its schema has it,
and radians everywhere else.
"""

from __future__ import annotations

from typing import NamedTuple

from recordings.schema import EVENTS, PLAN, PLAN_PATH, POSE, POSITION, TRANSFORM, TRUTH_GRID, Topic


class Filled(NamedTuple):
    """A field, by its way into the message."""

    path: str
    unit: str
    meaning: str


def _pose(place: str, turn: str, whose: str) -> tuple[Filled, ...]:
    return (
        Filled(f"{place}.x", "m in the plane", f"of {whose}, east"),
        Filled(f"{place}.y", "m in the plane", f"of {whose}, north"),
        Filled(f"{place}.z", "m", f"of {whose}, above the ellipsoid"),
        *(Filled(f"{turn}.{axis}", "", "quaternion from base_link to map") for axis in "xyzw"),
    )


FOXGLOVE_FIELDS: dict[Topic, tuple[Filled, ...]] = {
    PLAN: (
        Filled("geojson", "deg, m", "the route as a line with heights, the goals as points with their names"),
    ),
    PLAN_PATH: (
        Filled("frame_id", "", "map"),
        Filled("poses.position.x", "m in the plane", "of each waypoint, east"),
        Filled("poses.position.y", "m in the plane", "of each waypoint, north"),
        Filled("poses.position.z", "m", "of each waypoint, above the ellipsoid"),
        Filled("poses.orientation.z", "", "quaternion of a turn about the vertical: x along the next leg"),
        Filled("poses.orientation.w", "", "of the same"),
    ),
    TRUTH_GRID: (
        Filled("frame_id", "", "map"),
        Filled("pose.position.x", "m in the plane", "of the grid's south-west corner, east"),
        Filled("pose.position.y", "m in the plane", "of the grid's south-west corner, north"),
        Filled("pose.orientation.w", "", "1"),
        Filled("column_count", "", "cells in a row"),
        Filled("cell_size.x", "m in the plane", "width of a cell"),
        Filled("cell_size.y", "m in the plane", "height of a cell"),
        Filled("row_stride", "bytes", "of a row"),
        Filled("cell_stride", "bytes", "of a cell"),
        Filled("fields.name", "", "hazard (0 or 1), wind_speed_mps (whole m/s)"),
        Filled("fields.offset", "bytes", "of each in a cell"),
        Filled("fields.type", "", "UINT8"),
        Filled("data", "", "row by row from the south-west"),
    ),
    POSITION: (
        Filled("frame_id", "", "base_link"),
        Filled("latitude", "deg", "WGS84"),
        Filled("longitude", "deg", "WGS84"),
        Filled("altitude", "m", "above the ellipsoid"),
        Filled("heading", "rad", "of the nose, clockwise from north"),
        *(Filled(f"color.{name}", "", "of the mark on a map") for name in "rgba"),
    ),
    POSE: (
        Filled("frame_id", "", "map"),
        *_pose("pose.position", "pose.orientation", "the aircraft"),
    ),
    TRANSFORM: (
        Filled("parent_frame_id", "", "map"),
        Filled("child_frame_id", "", "base_link"),
        *_pose("translation", "rotation", "the aircraft"),
    ),
    EVENTS: (
        Filled("level", "", "INFO"),
        Filled("message", "", "what happened"),
        Filled("name", "", "galeway"),
    ),
}
