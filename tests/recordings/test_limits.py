"""Limits on the figures of a report: that each of them can fail; and limits from files."""

import math
from dataclasses import replace

import numpy as np
import pytest

from recordings.errors import BadLimitError
from recordings.limits import figure_kinds, judge, load_limits, parse_limits
from recordings.recorder import Outcome, PlanIssue
from recordings.tracking import track

TIGHT = (
    'scenario == "squall"',
    "seed == 7",
    'outcome == "arrived"',
    "arrived == true",
    'goal == "Port"',
    "planned_time_s <= 480",
    "flight_time_s <= 480",
    "planned_length_m < 14300",
    "flown_length_m < 14300",
    "cross_track_m.mean <= 0.01",
    "cross_track_m.p95 <= 0.01",
    "cross_track_m.max <= 0.01",
    "altitude_error_m.mean <= 0.001",
    "altitude_error_m.p95 <= 0.001",
    "altitude_error_m.max <= 0.001",
    "waypoint_time_error_s.mean <= 0.01",
    "waypoint_time_error_s.p95 <= 0.01",
    "waypoint_time_error_s.max <= 0.01",
    "airspeed_mps.min >= 26.9",
    "airspeed_mps.mean >= 27",
    "airspeed_mps.max <= 29.1",
    "wind_mps.min >= 5.9",
    "wind_mps.mean <= 6.1",
    "wind_mps.max < 6.1",
    "hazard_exposure_s == 0",
    "min_clearance_m > 50000",
    "samples >= 4801",
    "waypoints_missed == 0",
    "corner_cut_m.max <= 100",
    "outside_airspeeds_s == 0",
    "position_estimate_error_m.mean <= 1.6",
    "position_estimate_error_m.p95 <= 1.6",
    "position_estimate_error_m.max <= 1.6",
    "wind_estimate_error_mps.mean <= 0.6",
    "wind_estimate_error_mps.p95 <= 0.6",
    "wind_estimate_error_mps.max <= 0.6",
    "delay_s <= 0.1",
    "holds == 0",
    "forecasts == 1",
    "plan_changes == 0",
    'destination == "Port"',
    "level_changes == 0",
)

POSITION_ESTIMATE, WIND_ESTIMATE = (
    {f"{figure}.{part}" for part in ("mean", "p95", "max")}
    for figure in ("position_estimate_error_m", "wind_estimate_error_mps")
)


