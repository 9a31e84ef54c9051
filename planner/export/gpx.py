"""GPX 1.1: the route with a time at each point, and the goals as waypoints."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from planner.export.markup import add, angle, height, to_bytes
from planner.export.schedule import goal_places, stops, utc
from planner.plans import Plan


def to_gpx(plan: Plan) -> bytes:
    """A route (`rte`), since a track is what was flown; a wait is one position at two times.

    Raises:
        BadPlanError: if the plan has no route that can be exported.
    """
    root = Element("gpx", version="1.1", creator="galeway", xmlns="http://www.topografix.com/GPX/1/1")
    for goal, lat_deg, lon_deg, text in goal_places(plan):
        place = add(root, "wpt", lat=angle(lat_deg), lon=angle(lon_deg))
        add(place, "name", goal.name)
        add(place, "desc", text)
    route = add(root, "rte")
    add(route, "name", f"Route to {plan.goal}")
    add(route, "desc", f"{plan.planner}, by {plan.objective}")
    for stop in stops(plan):
        for time_s in stop.times_s:
            point = add(route, "rtept", lat=angle(stop.lat_deg), lon=angle(stop.lon_deg))
            add(point, "ele", height(stop))
            add(point, "time", utc(plan, time_s))
            if stop.waiting_s > 0.0:
                add(point, "desc", f"loiter for {stop.waiting_s:.0f} s")
    return to_bytes(root)
