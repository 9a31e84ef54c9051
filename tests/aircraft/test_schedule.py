from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aircraft.envelope import Envelope
from aircraft.reference import PathPoint, Reference
from aircraft.schedule import End, Schedule

ENVELOPE = Envelope(
    airspeed_min_mps=20.0,
    airspeed_max_mps=41.0,
    cruise_mps=27.0,
    climb_max_mps=3.0,
    descent_max_mps=3.0,
    bank_max_rad=math.radians(35.0),
    ceiling_m=2000.0,
)


def reference(scale: float = 1.0) -> Reference:
    """North for 3.6 km, then east, at 30 m/s over ground."""
    places = [(0.0, 0.0, 0.0), (3600.0, 0.0, 120.0), (3600.0, 3600.0, 240.0)]
    points = [PathPoint(scale * n, scale * e, 1000.0, time_s, scale) for n, e, time_s in places]
    return Reference.through(points, turn_radius_m=300.0, loiter_radius_m=500.0, lead_in_s=0.0)


def asked(
    schedule: Schedule,
    path_m: float = 1000.0,
    late_s: float = 0.0,
    wind: tuple[float, float] = (0.0, 0.0),
    tan_bank: float = 0.0,
) -> float:
    return schedule.airspeed_mps(path_m, schedule.reference.target(path_m), 30.0, late_s, tan_bank, *wind)


def test_on_time_the_wind_triangle_decides() -> None:
    schedule = Schedule(reference(), ENVELOPE)
    planned_mps = schedule.reference.at(1000.0).speed_mps
    assert asked(schedule) == pytest.approx(planned_mps)
    assert asked(schedule, wind=(-5.0, 0.0)) == pytest.approx(planned_mps + 5.0)
    assert asked(schedule, wind=(0.0, 12.0)) == pytest.approx(math.hypot(planned_mps, 12.0))


def test_late_is_faster_with_some_power_in_reserve_and_early_slower_but_no_slower_than_safe() -> None:
    schedule = Schedule(reference(), ENVELOPE)
    assert asked(schedule) < asked(schedule, late_s=0.5) < asked(schedule, late_s=1.0)
    assert asked(schedule, late_s=100.0) == pytest.approx(36.0)
    assert schedule.end is End.FASTEST
    assert asked(schedule, late_s=-1.0) < asked(schedule)
    assert asked(schedule, late_s=-100.0) == ENVELOPE.airspeed_min_mps
    assert schedule.end is End.SLOWEST
    assert asked(schedule, late_s=-100.0, tan_bank=math.tan(math.radians(35.0))) == pytest.approx(
        ENVELOPE.airspeed_min_mps / math.sqrt(math.cos(math.radians(35.0)))
    )


def test_a_schedule_that_needs_the_highest_airspeed_gets_it() -> None:
    assert asked(Schedule(reference(), ENVELOPE), wind=(-14.0, 0.0)) == ENVELOPE.airspeed_max_mps


def test_the_gust_along_is_added_within_bounds() -> None:
    schedule = Schedule(reference(), ENVELOPE)
    calm_mps = asked(schedule)
    for _ in range(100):
        schedule.note_gust(29.0, 27.0, 0.1)
    assert asked(schedule) == pytest.approx(calm_mps + 2.0)
    for _ in range(100):
        schedule.note_gust(60.0, 27.0, 0.1)
    assert asked(schedule) == pytest.approx(calm_mps + schedule.gains.gust_max_mps)
    for _ in range(100):
        schedule.note_gust(0.0, 27.0, 0.1)
    assert asked(schedule, late_s=-100.0) == ENVELOPE.airspeed_min_mps


@given(st.floats(0.0, 7000.0), st.floats(0.9, 1.1))
@settings(derandomize=True, deadline=None, max_examples=100)
def test_from_the_speed_limit_on_every_curve_ahead_can_be_slowed_down_for(
    path_m: float, scale: float
) -> None:
    schedule = Schedule(reference(scale), ENVELOPE)
    limit_mps = schedule.speed_limit_mps(path_m)
    step_m = 5.0
    for _ in range(200):  # braking as hard as it may, it never exceeds the limit further on
        point = schedule.reference.at(path_m)
        if point.curvature_radpm:
            across_mps2 = limit_mps**2 * abs(point.curvature_radpm)
            assert across_mps2 <= 0.851 * 9.80665 * math.tan(ENVELOPE.bank_max_rad)
        path_m += step_m
        slowed_mps = math.sqrt(
            max(limit_mps**2 - 2.0 * schedule.gains.slowing_mps2 * step_m / point.scale, 0.0)
        )
        assert schedule.speed_limit_mps(path_m) >= slowed_mps - 1e-6
        limit_mps = schedule.speed_limit_mps(path_m)


def test_the_limit_falls_toward_the_corner_and_is_none_behind_the_last() -> None:
    schedule = Schedule(reference(), ENVELOPE)
    far, near, turning = (schedule.speed_limit_mps(path_m) for path_m in (500.0, 3000.0, 3500.0))
    assert far > near > turning
    assert schedule.speed_limit_mps(6000.0) == math.inf
