"""A flight against an earlier one: each figure that can get worse does, and is told."""

from dataclasses import replace

import numpy as np
import pytest

from recordings.comparison import RULES, Tolerance, compare, differences, parse_tolerances
from recordings.errors import BadComparisonError, BadLimitError
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Outcome
from recordings.tracking import track


@pytest.fixture(scope="module")
def before(kept):
    return track(kept.recording(kept.fly(kept.header(kept.corners))))


@pytest.fixture
def worse(workshop, before):
    """The figures by which a flight is worse: (flight, tolerances) -> verdicts by name."""

    def worse(flight, *tolerances):
        verdicts = compare(track(workshop.recording(flight)), before, parse_tolerances(tolerances))
        return {verdict.limit.limit.name: verdict for verdict in verdicts if not verdict.passed}

    return worse


def test_a_flight_is_no_worse_than_itself(workshop, before, worse):
    assert worse(workshop.fly(workshop.header(workshop.corners))) == {}
    assert {verdict.limit.limit.name for verdict in compare(before, before)} == set(RULES)


def test_each_figure_that_got_worse_is_told_and_no_other(workshop, worse):
    header = workshop.header(workshop.corners)
    clean = workshop.fly(header)
    lag = {f"waypoint_time_error_s.{of}" for of in ("mean", "p95", "max")}
    slow = [
        state._replace(airspeed_mps=19.0) if 50 <= state.time_s <= 60 else state for state in clean.states
    ]
    dry = [state._replace(fuel_kg=state.fuel_kg - 0.1) for state in clean.states]
    lost = [seen._replace(lat_rad=seen.lat_rad + 1e-6) for seen in clean.seen]
    misled = [seen._replace(wind_east_mps=0.0) for seen in clean.seen]
    flights = {
        "aside": (
            workshop.fly(header, right_m=2.0),
            {f"cross_track_m.{of}" for of in ("mean", "p95", "max")},
        ),
        "a little aside": (workshop.fly(header, right_m=0.09), set()),
        "above": (
            workshop.fly(header, above_m=2.0),
            {f"altitude_error_m.{of}" for of in ("mean", "p95", "max")},
        ),
        "late": (workshop.fly(header, late_s=3.0), lag),
        "later": (workshop.fly(header, late_s=6.0), lag | {"flight_time_s", "flown_length_m"}),
        "short": (workshop.fly(header, until_s=300.0), {"arrived", "waypoints_missed", *lag}),
        "crashed": (replace(clean, outcome=Outcome.CRASHED), {"outcome"}),
        "gale": (
            workshop.fly(header, wind_mps=lambda time_s: 15.1 if time_s == 200.0 else 6.0),
            {"hazard_exposure_s"},
        ),
        "near": (
            workshop.fly(header, sheets=workshop.sheets(np.ones(workshop.grid.shape, bool))),
            {"min_clearance_m"},
        ),
        "slow": (replace(clean, states=slow), {"outside_airspeeds_s"}),
        "thirsty": (replace(clean, states=dry), {"fuel_kg.min"}),
        "lost": (replace(clean, seen=lost), {"position_estimate_error_m.p95"}),
        "misled": (replace(clean, seen=misled), {"wind_estimate_error_mps.p95"}),
        "blind": (
            replace(clean, seen=[]),
            {"position_estimate_error_m.p95", "wind_estimate_error_mps.p95"},
        ),
        "held": (workshop.fly_and_hold(header, early_s=70.0, hold_s=100.0), lag | {"holds"}),
    }
    told = set()
    for what, (flight, expected) in flights.items():
        found = set(worse(flight))
        assert found == expected, what
        told |= found
    assert told == set(RULES)


def test_a_longer_way_is_told(before):
    longer = replace(before, flown_length_m=before.flown_length_m * 1.02)
    (verdict,) = [verdict for verdict in compare(longer, before) if not verdict.passed]
    assert str(verdict).startswith("FAIL flown_length_m at most 14")
    assert "(+ 1 % or 100 m): 14" in str(verdict)


def test_it_says_by_how_much_where_and_for_how_long(workshop, worse):
    verdict = worse(workshop.fly(workshop.header(workshop.corners), above_m=0.5))["altitude_error_m.p95"]
    line = str(verdict)
    assert line.startswith(
        "FAIL altitude_error_m.p95 at most 0 (+ 10 % or 0.2 m): 0.5 (over by 0.3), worst 0.5 m at"
    )
    assert "broken for 480.1 s" in line
    assert verdict.to_dict()["before"] == 0.0


