"""QGroundControl's `.plan`: the mission as JSON."""

from __future__ import annotations

from typing import Any

import msgspec

from planner.export.mission import DO_CHANGE_SPEED, Item, mission_items
from planner.export.schedule import stops
from planner.plans import Plan

_ANY_AUTOPILOT = 0  # MAV_AUTOPILOT_GENERIC
_FIXED_WING = 1  # MAV_TYPE_FIXED_WING
_ABSOLUTE_ALTITUDE = 2  # QGroundControl's AltitudeModeAbsolute, which goes with MAV_FRAME_GLOBAL


def to_qgroundcontrol(plan: Plan) -> bytes:
    """A plan file, version 1, whose planned home is the start; it neither takes off nor lands.

    Raises:
        BadPlanError: if the plan has no route that can be exported.
    """
    route = stops(plan)
    items = list(mission_items(route))
    speeds_mps = [item.parameters[1] for item in items if item.command == DO_CHANGE_SPEED]
    mission = {
        "version": 2,
        "firmwareType": _ANY_AUTOPILOT,
        "vehicleType": _FIXED_WING,
        "globalPlanAltitudeMode": _ABSOLUTE_ALTITUDE,
        "plannedHomePosition": route[0].position,
        "items": [_simple_item(number, item) for number, item in enumerate(items, start=1)],
        **({"cruiseSpeed": speeds_mps[0]} if speeds_mps else {}),
    }
    document = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "galeway",
        "mission": mission,
        "geoFence": {"version": 2, "circles": [], "polygons": []},
        "rallyPoints": {"version": 2, "points": []},
    }
    return msgspec.json.format(msgspec.json.encode(document), indent=1) + b"\n"


def _simple_item(number: int, item: Item) -> dict[str, Any]:
    simple = {
        "type": "SimpleItem",
        "command": item.command,
        "frame": item.frame,
        "params": item.parameters,
        "autoContinue": True,
        "doJumpId": number,
    }
    if item.command == DO_CHANGE_SPEED:
        return simple
    altitude_m = item.parameters[6]
    return {
        **simple,
        "Altitude": altitude_m,
        "AltitudeMode": _ABSOLUTE_ALTITUDE,
        "AMSLAltAboveTerrain": altitude_m,
    }
