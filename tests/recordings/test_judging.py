"""Limits on moments, events and parts of a flight: corrupt one thing, and that very limit fails."""

from dataclasses import replace

import numpy as np
import pytest

from aircraft.path import Phase
from recordings.figures import Moment
from recordings.limits import judge, parse_limits
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.quantities import QUANTITIES
from recordings.recorder import Outcome
from recordings.recording import Event
from recordings.tracking import track
from recordings.verdicts import Break

TIGHT = (
    "cross_track_m within 0.01",
    "altitude_error_m within 0.01",
    "time_error_s within 0.01",
    "waypoint_time_error_s within 0.01",
    "corner_cut_m always <= 100",
    "clearance_m always >= 50000",
    "airspeed_mps within 26.9 to 29.1",
    "ground_speed_mps within 24.9 to 25.1",
    "climb_mps within 0.3",
    "altitude_m within 999.9 to 1000.1",
    "height_above_ground_m always >= 900",
    "wind_mps always < 6.1",
    "gust_mps always <= 1",
    "bank_deg within 6",
    "pitch_deg within 3",
    "angle_of_attack_deg within 0 to 5",
    "sideslip_deg always >= -1",
    "throttle within 0.5 to 0.7",
    "fuel_kg always > 3.9",
    "position_estimate_error_m within 1.6",
    "wind_estimate_error_mps within 0.6",
    "hazard_exposure_s == 0 from 0:03 to 0:05",
    "cross_track_m.p95 <= 0.01 from 0:03 to 0:05",
    'altitude_error_m.max <= 0.01 during "turn"',
    'altitude_error_m within 0.02 except during "turn"',
    "arrived before 0:08:01",
    "arrived before 2022-09-29T00:08:01Z",
    "never crashed",
    "never fuel_out",
    'never "engine"',
    '"a minute" before 0:01',
    '"a minute" after 0:01',
)
ALTITUDE = {"altitude_error_m within 0.01", "altitude_m within 999.9 to 1000.1"}


@pytest.fixture(scope="module")
def clean(kept):
    return kept.fly(kept.header(kept.corners))


@pytest.fixture
def failed(workshop):
    """The limits that a flight breaks: (flight or recording, limits) -> verdicts by limit."""

    def failed(flight, limits=TIGHT):
        recording = flight if hasattr(flight, "complete") else workshop.recording(flight)
        verdicts = judge(track(recording), parse_limits(limits))
        assert [str(verdict.limit) for verdict in verdicts] == list(limits)
        return {str(verdict.limit): verdict for verdict in verdicts if not verdict.passed}

    return failed


def changed(flight, from_s, to_s, **fields):
    """Fields of the samples between two times changed."""
    states = [
        state._replace(**fields) if from_s - 0.01 <= state.time_s <= to_s + 0.01 else state
        for state in flight.states
    ]
    return replace(flight, states=states)


def test_a_clean_flight_passes(clean, failed):
    assert list(map(str, failed(clean).values())) == []


def test_every_quantity_has_a_limit_in_this_test():
    assert {limit.name for limit in parse_limits(TIGHT) if hasattr(limit, "name")} >= set(QUANTITIES)


