"""GeoJSON (RFC 7946): the route as a line with times, and points for start, waits and goals."""

from __future__ import annotations

from typing import Any

import msgspec

from planner.export.antimeridian import Fix, cut
from planner.export.schedule import Stop, goal_places, stops, utc
from planner.plans import Plan


def to_geojson(plan: Plan) -> bytes:
    """A FeatureCollection; every feature has a `role`: route, start, loiter or goal.

    The route is a LineString, or a MultiLineString cut at the antimeridian; its property `coordTimes` holds
    the time of each position, nested like the coordinates. A wait is one position twice.

    Raises:
        BadPlanError: if the plan has no route that can be exported.
    """
    made = stops(plan)
    features = [_route(plan, made), _point(made[0], {"role": "start", "time": utc(plan, made[0].arrive_s)})]
    features.extend(
        _point(
            stop,
            {
                "role": "loiter",
                "from": utc(plan, stop.arrive_s),
                "until": utc(plan, stop.leave_s),
                "waiting_s": stop.waiting_s,
            },
        )
        for stop in made
        if stop.waiting_s > 0.0
    )
    for goal, lat_deg, lon_deg, _ in goal_places(plan):
        outcome = msgspec.to_builtins(goal)
        for name in ("lat_deg", "lon_deg"):
            del outcome[name]
        geometry = {"type": "Point", "coordinates": [lon_deg, lat_deg]}
        features.append(_feature(geometry, {"role": "goal", "chosen": goal.name == plan.goal, **outcome}))
    collection = {"type": "FeatureCollection", "features": features}
    return msgspec.json.format(msgspec.json.encode(collection), indent=1) + b"\n"


def _route(plan: Plan, made: tuple[Stop, ...]) -> dict[str, Any]:
    line = [
        Fix(stop.lon_deg, stop.lat_deg, stop.altitude_m, time_s) for stop in made for time_s in stop.times_s
    ]
    if len(line) == 1:
        line *= 2  # a LineString has at least two positions
    parts = cut(line)
    coordinates = [[_rounded(fix) for fix in part] for part in parts]
    times = [[utc(plan, fix.time_s) for fix in part] for part in parts]
    whole = len(parts) == 1
    return _feature(
        {
            "type": "LineString" if whole else "MultiLineString",
            "coordinates": coordinates[0] if whole else coordinates,
        },
        {
            "role": "route",
            "goal": plan.goal,
            "planner": plan.planner,
            "objective": plan.objective,
            "coordTimes": times[0] if whole else times,
        },
    )


def _rounded(fix: Fix) -> list[float]:
    return [fix.lon_deg, round(fix.lat_deg, 9), round(fix.altitude_m, 3)]


def _point(stop: Stop, properties: dict[str, Any]) -> dict[str, Any]:
    geometry = {"type": "Point", "coordinates": [stop.lon_deg, stop.lat_deg, stop.altitude_m]}
    return _feature(geometry, properties)


def _feature(geometry: dict[str, Any], properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}
