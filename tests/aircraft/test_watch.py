from __future__ import annotations

import math

import pytest

from aircraft.envelope import Envelope
from aircraft.schedule import End
from aircraft.watch import Path, Watch

ENVELOPE = Envelope(
    airspeed_min_mps=20.0,
    airspeed_max_mps=41.0,
    cruise_mps=27.0,
    climb_max_mps=3.0,
    descent_max_mps=3.0,
    bank_max_rad=math.radians(35.0),
    ceiling_m=2000.0,
)


@pytest.mark.parametrize(
    ("tail_mps", "cross_mps", "path"),
    [
        (0.0, 40.5, Path.FOLLOWED),
        (0.0, -41.5, Path.BLOWN_OFF),
        (-40.5, 0.0, Path.FOLLOWED),
        (-41.5, 0.0, Path.BLOWN_OFF),
        (60.0, 0.0, Path.FOLLOWED),  # from behind, the path is followed however strong the wind
        (-30.0, 30.0, Path.BLOWN_OFF),  # against the crosswind no way is left against the headwind
        (30.0, 30.0, Path.FOLLOWED),
    ],
)
def test_the_wind_that_leaves_no_way_along_the_path(tail_mps: float, cross_mps: float, path: Path) -> None:
    watch = Watch(ENVELOPE)
    watch.note_path(0.0, tail_mps, cross_mps)
    assert watch.path is path


def test_a_gale_is_told_once_and_so_is_the_way_back() -> None:
    watch = Watch(ENVELOPE)
    told = []
    for cross_m, wind_mps in [
        (0, 30),
        (0, 42),
        (200, 48),
        (900, 40.5),
        (900, 38),
        (400, 41.5),
        (500, 30),
        (9, 30),
    ]:
        watch.note_path(float(cross_m), 0.0, float(wind_mps))
        told.append((watch.path, watch.take()))
    assert [path for path, _ in told] == [
        Path.FOLLOWED,
        Path.BLOWN_OFF,
        Path.BLOWN_OFF,
        Path.BLOWN_OFF,  # not yet calm enough
        Path.RETURNING,
        Path.BLOWN_OFF,
        Path.RETURNING,
        Path.FOLLOWED,
    ]
    assert [news for _, news in told if news] == [
        ["wind above airspeed: 42 m/s, heading into it at 41 m/s"],
        ["wind below airspeed: returning to the path, 900 m off"],
        ["wind above airspeed: 42 m/s, heading into it at 41 m/s"],
        ["wind below airspeed: returning to the path, 500 m off"],
        ["back on the path"],
    ]


def test_a_delay_is_told_as_it_grows_and_when_it_is_made_good() -> None:
    watch = Watch(ENVELOPE)
    told = []
    for late_s in [4.0, 5.5, 6.0, 14.0, 15.5, 20.0, 31.0, 12.0, 0.5, 0.4]:
        watch.note_schedule(late_s, End.FASTEST)
        told += watch.take()
    assert told == [
        "schedule: at the fastest, late by 6 s",
        "schedule: at the fastest, late by 16 s",
        "schedule: at the fastest, late by 31 s",
        "schedule: kept again",
    ]


def test_early_at_the_slowest_is_told_too_and_what_airspeed_can_mend_is_not() -> None:
    watch = Watch(ENVELOPE)
    watch.note_schedule(-35.0, End.FASTEST)
    watch.note_schedule(35.0, End.SLOWEST)
    assert watch.take() == []
    watch.note_schedule(-35.0, End.SLOWEST)
    assert watch.take() == ["schedule: at the slowest, early by 35 s"]
    watch.note_schedule(0.2, End.NEITHER)
    assert watch.take() == ["schedule: kept again"]
