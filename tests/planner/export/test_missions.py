"""Missions, read by pymavlink and by MAVSDK, and uploaded by MAVSDK to its own mission server."""

import dataclasses
import json
import math
import queue
import socket
from itertools import pairwise

import pyproj
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.export import export, mission
from planner.export.qgroundcontrol import to_qgroundcontrol
from planner.export.waypoints import to_waypoints

WGS84 = pyproj.Geod(ellps="WGS84")


@dataclasses.dataclass
class Flown:
    """What a vehicle makes of the items: stops, waits, and the speed commanded before each leg."""

    positions: list = dataclasses.field(default_factory=list)
    waits_s: list = dataclasses.field(default_factory=list)
    speeds_mps: list = dataclasses.field(default_factory=list)
    commands: int = 0

    @classmethod
    def of(cls, items):
        """From (command, parameters 1 to 7), angles in degrees."""
        flown, speed_mps = cls(), math.nan
        for command, parameters in items:
            if command == 178:
                assert (parameters[0], parameters[2]) == (1.0, -1.0)  # ground speed, throttle as it is
                speed_mps = parameters[1]
                flown.commands += 1
                continue
            assert command in (16, 19)
            flown.positions.append(parameters[4:])
            flown.waits_s.append(parameters[0] if command == 19 else 0.0)
            flown.speeds_mps.append(speed_mps)
        return flown


def true_speeds_mps(visits):
    return [
        WGS84.inv(before.lon_deg, before.lat_deg, after.lon_deg, after.lat_deg)[2]
        / (after.arrive_s - before.leave_s)
        for before, after in pairwise(visits)
    ]


def check(flown, visits, angle_tolerance_deg):
    for position, visit in zip(flown.positions, visits, strict=True):
        assert position[:2] == pytest.approx((visit.lat_deg, visit.lon_deg), abs=angle_tolerance_deg)
        assert position[2] == pytest.approx(visit.altitude_m)
    waits_s = [visit.leave_s - visit.arrive_s for visit in visits]
    assert flown.waits_s == pytest.approx(waits_s, rel=1e-6, abs=1e-6)
    for speed_mps, true_mps in zip(flown.speeds_mps[1:], true_speeds_mps(visits), strict=True):
        if true_mps > mission.SPEED_TOLERANCE_MPS + 1e-6:
            assert speed_mps == pytest.approx(true_mps, rel=1e-6, abs=mission.SPEED_TOLERANCE_MPS + 1e-3)


def qgc_items(text):
    document = json.loads(text)
    assert (document["fileType"], document["version"]) == ("Plan", 1)
    items = document["mission"]["items"]
    assert {item["type"] for item in items} == {"SimpleItem"}
    assert [item["doJumpId"] for item in items] == list(range(1, len(items) + 1))
    return [(item["command"], tuple(item["params"])) for item in items]


@settings(deadline=None)
@given(data=st.data())
def test_qgroundcontrol_positions_waits_and_speeds_come_back(journeys, data):
    plan, visits = data.draw(journeys)
    text = to_qgroundcontrol(plan)
    check(Flown.of(qgc_items(text)), visits, 1e-9)
    assert json.loads(text)["mission"]["plannedHomePosition"] == pytest.approx(visits[0][:3])


@pytest.fixture(scope="module")
def load_waypoints(tmp_path_factory):
    """Reads a file with pymavlink's loader."""
    mavwp = pytest.importorskip("pymavlink.mavwp", reason="the reader pymavlink is missing")
    path = tmp_path_factory.mktemp("missions") / "route.waypoints"

    def load(text):
        path.write_bytes(text)
        loader = mavwp.MAVWPLoader()
        assert loader.load(str(path)) == loader.count()
        return loader.wpoints

    return load


@settings(deadline=None)
@given(data=st.data())
def test_pymavlink_finds_positions_waits_and_speeds(journeys, load_waypoints, data):
    plan, visits = data.draw(journeys)
    home, *items = load_waypoints(to_waypoints(plan))
    assert [item.seq for item in items] == list(range(1, len(items) + 1))
    assert (home.command, home.x, home.y, home.z) == (16, *visits[0][:3])
    assert (home.current, {item.current for item in items}) == (1, {0})
    read = [
        (item.command, (item.param1, item.param2, item.param3, item.param4, item.x, item.y, item.z))
        for item in items
    ]
    check(Flown.of(read), visits, 1e-9)


def test_the_numbers_are_those_of_the_protocol(short_plan):
    mavlink = pytest.importorskip("pymavlink.dialects.v20.common", reason="the reader pymavlink is missing")
    assert mission.NAV_WAYPOINT == mavlink.MAV_CMD_NAV_WAYPOINT
    assert mission.NAV_LOITER_TIME == mavlink.MAV_CMD_NAV_LOITER_TIME
    assert mission.DO_CHANGE_SPEED == mavlink.MAV_CMD_DO_CHANGE_SPEED
    assert mission.FRAME_GLOBAL == mavlink.MAV_FRAME_GLOBAL
    assert mission.FRAME_MISSION == mavlink.MAV_FRAME_MISSION
    header = json.loads(to_qgroundcontrol(short_plan))["mission"]
    assert header["vehicleType"] == mavlink.MAV_TYPE_FIXED_WING
    assert header["firmwareType"] == mavlink.MAV_AUTOPILOT_GENERIC


