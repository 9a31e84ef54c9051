"""What was recorded with every schema there ever was can be read, and gives the figures that it gave then."""

import json
from pathlib import Path

import numpy as np
import pytest

import recordings
from recordings.limits import judge, parse_limits
from recordings.mcap_repair import repair
from recordings.recorder import Outcome
from recordings.schema import SCHEMA_VERSION, SCHEMA_VERSIONS
from recordings.tracking import track

GOLDEN = Path(__file__).parents[1] / "golden"
LARGEST = 200_000


REPLANNED = GOLDEN / "schema-3-replanned.mcap"


@pytest.fixture(params=SCHEMA_VERSIONS)
def schema(request):
    return request.param


def test_there_is_a_small_golden_recording_of_each_schema(schema):
    for path in GOLDEN.glob(f"schema-{schema}*.mcap"):
        assert path.stat().st_size < LARGEST
        assert f"schema\x01\0\0\0{schema}".encode() in path.read_bytes()
    assert (GOLDEN / f"schema-{schema}.mcap").is_file()
    assert max(SCHEMA_VERSIONS) == SCHEMA_VERSION


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.mcap")), ids=lambda path: path.stem)
def test_a_golden_recording_gives_the_report_that_it_gave(path):
    recording = recordings.open(path)
    assert (recording.missing, recording.outcome) == ("", Outcome.ARRIVED)
    found = json.loads(track(recording).to_json())
    then = json.loads(path.with_suffix(".json").read_text())
    assert found["samples"] == then["samples"] > 200
    for name, value in then.items():
        if isinstance(value, dict):
            for part, number in value.items():
                assert found[name][part] == near(number), (name, part)
        else:
            assert found[name] == near(value), name


def near(value):
    """The same; of a number but for rounding."""
    return pytest.approx(value, abs=1e-6, rel=1e-6) if isinstance(value, float) else value


def test_a_golden_recording_explains_itself(schema):
    header = recordings.open(GOLDEN / f"schema-{schema}.mcap").header
    assert header.scenario == "golden"
    assert header.scenario_toml.startswith("# A few minutes")
    assert header.seed == 5
    assert header.limits == ("arrived == true", "cross_track_m.p95 <= 10")
    assert header.plan.goal == "There"
    assert {"galeway", "jsbsim", "numpy", "python", "git"} <= set(header.versions)


def test_a_golden_recording_holds_a_plan_that_was_changed_in_flight():
    recording = recordings.open(REPLANNED)
    changes = [issue for issue in recording.plans[1:] if issue.changed]
    assert [(issue.time_s, issue.reason) for issue in changes] == [
        (120.0, "forecast of 00:02 UTC, stage 2: a better one, score 49.5 instead of 49.2")
    ]
    assert [issue.time_s for issue in recording.plans[1:]] == [60.0, 120.0, 180.0, 240.0, 300.0]
    assert recording.plan == changes[0].plan != recording.header.plan
    first, second = recording.references
    assert second.time_s == 120.0
    assert len(second.reference.waypoint_path_m) < len(first.reference.waypoint_path_m)
    verdicts = judge(track(recording), parse_limits(recording.limits))
    assert [str(verdict.limit) for verdict in verdicts if verdict.passed] == list(recording.limits)


def test_golden_sheets_have_their_altitude_since_it_is_recorded(schema):
    """The schema's number did not rise for it: a reader that does not know of it misreads nothing."""
    sheets = recordings.open(GOLDEN / f"schema-{schema}.mcap").hazards
    assert {sheet.altitude_m for sheet in sheets} == {None}
    later = recordings.open(REPLANNED)
    assert {sheet.altitude_m for sheet in later.hazards} == {1000.0}
    assert len(later.hazards) == 12
    assert any(sheet.hazard.any() for sheet in later.hazards)


def test_what_else_is_hazardous_is_in_golden_recordings_since_it_is_recorded(schema):
    assert recordings.open(GOLDEN / f"schema-{schema}.mcap").header.also == ()
    assert recordings.open(REPLANNED).header.also == (
        "gusts over 14.28 m/s, 2 times the wind: wind over 7.14 m/s",
    )


@pytest.mark.parametrize(("share", "whole"), [(0.75, False), (0.98, True)])
def test_of_a_golden_recording_that_was_cut_off_plans_and_altitudes_are_repaired(tmp_path, share, whole):
    content = REPLANNED.read_bytes()
    cut, mended = tmp_path / "cut.mcap", tmp_path / "mended.mcap"
    cut.write_bytes(content[: int(share * len(content))])
    repair(cut, mended)
    before, after = recordings.open(REPLANNED), recordings.open(mended)
    assert after.complete is whole
    assert np.array_equal(after.state, before.state)
    assert after.header.also == before.header.also
    assert {sheet.altitude_m for sheet in after.hazards} == {1000.0}
    assert after.plans == before.plans[: len(after.plans)]
    assert any(issue.changed for issue in after.plans[1:])