@pytest.mark.parametrize(
    ("fields", "limits"),
    [
        ({"airspeed_mps": 29.2}, {"airspeed_mps within 26.9 to 29.1"}),
        ({"airspeed_mps": 26.8}, {"airspeed_mps within 26.9 to 29.1"}),
        ({"north_mps": 25.2, "east_mps": 0.0}, {"ground_speed_mps within 24.9 to 25.1"}),
        ({"down_mps": 0.4}, {"climb_mps within 0.3"}),
        ({"altitude_m": 1000.2}, {*ALTITUDE, 'altitude_error_m within 0.02 except during "turn"'}),
        ({"altitude_m": 1000.015}, {"altitude_error_m within 0.01"}),
        ({"height_above_ground_m": 899.0}, {"height_above_ground_m always >= 900"}),
        ({"height_above_ground_m": 0.5}, {"height_above_ground_m always >= 900", "never crashed"}),
        ({"wind_north_mps": 0.0, "wind_east_mps": 6.2}, {"wind_mps always < 6.1"}),
        ({"gust_down_mps": -1.0}, {"gust_mps always <= 1"}),
        ({"roll_rad": -0.11}, {"bank_deg within 6"}),
        ({"pitch_rad": 0.06}, {"pitch_deg within 3"}),
        ({"angle_of_attack_rad": -0.01}, {"angle_of_attack_deg within 0 to 5"}),
        ({"sideslip_rad": -0.02}, {"sideslip_deg always >= -1"}),
        ({"throttle": 0.75}, {"throttle within 0.5 to 0.7"}),
        ({"fuel_kg": 3.8}, {"fuel_kg always > 3.9"}),
    ],
)
def test_one_field_wrong_on_a_leg_breaks_its_limits_and_no_others(clean, failed, fields, limits):
    verdicts = failed(
        changed(replace(clean, seen=[]), 50.0, 60.0, **fields),
        [limit for limit in TIGHT if "estimate" not in limit],
    )
    assert set(verdicts) == limits
    for limit, verdict in verdicts.items():
        if "never" not in limit:
            assert verdict.longest == Break(50.0, pytest.approx(60.1))
            assert verdict.broken_s == pytest.approx(10.1)
            assert verdict.margin < 0.0
            assert 50.0 <= verdict.worst.time_s <= 60.0


def test_more_that_can_go_wrong_breaks_its_limits_and_no_others(workshop, clean, failed):
    header = clean.header
    in_turn_s = turn_s(clean)
    late = {"time_error_s within 0.01", "waypoint_time_error_s within 0.01"}
    flights = {
        "crashed": (replace(clean, outcome=Outcome.CRASHED), {"never crashed"}),
        "fuel": (replace(clean, outcome=Outcome.FUEL_OUT), {"never fuel_out"}),
        "aside": (
            aside(workshop, clean, 200.0, 204.0),
            {"cross_track_m within 0.01"},
        ),
        "aside for longer": (
            aside(workshop, clean, 200.0, 210.0),
            {"cross_track_m within 0.01", "cross_track_m.p95 <= 0.01 from 0:03 to 0:05"},
        ),
        "late": (
            workshop.fly(header, late_s=0.5),
            late,
        ),
        "too late": (
            workshop.fly(header, late_s=2.0),
            late | {"arrived before 0:08:01", "arrived before 2022-09-29T00:08:01Z"},
        ),
        "high in a turn": (
            changed(clean, in_turn_s, in_turn_s, altitude_m=1000.015),
            {"altitude_error_m within 0.01", 'altitude_error_m.max <= 0.01 during "turn"'},
        ),
        "gale": (
            workshop.fly(header, wind_mps=lambda time_s: 15.1 if time_s == 200.0 else 6.0),
            {"wind_mps always < 6.1", "hazard_exposure_s == 0 from 0:03 to 0:05"},
        ),
        "gale elsewhere": (
            workshop.fly(header, wind_mps=lambda time_s: 15.1 if time_s == 100.0 else 6.0),
            {"wind_mps always < 6.1"},
        ),
        "hazard": (
            workshop.fly(header, sheets=workshop.sheets(np.ones(workshop.grid.shape, bool))),
            {"clearance_m always >= 50000"},
        ),
        "lost": (
            replace(clean, seen=[seen._replace(lat_rad=seen.lat_rad + 1e-6) for seen in clean.seen]),
            {"position_estimate_error_m within 1.6"},
        ),
        "misled": (
            replace(clean, seen=[seen._replace(wind_east_mps=0.0) for seen in clean.seen]),
            {"wind_estimate_error_mps within 0.6"},
        ),
    }
    for what, (flight, limits) in flights.items():
        assert set(failed(flight)) == limits, what


def turn_s(flight):
    """A time in the middle of the first turn, on a sample."""
    reference = flight.header.reference
    turn = int(np.flatnonzero(reference.phase == Phase.TURN)[0])
    return round(float(reference.start_time_s[turn] + reference.end_time_s[turn]) / 2.0, 1)


