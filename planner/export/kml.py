"""KML 2.2: the route as a track in time (gx:Track), and places for start, waits and goals."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from planner.export.markup import add, angle, height, to_bytes
from planner.export.schedule import Stop, goal_places, stops, utc
from planner.plans import Plan

_NAMESPACES = {"xmlns": "http://www.opengis.net/kml/2.2", "xmlns:gx": "http://www.google.com/kml/ext/2.2"}


def to_kml(plan: Plan) -> bytes:
    """A document whose track moves with the time slider of a globe; a wait is one position at two times.

    Raises:
        BadPlanError: if the plan has no route that can be exported.
    """
    made = stops(plan)
    root = Element("kml", _NAMESPACES)
    document = add(root, "Document")
    add(document, "name", f"galeway: route to {plan.goal}")
    route = _placemark(document, f"Route to {plan.goal}", f"{plan.planner}, by {plan.objective}")
    track = add(route, "gx:Track")
    add(track, "altitudeMode", "absolute")
    for stop in made:
        for time_s in stop.times_s:
            add(track, "when", utc(plan, time_s))
    for stop in made:
        for _ in stop.times_s:
            add(track, "gx:coord", f"{angle(stop.lon_deg)} {angle(stop.lat_deg)} {height(stop)}")
    start = _placemark(document, "Start")
    add(add(start, "TimeStamp"), "when", utc(plan, made[0].arrive_s))
    _point(start, made[0])
    for stop in made:
        if stop.waiting_s > 0.0:
            loiter = _placemark(document, "Loiter", f"{stop.waiting_s:.0f} s")
            span = add(loiter, "TimeSpan")
            add(span, "begin", utc(plan, stop.arrive_s))
            add(span, "end", utc(plan, stop.leave_s))
            _point(loiter, stop)
    for goal, lat_deg, lon_deg, text in goal_places(plan):
        place = _placemark(document, goal.name, text)
        add(add(place, "Point"), "coordinates", f"{angle(lon_deg)},{angle(lat_deg)}")
    return to_bytes(root)


def _placemark(document: Element, name: str, description: str = "") -> Element:
    placemark = add(document, "Placemark")
    add(placemark, "name", name)
    if description:
        add(placemark, "description", description)
    return placemark


def _point(placemark: Element, stop: Stop) -> None:
    point = add(placemark, "Point")
    add(point, "altitudeMode", "absolute")
    add(point, "coordinates", f"{angle(stop.lon_deg)},{angle(stop.lat_deg)},{height(stop)}")
