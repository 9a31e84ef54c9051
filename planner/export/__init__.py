"""Plans for other programs: maps, ground stations and autopilots.

Heights go out as the plan has them, above the ellipsoid. GeoJSON asks for just that; KML, GPX and MAVLink
call the same number a height above mean sea level. The two differ by the geoid's height, at most 107 m and
about -25 m off Florida: shift the mission where that matters.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from planner.errors import PlannerError
from planner.export.geojson import to_geojson
from planner.export.gpx import to_gpx
from planner.export.kml import to_kml
from planner.export.qgroundcontrol import to_qgroundcontrol
from planner.export.waypoints import to_waypoints
from planner.plans import Plan

FORMATS: dict[str, Callable[[Plan], bytes]] = {
    ".geojson": to_geojson,
    ".kml": to_kml,
    ".gpx": to_gpx,
    ".plan": to_qgroundcontrol,
    ".waypoints": to_waypoints,
}


def export(plan: Plan, path: Path) -> None:
    """Write a plan in the format that the file's suffix names, whole or not at all.

    Args:
        plan: a plan with a route; two waypoints in a row at one position are a wait.
        path: ends in one of `FORMATS`; capital letters do not matter.

    Raises:
        PlannerError: if the suffix is unknown or the file cannot be written.
        BadPlanError: if the plan has no route, or a route that no vehicle could follow.
    """
    encode = FORMATS.get(path.suffix.lower())
    if encode is None:
        raise PlannerError(
            f"cannot export to {path.name!r}: the suffix {path.suffix!r} is not known; "
            f"use one of {', '.join(FORMATS)}"
        )
    content = encode(plan)
    partial = path.with_suffix(f".partial{path.suffix}")
    try:
        partial.write_bytes(content)
        partial.replace(path)
    except OSError as error:
        with suppress(OSError):
            partial.unlink()
        raise PlannerError(
            f"cannot write the route to {path}: {error.strerror}; name a file in a folder that exists and "
            "can be written to"
        ) from error