def broken_flights(workshop):
    """A flight with one thing wrong, and every limit that then has to fail."""
    header = workshop.header(workshop.corners)
    clean = workshop.fly(header)
    block = np.ones(workshop.grid.shape, bool)
    slow, slower, fast, calm = (
        [state._replace(**fields) for state in clean.states]
        for fields in (
            {"airspeed_mps": 20.0},
            {"airspeed_mps": 19.5},
            {"airspeed_mps": 35.0},
            {"wind_east_mps": 0.0, "wind_north_mps": 0.0},
        )
    )
    plan = header.plan
    lost = [seen._replace(lat_rad=seen.lat_rad + 1e-6, wind_east_mps=-5.0) for seen in clean.seen]
    return {
        "scenario": (replace(clean, header=replace(header, scenario="calm")), {"scenario"}),
        "seed": (replace(clean, header=replace(header, seed=8)), {"seed"}),
        "outcome": (replace(clean, outcome=Outcome.FUEL_OUT), {"outcome"}),
        "goal": (
            replace(
                clean,
                header=replace(header, plan=replace(plan, goal="Isle")),
                plans=same_but_to(plan, "Isle"),
            ),
            {"goal", "arrived", "destination"},
        ),
        "without forecasts": (replace(clean, plans=()), {"forecasts"}),
        "replanned": (
            workshop.fly_and_replan(header, workshop.corners, 50.0),
            {"plan_changes"},
        ),
        "diverted": (
            workshop.fly_and_replan(header, workshop.corners, 50.0, goal="Isle"),
            {"plan_changes", "arrived", "destination"},
        ),
        "aside": (
            workshop.fly(header, right_m=60.0),
            {"arrived", "cross_track_m.mean", "cross_track_m.p95", "cross_track_m.max"},
        ),
        "above": (
            workshop.fly(header, above_m=0.1),
            {"altitude_error_m.mean", "altitude_error_m.p95", "altitude_error_m.max"},
        ),
        "late": (
            workshop.fly(header, late_s=3.0),
            {
                "waypoint_time_error_s.mean",
                "waypoint_time_error_s.p95",
                "waypoint_time_error_s.max",
                "flight_time_s",
                "delay_s",
            },
        ),
        "early, then held": (
            workshop.fly_and_hold(header, early_s=70.0, hold_s=100.0),
            {
                "waypoint_time_error_s.mean",
                "waypoint_time_error_s.p95",
                "waypoint_time_error_s.max",
                "holds",
            },
        ),
        "short": (
            workshop.fly(header, until_s=300.0),
            {
                "arrived",
                "samples",
                "waypoints_missed",
                "waypoint_time_error_s.mean",
                "waypoint_time_error_s.p95",
                "waypoint_time_error_s.max",
                "delay_s",
            },
        ),
        "slow": (replace(clean, states=slow), {"airspeed_mps.min", "airspeed_mps.mean"}),
        "slower than it can fly": (
            replace(clean, states=slower),
            {"airspeed_mps.min", "airspeed_mps.mean", "outside_airspeeds_s"},
        ),
        "fast": (replace(clean, states=fast), {"airspeed_mps.max"}),
        "calm": (replace(clean, states=calm), {"wind_mps.min"} | WIND_ESTIMATE),
        "lost": (replace(clean, seen=lost), POSITION_ESTIMATE | WIND_ESTIMATE),
        "perfect sensors": (replace(clean, seen=[]), POSITION_ESTIMATE | WIND_ESTIMATE),
        "gale": (
            workshop.fly(header, wind_mps=lambda time_s: 15.1 if time_s > 200.0 else 6.0),
            {"wind_mps.mean", "wind_mps.max", "hazard_exposure_s"},
        ),
        "hazard": (workshop.fly(header, sheets=workshop.sheets(block)), {"min_clearance_m"}),
        "no hazard": (workshop.fly(header, sheets=workshop.sheets(~block)), {"min_clearance_m"}),
        "long": (
            workshop.fly(workshop.header((*workshop.corners[:-1], (-200.0, 7200.0)))),
            {"planned_length_m", "flown_length_m"},
        ),
        "slow plan": (
            workshop.fly(workshop.header(workshop.corners, 121.0)),
            {"planned_time_s", "flight_time_s"},
        ),
        "cut corners": (workshop.fly(blunt(header)), {"corner_cut_m.max"}),
        "planned over a level": (workshop.fly(climbing(header)), {"level_changes"}),
    }


def same_but_to(plan, goal):
    return (PlanIssue(60.0, "unchanged", replace(plan, goal=goal), False),)


def climbing(header):
    """The plan's second and third waypoint at another level, to which no reference leads."""
    first, *middle, last = header.plan.waypoints
    higher = [replace(point, altitude_m=point.altitude_m + 50.0) for point in middle]
    return replace(header, plan=replace(header.plan, waypoints=(first, *higher, last)))


def blunt(header):
    """The plan's second waypoint moved away from the reference, as if corners were cut by much more."""
    waypoints = list(header.plan.waypoints)
    waypoints[1] = replace(waypoints[1], lat_deg=waypoints[1].lat_deg - 0.002)
    return replace(header, plan=replace(header.plan, waypoints=tuple(waypoints)))


def verdicts(workshop, flight, limits):
    return judge(track(workshop.recording(flight)), parse_limits(limits))


def test_a_clean_flight_passes_every_limit(workshop):
    flight = workshop.fly(workshop.header(workshop.corners))
    found = verdicts(workshop, flight, TIGHT)
    assert [str(verdict) for verdict in found if not verdict.passed] == []


def test_every_figure_has_a_limit_in_this_test():
    assert {limit.name for limit in parse_limits(TIGHT)} == set(figure_kinds())


def test_one_thing_wrong_breaks_its_limits_and_no_others(workshop):
    broken = set()
    for what, (flight, expected) in broken_flights(workshop).items():
        failed = {verdict.limit.name for verdict in verdicts(workshop, flight, TIGHT) if not verdict.passed}
        assert failed == expected, what
        broken |= expected
    assert broken == set(figure_kinds()), "a limit that nothing breaks"


@pytest.fixture(scope="module")
def tracking(kept):
    flight = kept.fly(kept.header(kept.straight), right_m=0.5)
    return track(kept.recording(flight.changed(1234, altitude_m=1003.0)))


