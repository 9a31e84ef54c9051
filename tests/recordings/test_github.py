"""Annotations that GitHub reads as they are meant."""

import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

import pytest

from recordings.checking import Checked
from recordings.github import workflow_commands
from recordings.limits import judge, parse_limits
from recordings.tracking import track

LIMITS = (
    "cross_track_m.p95 <= 2",
    'goal == "a: 100%, b"',
    'bank_deg within 9 during "loiter"',
    "arrived == true",
)


@pytest.fixture(scope="module")
def verdicts(kept):
    tracking = track(kept.recording(kept.fly(kept.header(kept.straight), right_m=3.0)))
    return judge(tracking, parse_limits(LIMITS))


ANNOTATION = re.compile(r"::error file=([^:,\n]*),title=([^:,\n]*)::([^\n]*)")


def test_annotations_are_lines_that_can_be_read_back(verdicts):
    checked = Checked(
        Path("runs/a,b:c/50%.mcap"), None, tuple(verdicts), "the end\r\nof it", (), "torn, or worse"
    )
    found = [ANNOTATION.fullmatch(line) for line in workflow_commands(checked)]
    assert all(found)
    told = [tuple(map(unquote, match.groups())) for match in found]
    assert {file for file, _, _ in told} == {"runs/a,b:c/50%.mcap"}
    failed = [verdict for verdict in verdicts if not verdict.passed]
    assert [title for _, title, _ in told] == [
        *(str(verdict.limit) for verdict in failed),
        "incomplete recording",
        "not checked",
    ]
    assert [text for *_, text in told] == [*map(str, failed), "the end\r\nof it", "torn, or worse"]


def test_what_passes_is_not_annotated(verdicts):
    passed = tuple(replace(verdict, passed=True) for verdict in verdicts)
    assert workflow_commands(Checked(Path("a.mcap"), None, passed)) == []
