import re
from dataclasses import replace

import pytest

from recordings.limits import judge, parse_limits
from recordings.rerun_card import limits_card, run_card, verdicts_card
from recordings.tracking import track


def test_the_card_tells_what_was_flown_and_how_it_ended(workshop):
    header = workshop.header(workshop.corners, leg_s=1200.0)
    card = run_card(replace(header, versions={"galeway": "9.8.7", "git": "abcdef"}), "arrived: passed Port")
    assert card.startswith("**arrived**: passed Port\n")
    for part in (
        "| scenario | **squall**, seed 7 |",
        "| planned | 1:20 h, 10 km to Port |",
        "2022-09-29 00:00 UTC",
        "staged, by score",
        "9.8.7 abcdef",
    ):
        assert part in card


def test_the_levels_of_a_flight_that_changes_them_stand_on_the_card(workshop):
    header = workshop.header(workshop.straight)
    assert "levels" not in run_card(header, "in flight")
    altitudes_m = (400.0, 400.0, 1500.0, 1500.0)
    route = zip(header.plan.waypoints, altitudes_m, strict=True)
    climbing = tuple(replace(point, altitude_m=altitude_m) for point, altitude_m in route)
    card = run_card(replace(header, plan=replace(header.plan, waypoints=climbing)), "in flight")
    assert "| levels | 400, 1500 m |" in card


def test_what_is_hazardous_besides_the_wind_stands_on_the_card_with_the_wind(workshop):
    header = workshop.header(workshop.straight)
    told = "**hazard**: wind over 14.29 m/s; gusts over 20 m/s (gust.nc); no-fly zones (zones.geojson)"
    gusty = replace(header, threshold_mps=100.0 / 7.0)
    assert run_card(gusty, "in flight").splitlines()[-1] == told
    alone = run_card(replace(header, also=()), "in flight")
    assert "hazard" not in alone
    assert alone.splitlines()[-1].startswith("| galeway |")


def test_a_short_flight_is_told_in_minutes_and_a_length_that_is_not_known_left_out(workshop):
    header = workshop.header(workshop.straight, leg_s=30.0)
    goals = tuple(replace(goal, length_m=None) for goal in header.plan.goals)
    card = run_card(replace(header, plan=replace(header.plan, goals=goals)), "in flight")
    assert "| 1 min 30 s to Port |" in card


def test_the_verdicts_tell_limit_value_and_whether_it_holds(workshop):
    tracking = track(workshop.recording(workshop.fly(workshop.header(workshop.straight), right_m=3.0)))
    limits = ["arrived == true", "cross_track_m.p95 <= 2", 'outcome == "arrived"', "altitude_error_m.max < 9"]
    card = verdicts_card(judge(tracking, parse_limits(limits)))
    assert card.splitlines() == [
        "| **3 of 4 limits hold** | measured |  |",
        "|---|---|---|",
        f"| cross_track_m.p95 <= 2 | {tracking.cross_track_m.p95:.4g} | **FAIL** |",
        "| arrived == true | true | PASS |",
        '| outcome == "arrived" | "arrived" | PASS |',
        f"| altitude_error_m.max < 9 | {tracking.altitude_error_m.max:.4g} | PASS |",
    ]


def test_a_time_of_flight_is_told_as_on_a_clock(workshop):
    tracking = track(workshop.recording(workshop.fly(workshop.header(workshop.straight))))
    card = verdicts_card(judge(tracking, parse_limits(["arrived before 18:00"])))
    (row,) = [line for line in card.splitlines() if line.startswith("| arrived before")]
    assert re.fullmatch(r"\| arrived before 18:00 \| 00:\d\d:\d\d\.\d \| PASS \|", row)


def test_before_the_flight_is_judged_its_limits_stand_there():
    assert limits_card(["arrived == true", "cross_track_m.p95 <= 2"]).splitlines() == [
        "| **2 limits** | judged after the flight |",
        "|---|---|",
        "| arrived == true |  |",
        "| cross_track_m.p95 <= 2 |  |",
    ]


@pytest.mark.parametrize("card", [limits_card([]), verdicts_card([])])
def test_a_flight_without_limits_is_said_to_be_judged_by_nothing(card):
    assert "sets no limits" in card


def test_a_bar_in_a_text_does_not_break_the_table(workshop):
    card = run_card(replace(workshop.header(workshop.straight), scenario="left|right"), "in flight")
    assert card.startswith("**in flight**\n")
    assert "| scenario | **left/right**, seed 7 |" in card


def test_a_long_limit_is_cut_to_the_width_of_the_view():
    limit = 'cross_track_m within 5 except during "turn" except from 3:00 to 3:10:30'
    row = limits_card([limit]).splitlines()[-1]
    assert row == "| cross_track_m within 5 except during ... |  |"
