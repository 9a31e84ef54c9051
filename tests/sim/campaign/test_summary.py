"""What is told of a campaign, against its rows counted anew."""

from pathlib import Path

import msgspec
import numpy as np
import pyarrow.parquet as pq
import pytest

from sim.campaign.columns import schema, write_table
from sim.campaign.keeping import Keep
from sim.campaign.summary import FIGURES, REASONS_SHOWN, UNFLOWN_SHOWN, WORST_SHOWN, summarize
from sim.campaign.summary_text import summary_text
from sim.campaign.variation import parse_variations

KINDS = ("arrived", "arrived", "arrived", "crashed", "no_route", "process_crashed")
REASONS = ("passed There", "passed There", "passed There", "hit the ground", "no way", "SIGABRT")
RARE = "the start is in hazard"


@pytest.fixture(scope="module")
def rows():
    rng = np.random.default_rng(3)
    made = []
    for run in range(240):
        outcome, arrived = KINDS[run % 6], run % 6 < 3
        row = {
            "run": run,
            "seed": run // 2,
            "overrides": [f"a.b={run % 2}"],
            "outcome": outcome,
            "reason": RARE if run == 100 else REASONS[run % 6],
            "passed": False,
            "wall_time_s": float(rng.uniform(1, 2)),
        }
        if run % 6 < 4:
            kept = [bool(rng.random() < 0.8), bool(rng.random() < 0.6)]
            row |= {name: float(rng.normal()) for name in FIGURES} | {"arrived": arrived}
            row["limits"] = [
                {"limit": name, "passed": passed, "value": "1", "margin": None}
                for name, passed in zip(("x <= 1", "y <= 2"), kept, strict=True)
            ]
            row["passed"] = arrived and all(kept)
        made.append(row)
    return made


def summary_of(rows, path, planned):
    write_table(path, rows, schema(parse_variations(["a.b=0,1"]), {}), {})
    return summarize(pq.read_table(path), Path("my runs"), "hop", planned, Keep.parse("worst:3"))


@pytest.fixture(scope="module")
def summary(rows, tmp_path_factory):
    return summary_of(rows, tmp_path_factory.mktemp("table") / "x.parquet", 300)


def test_outcomes_and_limits_are_counted(summary, rows):
    assert summary.outcomes == {"arrived": 120, "crashed": 40, "no_route": 40, "process_crashed": 40}
    assert summary.reasons == {
        "crashed": {"hit the ground": 40},
        "no_route": {"no way": 39, RARE: 1},
        "process_crashed": {"SIGABRT": 40},
    }
    assert list(summary.reasons["no_route"]) == ["no way", RARE]
    assert summary.unjudged == 0
    for number, rate in enumerate(summary.limits):
        kept = [row["limits"][number]["passed"] for row in rows if "limits" in row]
        assert (rate.flights, rate.passed) == (len(kept), sum(kept))
    assert summary.planned == 300


def test_figures_are_spread_over_the_flights_with_each_value(summary, rows):
    assert [(group.key, group.value) for group in summary.varied] == [("a.b", 0), ("a.b", 1)]
    for group in (summary.all, *summary.varied):
        having = [row for row in rows if group.key is None or row["run"] % 2 == group.value]
        assert group.flights == len(having)
        assert group.passed == sum(row["passed"] for row in having)
        assert group.arrived == sum(row.get("arrived", False) for row in having)
        for name in FIGURES:
            values = [row[name] for row in having if name in row]
            spread = group.figures[name]
            expected = np.percentile(values, [5, 50, 95])
            assert (spread.p5, spread.p50, spread.p95) == pytest.approx(expected, abs=1e-6)
            assert spread.flights == len(values)