def test_speeds_are_commanded_where_they_change_by_more_than_the_tolerance(make_plan):
    """North along a meridian at 30, 30.08, 30.16 (0.16 from the last command) and 30.2 m/s."""
    visits, lat_deg, now_s = [(0.0, 0.0, 500.0, 0.0, 0.0)], 0.0, 0.0
    for speed_mps in (30.0, 30.08, 30.16, 30.2):
        _, lat_deg, _ = WGS84.fwd(0.0, lat_deg, 0.0, speed_mps * 120.0)
        now_s += 120.0
        visits.append((lat_deg, 0.0, 500.0, now_s, now_s))
    items = qgc_items(to_qgroundcontrol(make_plan(visits)))
    assert [command for command, _ in items] == [16, 178, 16, 16, 178, 16, 16]
    assert [parameters[1] for command, parameters in items if command == 178] == [30.0, 30.16]


def test_a_climb_on_the_spot_commands_no_speed(make_plan):
    plan = make_plan(
        [(0.0, 0.0, 500.0, 0.0, 0.0), (0.0, 0.01, 500.0, 40.0, 40.0), (0.0, 0.01, 900.0, 99.0, 99.0)]
    )
    assert [command for command, _ in qgc_items(to_qgroundcontrol(plan))] == [16, 178, 16, 16]


def test_qgroundcontrol_shows_the_heights_as_absolute(short_plan):
    """2 is AltitudeModeAbsolute in QGroundControl's enumeration and goes with MAV_FRAME_GLOBAL, 0."""
    header = json.loads(to_qgroundcontrol(short_plan))["mission"]
    assert header["globalPlanAltitudeMode"] == 2
    for item in header["items"]:
        if item["command"] == 178:
            assert (item["frame"], "AltitudeMode" in item) == (2, False)
        else:
            assert (item["frame"], item["AltitudeMode"]) == (0, 2)
            assert item["Altitude"] == item["AMSLAltAboveTerrain"] == item["params"][6]


@pytest.fixture(scope="module")
def link():
    """A ground station and a vehicle, both MAVSDK, over loopback: (MissionRaw, missions that arrive)."""
    mavsdk = pytest.importorskip("mavsdk.mavsdk", reason="the reader mavsdk is missing")
    from mavsdk.component_type import ComponentType
    from mavsdk.plugins.mission_raw import MissionRaw
    from mavsdk.plugins.mission_raw_server import MissionRawServer

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    arrived = queue.Queue()
    kinds = (ComponentType.AUTOPILOT, ComponentType.GROUND_STATION)
    vehicle, station = (
        mavsdk.Mavsdk(mavsdk.Configuration.create_with_component_type(kind)) for kind in kinds
    )
    with vehicle, station:
        assert vehicle.add_any_connection(f"udpout://127.0.0.1:{port}").name == "SUCCESS"
        assert station.add_any_connection(f"udpin://127.0.0.1:{port}").name == "SUCCESS"
        server = MissionRawServer(vehicle.server_component())
        server.subscribe_incoming_mission(lambda result, plan, _: arrived.put((result, plan.mission_items)))
        system = station.first_autopilot(timeout_s=30.0)
        assert system is not None, "the two MAVSDK instances did not find each other over loopback"
        yield MissionRaw(system), arrived


def flown_by(items):
    return Flown.of(
        (
            item.command,
            (item.param1, item.param2, item.param3, item.param4, item.x / 1e7, item.y / 1e7, item.z),
        )
        for item in items
    )


def as_tuples(items):
    return [tuple(vars(item).values()) for item in items]


def test_mavsdk_imports_the_plan_and_uploads_it_to_its_mission_server(link, long_journey, tmp_path):
    station, arrived = link
    plan, visits = long_journey
    export(plan, tmp_path / "route.plan")
    imported = station.import_qgroundcontrol_mission(str(tmp_path / "route.plan"))
    assert not imported.geofence_items
    assert not imported.rally_items
    flown = flown_by(imported.mission_items)
    check(flown, visits, 1e-7)
    assert sum(wait_s > 0.0 for wait_s in flown.waits_s) == 8
    assert 100 < flown.commands < 400
    station.upload_mission(imported.mission_items)
    result, received = arrived.get(timeout=30.0)
    assert result.name == "SUCCESS"
    assert as_tuples(received) == as_tuples(imported.mission_items)


def test_mavsdk_finds_the_same_mission_in_both_formats(link, long_journey, tmp_path):
    station, _ = link
    plan, _ = long_journey
    for suffix in ("plan", "waypoints"):
        export(plan, tmp_path / f"route.{suffix}")
    from_plan = station.import_qgroundcontrol_mission(str(tmp_path / "route.plan")).mission_items
    home, *from_text = station.import_mission_planner_mission(str(tmp_path / "route.waypoints")).mission_items
    assert (home.command, home.x, home.y) == (16, from_plan[0].x, from_plan[0].y)
    for item in (*from_text, *from_plan):
        item.seq = item.current = 0  # they count from home in one file and not in the other
    assert as_tuples(from_text) == as_tuples(from_plan)
