"""The plain-text mission format "QGC WPL 110", which every MAVLink ground station reads."""

from __future__ import annotations

from planner.export.mission import FRAME_GLOBAL, NAV_WAYPOINT, Item, mission_items
from planner.export.schedule import stops
from planner.plans import Plan


def to_waypoints(plan: Plan) -> bytes:
    """One line an item, tabs between its twelve fields; line 0 is home, the start of the route.

    Readers of version 110 take line 0 for the home position, so the start comes twice: as home, and as the
    mission's first item.

    Raises:
        BadPlanError: if the plan has no route that can be exported.
    """
    route = stops(plan)
    home = Item(NAV_WAYPOINT, FRAME_GLOBAL, (0.0, 0.0, 0.0, 0.0, *route[0].position))
    lines = [_line(number, item) for number, item in enumerate((home, *mission_items(route)))]
    return "\n".join(("QGC WPL 110", *lines, "")).encode("ascii")


def _line(number: int, item: Item) -> str:
    numbers = "\t".join(f"{value:.9f}" for value in item.parameters)
    current = 1 if number == 0 else 0
    return f"{number}\t{current}\t{item.frame}\t{item.command}\t{numbers}\t1"
