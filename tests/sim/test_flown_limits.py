"""A flight of JSBSim passes its limits; then one thing in its recording is wrong, and one limit fails."""

import math
from dataclasses import replace

import numpy as np
import pytest

from recordings.limits import judge, parse_limits
from recordings.mcap_reader import read
from recordings.recorder import Layer, Outcome
from recordings.recording import Event
from recordings.tracking import track

LIMITS = (
    "cross_track_m within 5",
    "cross_track_m.p95 <= 2",
    'altitude_error_m within 10 except during "takeoff"',
    "altitude_error_m.p95 <= 3",
    "time_error_s within 5",
    "waypoint_time_error_s.p95 <= 5",
    "waypoints_missed == 0",
    "airspeed_mps always >= 15",
    'bank_deg within 60 during "turn"',
    "throttle within 0 to 1",
    "fuel_kg.min > 1",
    "hazard_exposure_s == 0",
    "never crashed",
    "never fuel_out",
    'never "engine"',
    '"departure" before 0:01',
    "arrived before 0:19",
    'outcome != "left_weather"',
)
EARTH_RADIUS_M = 6.37e6


@pytest.fixture(scope="module")
def recording(flown):
    return read(flown[1] / "flight.mcap")


def failed(recording, limits=LIMITS):
    return {
        str(verdict.limit) for verdict in judge(track(recording), parse_limits(limits)) if not verdict.passed
    }


def states(recording, from_s, to_s, **changes):
    """With columns of the state changed between two times: name to what is added."""
    state = recording.state.copy()
    here = (state["time_s"] >= from_s) & (state["time_s"] < to_s)
    for name, added in changes.items():
        state[name][here] += added
    return replace(recording, state=state)


def beside(recording, from_s, to_s, right_m):
    """With the positions between two times moved to the right of the course."""
    state = recording.state
    course_rad = np.arctan2(state["east_mps"], state["north_mps"])
    here = (state["time_s"] >= from_s) & (state["time_s"] < to_s)
    off_rad = here * right_m / EARTH_RADIUS_M
    moved = state.copy()
    moved["lat_rad"] -= off_rad * np.sin(course_rad)
    moved["lon_rad"] += off_rad * np.cos(course_rad) / np.cos(state["lat_rad"])
    return replace(recording, state=moved)


def behind(recording, late_s, from_s, to_s):
    """With everything but the clock as it was some time ago, between two times."""
    state, time_s = recording.state.copy(), recording.state["time_s"]
    rows = np.flatnonzero((time_s >= from_s) & (time_s < to_s))
    for name in state.dtype.names:
        if name != "time_s":
            state[name][rows] = recording.state[name][rows - round(late_s * 10)]
    return replace(recording, state=state)


def hazardous(recording):
    """With every cell hazardous; the wind stays what it was."""
    sheets = [
        replace(sheet, hazard=np.ones_like(sheet.hazard)) if sheet.layer == Layer.TRUTH else sheet
        for sheet in recording.hazards
    ]
    return replace(recording, hazards=tuple(sheets))


WRONG = {
    "sideways for a second": (lambda log: beside(log, 300.0, 301.0, 8.0), {"cross_track_m within 5"}),
    "a little sideways for minutes": (lambda log: beside(log, 300.0, 420.0, 4.0), {"cross_track_m.p95 <= 2"}),
    "up for a second": (
        lambda log: states(log, 300.0, 301.0, altitude_m=12.0),
        {'altitude_error_m within 10 except during "takeoff"'},
    ),
    "a little low for minutes": (
        lambda log: states(log, 300.0, 420.0, altitude_m=-5.0),
        {"altitude_error_m.p95 <= 3"},
    ),
    "behind for a second": (lambda log: behind(log, 8.0, 300.0, 301.0), {"time_error_s within 5"}),
    "behind": (
        lambda log: behind(log, 8.0, 0.0, 2000.0),
        {
            "time_error_s within 5",
            "waypoint_time_error_s.p95 <= 5",
            "waypoints_missed == 0",
            "arrived before 0:19",
        },
    ),
    "slow": (lambda log: states(log, 300.0, 300.1, airspeed_mps=-20.0), {"airspeed_mps always >= 15"}),
    "rolled over in a turn": (
        lambda log: states(log, 100.0, 1000.0, roll_rad=math.radians(70.0)),
        {'bank_deg within 60 during "turn"'},
    ),
    "over full throttle": (lambda log: states(log, 300.0, 301.0, throttle=1.0), {"throttle within 0 to 1"}),
    "without fuel": (lambda log: states(log, 900.0, 901.0, fuel_kg=-4.5), {"fuel_kg.min > 1"}),
    "in a gale": (lambda log: states(log, 300.0, 300.1, wind_north_mps=30.0), {"hazard_exposure_s == 0"}),
    "on the ground": (
        lambda log: states(log, 300.0, 300.1, height_above_ground_m=-1100.0),
        {"never crashed"},
    ),
    "crashed": (lambda log: replace(log, outcome=Outcome.CRASHED), {"never crashed"}),
    "out of fuel": (lambda log: replace(log, outcome=Outcome.FUEL_OUT), {"never fuel_out"}),
    "out of the weather": (
        lambda log: replace(log, outcome=Outcome.LEFT_WEATHER),
        {'outcome != "left_weather"'},
    ),
    "engine": (
        lambda log: replace(log, events=(*log.events, Event(500.0, "fault: the engine is stopped"))),
        {'never "engine"'},
    ),
    "silent": (lambda log: replace(log, events=()), {'"departure" before 0:01'}),
}


def test_the_flight_passes(recording):
    assert failed(recording) == set()


@pytest.mark.parametrize("what", WRONG)
def test_one_thing_wrong_fails_its_limit_and_no_other(recording, what):
    corrupt, limits = WRONG[what]
    assert failed(corrupt(recording)) == limits


def test_every_limit_is_broken_by_something():
    assert set.union(*(limits for _, limits in WRONG.values())) == set(LIMITS)


def test_a_hazard_under_the_path_is_no_clearance(recording):
    far = ("clearance_m always >= 1000", "min_clearance_m >= 1000")
    sheets = [replace(sheet, hazard=np.zeros_like(sheet.hazard)) for sheet in recording.hazards]
    for sheet in sheets:
        sheet.hazard[0, 0] = True
    clear = replace(recording, hazards=tuple(sheets))
    assert failed(clear, far) == set()
    assert failed(hazardous(recording), far) == set(far)
