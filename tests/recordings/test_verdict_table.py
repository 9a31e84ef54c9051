"""Verdicts as a table."""

import re

import pytest

from recordings.limits import judge, parse_limits
from recordings.tracking import track
from recordings.verdict_table import table

LIMITS = (
    "cross_track_m.p95 <= 2",
    "hazard_exposure_s == 0",
    'goal == "a: 100%, b"',
    'bank_deg within 9 during "loiter"',
)


@pytest.fixture(scope="module")
def verdicts(kept):
    tracking = track(kept.recording(kept.fly(kept.header(kept.straight), right_m=3.0)))
    return judge(tracking, parse_limits(LIMITS))


def test_columns_stand_below_each_other(verdicts):
    lines = table(verdicts)
    assert [line[:5] for line in lines] == ["     ", "FAIL ", "PASS ", "FAIL ", "FAIL "]
    for heading, cells in {
        "limit": LIMITS,
        "value": ("3", "0", '"Port"', "none"),
        "margin": ("over by 1", " "),
    }.items():
        at = lines[0].index(heading)
        for line, cell in zip(lines[1:], cells, strict=False):
            assert line[at:].startswith(cell)
            assert line[at - 1] == " "
    assert re.search(
        r"3 m at 00:0\d:\d\d, 30.00 N 89.\d\d W +for 360.1 s, longest 00:00:00 to 00:06:00$", lines[1]
    )
    assert lines[4].endswith('no moment of the flight is during "loiter"')
    assert all(line == line.rstrip() for line in lines)