def test_tolerances_can_be_set(workshop, worse):
    flight = workshop.fly(workshop.header(workshop.corners), above_m=0.5)
    every = [f"altitude_error_m.{of}=" for of in ("mean", "p95", "max")]
    assert worse(flight, *(f"{name}0.6" for name in every)) == {}
    assert set(worse(flight, *(f"{name}0.4m" for name in every))) == {name[:-1] for name in every}
    assert worse(flight, *(f"{name}1 m" for name in every)) == {}
    assert "altitude_error_m.max" in worse(flight, "altitude_error_m.max=50%")


def test_any_figure_can_be_compared_either_way(workshop, worse, before):
    header = workshop.header(workshop.corners)
    windy = workshop.fly(header, wind_mps=lambda _: 7.0)
    calmer = workshop.fly(header, wind_mps=lambda _: 5.0)
    for flight in (windy, calmer):
        assert "wind_mps.mean" in worse(flight, "wind_mps.mean=10%")
        assert "wind_mps.mean" not in worse(flight, "wind_mps.mean=20%")
    assert parse_tolerances(["wind_mps.mean=0.5m/s"]) == parse_tolerances(["wind_mps.mean=0.5mps"])


def test_what_was_not_good_before_cannot_get_worse(workshop, before):
    header = workshop.header(workshop.corners)
    lost = track(
        workshop.recording(replace(workshop.fly(header, until_s=300.0), outcome=Outcome.CANNOT_FOLLOW))
    )
    assert {verdict.limit.limit.name for verdict in compare(before, lost)} == set(RULES) - {
        "outcome",
        "arrived",
    }
    assert all(
        verdict.passed
        for verdict in compare(before, lost)
        if verdict.limit.limit.name != "flight_time_s"
        and "length" not in verdict.limit.limit.name
        and "fuel" not in verdict.limit.limit.name
    )


def test_what_was_measured_but_once_is_told(workshop, before, worse):
    clean = workshop.fly(workshop.header(workshop.corners))
    blind = track(workshop.recording(replace(clean, seen=[])))
    assert {verdict.limit.limit.name for verdict in compare(blind, blind)} == {
        name for name in RULES if "estimate" not in name
    }
    found = [verdict for verdict in compare(before, blind) if not verdict.passed]
    assert {verdict.reason for verdict in found} == {"nothing was measured before"}
    (asked, *_) = [
        verdict
        for verdict in compare(blind, blind, parse_tolerances(["wind_estimate_error_mps.p95=10%"]))
        if not verdict.passed
    ]
    assert asked.limit.limit.name == "wind_estimate_error_mps.p95"


def test_other_scenarios_and_goals_are_refused(before):
    for change in ({"scenario": "calm"}, {"goal": "Isle"}):
        with pytest.raises(BadComparisonError, match="compare flights of one"):
            compare(replace(before, **change), before)


def test_an_incomplete_recording_is_nothing_to_compare_with(workshop, before):
    recorder = McapRecorder(workshop.folder / "cut.mcap")
    workshop.fly(workshop.header(workshop.corners)).record(recorder, finish=False)
    recorder.abandon()
    with pytest.raises(BadComparisonError, match="is incomplete: how the flight ended"):
        compare(before, track(read(recorder.partial_path)))


def test_other_plans_seeds_and_versions_are_said(workshop, before):
    header = replace(
        workshop.header(workshop.corners, 121.0), seed=8, versions={"galeway": "0.2.0", "git": "abc"}
    )
    other = track(workshop.recording(workshop.fly(header)))
    assert differences(before, before) == []
    assert differences(other, before) == [
        "the plans differ, so that figures change with the route, too",
        "the seeds differ: 8, before 7",
        "galeway is 0.2.0, before 0.1.0",
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cross_track_m.p95", "cannot be understood"),
        ("cross_track_m.p95=-1", "cannot be understood"),
        ("cross_track_m.p95=", "cannot be understood"),
        ("cross_track_m.p95=1ft", "is in ft, but cross_track_m.p95 is in m"),
        ("samples=5m", "is in m, but samples is in no unit"),
        ("cros_track_m.p95=10%", "did you mean cross_track_m.p95"),
        ("cross_track_m=10%", "cross_track_m.p95"),
        ("arrived=10%", "the tolerance 'arrived=10%' is on arrived, which is no number"),
        (
            "flght_time_s=30",
            "^the tolerance 'flght_time_s=30' is on .*; did you mean flight_time_s",
        ),
    ],
)
def test_tolerances_that_are_refused(text, message):
    with pytest.raises(BadLimitError, match=message):
        parse_tolerances([text])


def test_a_tolerance_is_the_larger_of_its_two():
    tolerance = Tolerance(share=0.1, amount=0.5)
    assert (tolerance.allows(1.0), tolerance.allows(10.0), tolerance.allows(-10.0)) == (0.5, 1.0, 1.0)
    assert tolerance.text("cross_track_m.p95") == "10 % or 0.5 m"
    assert Tolerance().text("holds") == "0"