def test_the_worst_are_told_with_the_command_that_makes_them_again(summary, rows):
    unflown, flown = summary.worst[: 2 * UNFLOWN_SHOWN], summary.worst[2 * UNFLOWN_SHOWN :]
    assert [(flight.outcome, flight.run) for flight in unflown] == [
        *(("no_route", run) for run in (4, 100, 10)),  # each reason before one comes again
        *(("process_crashed", run) for run in (5, 11, 17)),
    ]
    assert unflown[1].replay == "galeway campaign replay 'my runs' 100"
    assert len(flown) == WORST_SHOWN
    worst = flown[0]
    assert worst.outcome == "crashed"
    assert len(worst.limits_broken) == 2
    assert worst.replay == f"galeway campaign replay 'my runs' {worst.run}"
    figures = [flight.figure for flight in flown if len(flight.limits_broken) == 2]
    assert figures == sorted(figures, reverse=True)
    both = {row["run"] for row in rows if row["outcome"] == "crashed" and not row["passed"]}
    assert {flight.run for flight in flown} <= both


def test_the_text_has_it_all(summary):
    text = summary_text(summary)
    assert text.startswith("hop: 240 of 300 flights, ")
    assert "40  crashed: hit the ground" in text
    assert f"40  no_route\n{39:16d}  no way\n{1:16d}  {RARE}\n" in text
    assert "nothing is judged" not in text
    for words in ("x <= 1", "a.b=1", "5th, 50th and 95th", summary.worst[0].replay, "seed="):
        assert words in text
    long = msgspec.structs.replace(summary.varied[0], value="x" * 200)
    text = summary_text(msgspec.structs.replace(summary, varied=(long,)))
    assert f"  a.b={'x' * 43}…  " in text


def test_flights_that_passed_are_told_apart_from_those_that_did_not(rows, tmp_path):
    failed = [row for row in rows if not row["passed"] and row["outcome"] == "arrived"][:4]
    good = [row for row in rows if row["passed"]]
    text = summary_text(summary_of(failed + good, tmp_path / "x.parquet", len(failed + good)))
    bad, fine = text.split("\n4 of 4 flights that did not pass: ")[1].split("\n\n")
    assert fine.startswith(
        f"6 of {len(good)} flights that passed, those with the largest cross_track_m.p95\n"
    )
    assert bad.count(", broke ") == bad.count("galeway campaign replay") == 4
    assert fine.count("galeway campaign replay") == 6
    assert "broke" not in fine
    largest = sorted(good, key=lambda row: -row["cross_track_m.p95"])[:6]
    assert [line.split()[-1] for line in fine.splitlines()[2::2]] == [str(row["run"]) for row in largest]
    none_failed = summary_text(summary_of(good, tmp_path / "x.parquet", len(good)))
    assert "did not pass" not in none_failed
    assert f"10 of {len(good)} flights that passed, those with" in none_failed


def test_of_many_reasons_some_are_told_and_how_many_flights_had_others(rows, tmp_path):
    lost = [row | {"reason": f"signal {row['run'] % 13}"} for row in rows if row["outcome"] == KINDS[5]]
    made = summary_of(lost, tmp_path / "x.parquet", len(lost))
    told = made.reasons["process_crashed"]
    assert len(told) == REASONS_SHOWN
    assert list(told.values()) == sorted(told.values(), reverse=True)
    assert f"{40 - sum(told.values())}  for other reasons" in summary_text(made)


def test_without_limits_nothing_is_judged(rows, tmp_path):
    unlimited = [row | {"limits": []} if "limits" in row else row for row in rows]
    made = summary_of(unlimited, tmp_path / "x.parquet", 240)
    assert made.unjudged == 160
    assert "the scenario sets no limits, so nothing is judged" in summary_text(made)
    some = [row | {"limits": []} if row["run"] == 3 else row for row in rows]
    text = summary_text(summary_of(some, tmp_path / "x.parquet", 240))
    assert "1 flight had no limits" in text
    never = summary_of([row for row in rows if "limits" not in row], tmp_path / "x.parquet", 240)
    assert "judged" not in summary_text(never)  # of these it is not known


def test_a_campaign_of_one_flight_is_told_in_the_singular(rows, tmp_path):
    assert summary_text(summary_of(rows[:1], tmp_path / "x.parquet", 1)).startswith("hop: 1 flight, ")
