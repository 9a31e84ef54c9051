"""The messages that are written before take-off, once a stage and at the end, as protobuf bytes."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import Any

import numpy as np

from aircraft.reference import Reference
from planner.grid import Grid, LocalFrame
from planner.plans import Plan
from recordings.protobuf_types import message_type
from recordings.recorder import FlightHeader, PlanIssue, WeatherSheet
from recordings.schema import (
    EVENTS,
    MAP_FRAME,
    OUTCOME,
    PLAN,
    PLAN_ISSUE,
    PLAN_PATH,
    REFERENCE,
    SCHEMA_VERSION,
    TRUTH_GRID,
    TRUTH_HAZARD,
    Topic,
)
from recordings.wind_field import thinned


def new(topic: Topic, **content: Any) -> Any:
    """A message of a topic's type."""
    return message_type(topic.message)(**content)


def timestamp(log_time: int) -> dict[str, int]:
    """A google.protobuf.Timestamp of Unix nanoseconds."""
    return {"seconds": log_time // 1_000_000_000, "nanos": log_time % 1_000_000_000}


def serialised(message: Any) -> bytes:
    """The bytes of a message, the same for the same content."""
    content: bytes = message.SerializeToString(deterministic=True)
    return content


def header_metadata(header: FlightHeader) -> dict[str, str]:
    """What is known before take-off and is neither plan, reference nor scenario text; numbers exact."""
    grid = header.grid
    numbers = {
        "threshold_mps": header.threshold_mps,
        "stage_s": header.stage_s,
        "airspeed_min_mps": header.airspeed_min_mps,
        "airspeed_max_mps": header.airspeed_max_mps,
        "grid_south_rad": grid.south_rad,
        "grid_west_rad": grid.west_rad,
        "grid_north_step_rad": grid.north_step_rad,
        "grid_east_step_rad": grid.east_step_rad,
    }
    return {
        "schema": str(SCHEMA_VERSION),
        "scenario": header.scenario,
        "seed": str(header.seed),
        "limits": json.dumps(header.limits),
        "also": json.dumps(header.also),
        "grid_rows": str(grid.rows),
        "grid_columns": str(grid.columns),
    } | {name: repr(float(number)) for name, number in numbers.items()}


def reference_message(reference: Reference, frame: LocalFrame, issued_s: float) -> bytes:
    """The arrays of the reference, the origin of the plane they lie in, and since when it is followed."""
    arrays = {field.name: getattr(reference, field.name).tolist() for field in fields(reference)}
    return serialised(
        new(
            REFERENCE,
            origin_lat_rad=frame.origin_lat_rad,
            origin_lon_rad=frame.origin_lon_rad,
            issued_s=issued_s,
            **arrays,
        )
    )


def plan_message(plan: Plan) -> bytes:
    """The route as a line and the goals as points (RFC 7946)."""
    route = [[point.lon_deg, point.lat_deg, point.altitude_m] for point in plan.waypoints]
    features = [
        _feature("Point", [goal.lon_deg, goal.lat_deg], name=goal.name, reachable=goal.reachable)
        for goal in plan.goals
    ]
    if len(route) > 1:
        features.insert(0, _feature("LineString", route, name=f"route to {plan.goal}"))
    text = json.dumps({"type": "FeatureCollection", "features": features})
    return serialised(new(PLAN, geojson=text))


def _feature(kind: str, coordinates: list[Any], **properties: Any) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def plan_issue_message(issue: PlanIssue) -> bytes:
    """What a forecast did to the plan."""
    plan = issue.plan.to_json() if issue.changed else b""
    return serialised(new(PLAN_ISSUE, issued_s=issue.time_s, reason=issue.reason, plan=plan))


def plan_path_message(plan: Plan, frame: LocalFrame, log_time: int) -> bytes:
    """The waypoints in the plane, each turned to the next one: x along the leg that begins there."""
    message = new(PLAN_PATH, timestamp=timestamp(log_time), frame_id=MAP_FRAME)
    places = [
        frame.to_plane(math.radians(point.lat_deg), math.radians(point.lon_deg)) for point in plan.waypoints
    ]
    turn_rad = 0.0
    for here, (north_m, east_m) in enumerate(places):
        if places[here + 1 :] and places[here + 1] != places[here]:
            next_north_m, next_east_m = places[here + 1]
            turn_rad = math.atan2(next_north_m - north_m, next_east_m - east_m)
        pose = message.poses.add()
        pose.position.x, pose.position.y = east_m, north_m
        pose.position.z = plan.waypoints[here].altitude_m
        pose.orientation.z, pose.orientation.w = math.sin(turn_rad / 2.0), math.cos(turn_rad / 2.0)
    return serialised(message)


def hazard_message(sheet: WeatherSheet, grid: Grid, threshold_mps: float) -> bytes:
    """The hazardous cells, a bit each, with the grid they lie on; and the wind on some of them."""
    wind = thinned(sheet.wind_north_mps, sheet.wind_east_mps)
    return serialised(
        new(
            TRUTH_HAZARD,
            time_s=sheet.time_s,
            stage=sheet.stage,
            threshold_mps=threshold_mps,
            south_rad=grid.south_rad,
            west_rad=grid.west_rad,
            north_step_rad=grid.north_step_rad,
            east_step_rad=grid.east_step_rad,
            rows=grid.rows,
            columns=grid.columns,
            cells=np.packbits(sheet.hazard).tobytes(),
            wind_every=wind.every,
            wind=wind.content,
            closed=b"" if sheet.closed is None else np.packbits(sheet.closed).tobytes(),
            altitude_m=sheet.altitude_m,
        )
    )


def weather_grid_message(sheet: WeatherSheet, grid: Grid, log_time: int) -> bytes:
    """Hazard (0 or 1) and wind speed (whole m/s) on square cells of the plane, nearest cell each.

    The rows of the flight's grid are unequally high on the Mercator plane, so they are sampled anew, to lie
    right under the path. Cells are as wide as the flight's.
    """
    frame = grid.frame
    south_m, west_m = frame.to_plane(grid.lat_rad[0], grid.lon_rad[0])
    north_m, east_m = frame.to_plane(grid.lat_rad[-1], grid.lon_rad[-1])
    cell_m = (east_m - west_m) / (grid.columns - 1) if grid.columns > 1 else max(north_m - south_m, 1.0)
    centres_m = south_m + cell_m * np.arange(math.floor((north_m - south_m) / cell_m + 1e-9) + 1)
    lat_rad, _ = frame.to_geodetic(centres_m, np.zeros_like(centres_m))
    row, _ = grid.indices(lat_rad, grid.west_rad)
    rows = np.clip(np.rint(row).astype(int), 0, grid.rows - 1)
    speed_mps = np.hypot(sheet.wind_north_mps[rows], sheet.wind_east_mps[rows])
    cells = np.stack([sheet.hazard[rows], np.clip(np.rint(speed_mps), 0, 255)], axis=-1).astype(np.uint8)
    message = new(
        TRUTH_GRID,
        timestamp=timestamp(log_time),
        frame_id=MAP_FRAME,
        column_count=grid.columns,
        row_stride=2 * grid.columns,
        cell_stride=2,
        data=cells.tobytes(),
    )
    message.pose.position.x, message.pose.position.y = west_m - cell_m / 2, south_m - cell_m / 2
    message.pose.orientation.w = 1.0
    message.cell_size.x = message.cell_size.y = cell_m
    for offset, name in enumerate(("hazard", "wind_speed_mps")):
        message.fields.add(name=name, offset=offset, type="UINT8")
    return serialised(message)


def event_message(log_time: int, text: str) -> bytes:
    """A line of the log."""
    return serialised(new(EVENTS, timestamp=timestamp(log_time), level="INFO", message=text, name="galeway"))


def outcome_message(time_s: float, outcome: str, detail: str) -> bytes:
    """How the flight ended."""
    return serialised(new(OUTCOME, time_s=time_s, outcome=outcome, detail=detail))
