from dataclasses import replace

from recordings.rerun_card import run_card


def test_the_card_tells_what_was_flown_and_how_it_ended(workshop):
    header = workshop.header(workshop.corners, leg_s=1200.0)
    card = run_card(replace(header, versions={"galeway": "9.8.7", "git": "abcdef"}), "arrived: passed Port")
    for part in (
        "| **squall**, seed 7 | arrived: passed Port | planned | 1:20 h, 10 km to Port |",
        "2022-09-29 00:00 UTC",
        "staged, by score",
        "20 to 40 m/s",
        "wind over 15 m/s",
        "9.8.7",
        "abcdef",
    ):
        assert part in card


def test_a_short_flight_is_told_in_minutes_and_a_length_that_is_not_known_left_out(workshop):
    header = workshop.header(workshop.straight, leg_s=30.0)
    goals = tuple(replace(goal, length_m=None) for goal in header.plan.goals)
    card = run_card(replace(header, plan=replace(header.plan, goals=goals)), "in flight")
    assert "| 1 min 30 s to Port |" in card