@pytest.mark.parametrize(
    ("limit", "line"),
    [
        (
            "cross_track_m.p95<=0.1",
            "FAIL cross_track_m.p95 <= 0.1: 0.5 (over by 0.4), worst 0.5 m at 00:0",
        ),
        (
            "cross_track_m.mean < 0.1",
            "FAIL cross_track_m.mean < 0.1: 0.5 (over by 0.4), worst 0.5 m at 00:0",
        ),
        (
            " altitude_error_m.max <= 12 ",
            "PASS altitude_error_m.max <= 12: 3 (9 to spare), worst 3 m at 00:01:33, 30.00 N 89.48 W",
        ),
        (
            "samples >= 5000",
            "FAIL samples >= 5000: 3601 (short by 1399)",
        ),
        ("hazard_exposure_s == 1.5", "FAIL hazard_exposure_s == 1.5: 0 (off by 1.5), worst 6 m/s of wind at"),
        ("hazard_exposure_s == 0", "PASS hazard_exposure_s == 0: 0, worst 6 m/s of wind at"),
        ("arrived == false", "FAIL arrived == false: true, worst 0.5 m from the last waypoint at 00:06:00"),
        ('outcome == "crashed"', 'FAIL outcome == "crashed": "arrived"'),
        ('outcome != "crashed"', 'PASS outcome != "crashed": "arrived"'),
        ("samples != 3601", "FAIL samples != 3601: 3601"),
        ("samples > 3601", "FAIL samples > 3601: 3601 (short by 0)"),
        ("seed < 7", "FAIL seed < 7: 7 (over by 0)"),
        ("seed < 1e6", "PASS seed < 1000000: 7 (999993 to spare)"),
    ],
)
def test_a_verdict_is_one_line(tracking, limit, line):
    (verdict,) = judge(tracking, parse_limits([limit]))
    assert str(verdict).startswith(line)
    assert "\n" not in str(verdict)
    assert verdict.passed == line.startswith("PASS")


def test_percentiles_against_sorting(tracking):
    airspeed_mps = np.sort(tracking.series.airspeed_mps)
    for share in (0, 25, 50, 99.9, 100):
        (verdict,) = judge(tracking, parse_limits([f"airspeed_mps.p{share} >= 0"]))
        at = share / 100.0 * (len(airspeed_mps) - 1)
        low, high = airspeed_mps[math.floor(at)], airspeed_mps[math.ceil(at)]
        assert verdict.value == pytest.approx(low + (at % 1.0) * (high - low))


def test_what_was_not_measured_fails(workshop):
    flight = workshop.fly(workshop.header(workshop.straight), until_s=-5.0)
    limits = (
        "cross_track_m within 100",
        "airspeed_mps always > 0",
        "never crashed",
        'never "minute"',
        "clearance_m.min >= 0",
        "cross_track_m.max <= 100",
        "hazard_exposure_s != 5",
        "min_clearance_m >= 0",
        "wind_mps.min >= 0",
    )
    for verdict in verdicts(workshop, flight, limits):
        assert not verdict.passed
        assert "nothing could be measured" in str(verdict)


def test_a_figure_that_is_not_a_number_fails(tracking):
    broken = replace(tracking, planned_time_s=math.nan)
    for limit in ("planned_time_s <= 1e9", "planned_time_s >= 0", "planned_time_s != 3"):
        (verdict,) = judge(broken, parse_limits([limit]))
        assert not verdict.passed


def test_no_limits_are_no_pass(tracking):
    with pytest.raises(BadLimitError, match="nothing would be checked"):
        judge(tracking, [])


def test_limits_from_a_file(tmp_path):
    path = tmp_path / "limits.toml"
    path.write_text('limits = [\n "arrived == true", # comment\n "cross_track_m.p95 <= 2",\n]\n')
    assert [str(limit) for limit in load_limits(path)] == ["arrived == true", "cross_track_m.p95 <= 2"]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "must hold"),
        (b"limits = []", "no limit"),
        (b"limits = [2]", "must hold"),
        (b'limits = "arrived == true"', "must hold"),
        (b'limits = ["arrived == true"]\nextra = 1', "must hold"),
        (b"limits = [", "not TOML"),
        (b"\xff\xfe", "not text in UTF-8"),
        (b'limits = ["arived == true"]', "did you mean arrived"),
    ],
)
def test_files_of_limits_that_are_refused(tmp_path, content, message):
    path = tmp_path / "limits.toml"
    path.write_bytes(content)
    with pytest.raises(BadLimitError, match=message):
        load_limits(path)


def test_a_file_of_limits_that_is_not_there(tmp_path):
    with pytest.raises(BadLimitError, match="cannot read the limits"):
        load_limits(tmp_path / "none.toml")