def aside(workshop, flight, from_s, to_s, right_m=1.0):
    """With the positions between two times moved to the right, and the aircraft aware of it."""
    other = workshop.fly(flight.header, right_m=right_m)
    pairs = [zip(flight.states, other.states, strict=True), zip(flight.seen, other.seen, strict=True)]
    states, seen = (
        [moved if from_s - 0.01 <= state.time_s <= to_s + 0.01 else state for state, moved in rows]
        for rows in pairs
    )
    return replace(flight, states=states, seen=seen)


def test_events_break_their_limits(workshop, clean, failed):
    recording = workshop.recording(clean)
    happened = replace(recording, events=(*recording.events, Event(70.0, "fault: the Engine is stopped")))
    verdicts = failed(happened)
    assert list(verdicts) == ['never "engine"']
    assert str(verdicts['never "engine"']).startswith(
        'FAIL never "engine": 1, worst 1 ×, first at 00:01:10, 30.00 N 89.48 W'
    )
    early = replace(recording, events=(Event(59.0, "a minute"),))
    assert list(failed(early)) == ['"a minute" after 0:01']
    late = replace(recording, events=(Event(61.0, "a minute"),))
    assert list(failed(late)) == ['"a minute" before 0:01']
    silent = failed(replace(recording, events=()))
    assert {verdict.reason for verdict in silent.values()} == {"it never happened"}
    assert list(silent) == ['"a minute" before 0:01', '"a minute" after 0:01']
    before = replace(recording, events=(*recording.events, Event(-20.0, "no engine yet")))
    assert list(failed(before)) == ['never "engine"']
    assert failed(before, ['never "engine" during "leg"', 'never "engine" from 0:00']) == {}


def test_who_does_not_arrive_is_not_in_time(workshop, clean, failed):
    short = workshop.fly(clean.header, until_s=300.0)
    assert {
        "arrived before 0:08:01",
        "arrived before 2022-09-29T00:08:01Z",
        "waypoint_time_error_s within 0.01",
    } == set(failed(short))


def test_what_an_incomplete_recording_does_not_say_did_not_pass(workshop, clean, failed):
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    clean.record(recorder, finish=False)
    recorder.abandon()
    verdicts = failed(
        read(recorder.partial_path), ["never crashed", 'never "engine"', "airspeed_mps always > 1"]
    )
    assert list(verdicts) == ["never crashed", 'never "engine"']
    assert "incomplete" in str(verdicts["never crashed"])


@pytest.mark.parametrize(
    "limit",
    [
        'cross_track_m.p95 <= 100 during "loiter"',
        'cross_track_m within 100 during "takeoff"',
        "airspeed_mps always > 0 from 1:00 to 2:00",
        "airspeed_mps always > 0 until 2022-09-28T00:00Z",
        'airspeed_mps always > 0 during "turn" except during "turn"',
        'hazard_exposure_s == 0 during "loiter"',
        'never "engine" during "loiter"',
        "never crashed from 1:00",
        'waypoint_time_error_s.max <= 100 during "loiter"',
    ],
)
def test_a_limit_on_a_part_that_was_not_flown_fails(clean, failed, limit):
    (verdict,) = failed(clean, [limit]).values()
    assert verdict.reason.startswith("no moment of the flight is ")


def test_parts_of_a_flight_are_judged_alone(workshop, clean, failed):
    flight = aside(workshop, clean, 200.0, 210.0, right_m=-3.0)
    passing = (
        "cross_track_m.max <= 0.01 until 0:03:19",
        "cross_track_m.max <= 0.01 from 0:03:31",
        "cross_track_m.max <= 0.01 except from 0:03:20 to 0:03:30",
        "cross_track_m.max >= 2.99 from 0:03:20 to 0:03:30",
        "cross_track_m.min >= 2.99 from 2022-09-29T00:03:20Z to 2022-09-29T00:03:30Z",
        'cross_track_m within 0.01 during "turn"',
        'cross_track_m within 0.01 except during "leg" or "loiter"',
        "cross_track_m within 0.01 except from 0:03:20 to 0:03:30",
        "cross_track_m always <= 0.01",
    )
    failing = (
        "cross_track_m always >= -2.9",
        "cross_track_m within 2 from 0:03:25",
        'cross_track_m within 2 except during "turn"',
    )
    verdicts = failed(flight, [*passing, *failing])
    assert tuple(verdicts) == failing
    assert verdicts[failing[1]].longest == Break(205.0, pytest.approx(210.1))
    assert verdicts[failing[1]].value == pytest.approx(3.0, abs=1e-3)
    assert verdicts[failing[0]].value == pytest.approx(-3.0, abs=1e-3)


def test_statistics_of_the_whole_flight_are_those_of_the_report(workshop, clean):
    flight = aside(workshop, changed(clean, 30.0, 47.0, altitude_m=1004.0), 100.0, 130.0)
    tracking = track(workshop.recording(flight))
    for name in ("cross_track_m", "altitude_error_m", "waypoint_time_error_s", "airspeed_mps", "wind_mps"):
        for of in ("mean", "p95", "max", "min"):
            expected = getattr(getattr(tracking, name), of, None)
            if expected is not None:
                (verdict,) = judge(tracking, parse_limits([f"{name}.{of} <= 1e9"]))
                assert verdict.value == expected
                assert verdict.worst.value == tracking.worst[f"{name}.{of}"].value


def test_breaks_are_added_up_and_the_longest_is_told(workshop, clean, failed):
    flight = changed(changed(clean, 50.0, 51.9, throttle=0.75), 60.0, 64.9, throttle=0.8)
    (verdict,) = failed(flight, ["throttle always <= 0.7"]).values()
    assert verdict.broken_s == pytest.approx(7.0)
    assert verdict.longest == Break(60.0, pytest.approx(65.0))
    assert (verdict.value, verdict.worst.time_s) == (pytest.approx(0.8, abs=1e-3), 60.0)
    assert str(verdict).endswith("broken for 7 s, longest 00:01:00 to 00:01:05")
    (of_mean,) = failed(flight, ["throttle.max < 0.7"]).values()
    assert of_mean.broken_s == pytest.approx(7.0)


def test_a_break_does_not_run_on_over_what_does_not_count(workshop, clean, failed):
    flight = changed(clean, 50.0, 59.9, throttle=0.75)
    (verdict,) = failed(flight, ["throttle within 0.7 except from 0:00:52 to 0:00:53"]).values()
    assert verdict.broken_s == pytest.approx(10.0 - 1.1, abs=0.01)
    assert verdict.longest == Break(pytest.approx(53.1, abs=0.01), pytest.approx(60.0))


def test_waypoints_are_counted(clean, failed, workshop):
    late = workshop.fly(clean.header, late_s=0.5)
    (verdict,) = failed(late, ["waypoint_time_error_s within 0.1"]).values()
    assert (verdict.reason, verdict.broken_s) == ("at 5 of 5 waypoints", None)
    short = workshop.fly(clean.header, until_s=300.0)
    assert failed(short, ["waypoint_time_error_s.max <= 0.1 until 0:04"]) == {}
    (verdict,) = failed(short, ["waypoint_time_error_s.max <= 0.1"]).values()
    assert verdict.reason == "and 2 waypoints were never reached"


def test_never_crashed_says_how_low_it_flew(workshop, clean):
    tracking = track(workshop.recording(changed(clean, 50.0, 50.0, height_above_ground_m=17.5)))
    (verdict,) = judge(tracking, parse_limits(["never crashed"]))
    assert verdict.passed
    assert isinstance(verdict.worst, Moment)
    assert "worst 17.5 m above ground at 00:00:50" in str(verdict)


def test_a_verdict_for_programs(workshop, clean):
    tracking = track(workshop.recording(changed(clean, 50.0, 51.9, throttle=0.75)))
    (verdict,) = judge(tracking, parse_limits(["throttle always <= 0.7"]))
    told = verdict.to_dict()
    assert told | {"worst": None} == {
        "limit": "throttle always <= 0.7",
        "passed": False,
        "value": pytest.approx(0.75),
        "margin": pytest.approx(-0.05),
        "worst": None,
        "broken_s": 2.0,
        "longest": {"from_s": 50.0, "to_s": 52.0},
        "before": None,
        "reason": "",
    }
    assert set(told["worst"]) == {"value", "unit", "time_s", "lat_deg", "lon_deg"}
