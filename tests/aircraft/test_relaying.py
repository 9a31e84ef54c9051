"""References laid anew: continuous in themselves, and with the one that they follow."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from aircraft.errors import PathError
from aircraft.holding import Hold, HoldLimits, MayHold, lay_hold
from aircraft.laying import banked_radius_m
from aircraft.path import Segment
from aircraft.reference import PathPoint, Phase, Reference
from aircraft.relaying import with_detour

BANK_RAD = math.radians(35.0)
LIMITS = HoldLimits(radius_min_m=250.0, radius_max_m=550.0, airspeed_mps=28.0, bank_max_rad=BANK_RAD)


@st.composite
def references(draw: st.DrawFn) -> Reference:
    """Legs on any course, climbs among them, and waits."""
    scale = draw(st.floats(0.9, 1.2))
    north_m, east_m, altitude_m, time_s = 0.0, 0.0, 1000.0, 0.0
    points = [PathPoint(north_m, east_m, altitude_m, time_s, scale)]
    legs = st.tuples(st.floats(-math.pi, math.pi), st.floats(2000.0, 6000.0), st.booleans())
    for course_rad, length_m, waits in draw(st.lists(legs, min_size=1, max_size=5)):
        north_m += scale * length_m * math.cos(course_rad)
        east_m += scale * length_m * math.sin(course_rad)
        altitude_m += draw(st.sampled_from([0.0, 40.0, -40.0]))
        time_s += length_m / 30.0
        points.append(PathPoint(north_m, east_m, altitude_m, time_s, scale))
        if waits:
            time_s += 120.0
            points.append(points[-1]._replace(time_s=time_s))
    return Reference.through(
        points,
        turn_radius_m=250.0,
        loiter_radius_m=500.0,
        lead_in_s=20.0,
        wind_at=lambda *_: (4.0, -6.0),
        bank_max_rad=BANK_RAD,
    )


def anywhere(*_: float) -> bool:
    return True


winds = st.tuples(st.floats(-13.0, 13.0), st.floats(-13.0, 13.0))


@settings(max_examples=80)
@given(references(), st.floats(0.0, 1.0), st.floats(60.0, 900.0), winds)
def test_a_hold_takes_over_without_a_jump_and_gives_back_on_time(
    assert_continuous: Callable[..., None],
    assert_same_place: Callable[..., None],
    old: Reference,
    share: float,
    early_s: float,
    wind: tuple[float, float],
) -> None:
    path_m = share * float(old.waypoint_path_m[-1])
    hold = lay_hold(old, path_m, early_s, LIMITS, wind, anywhere)
    assume(hold is not None)
    assert hold is not None
    new, wait_s = hold.reference, hold.until_s - hold.from_s
    assert_continuous(new)
    assert 0.0 < wait_s <= early_s + 1e-9
    assert_same_place(old, path_m, new, 0.0, -wait_s)
    assert_same_place(old, hold.path_m - 1.0, new, hold.path_m - path_m - 1.0, -wait_s)
    longer_m = new.end_m - (old.end_m - path_m)
    for onward in np.linspace(hold.path_m + 1.0, old.end_m - 1.0, 7).tolist():
        assert_same_place(old, onward, new, onward - path_m + longer_m, 0.0)
    left = old.waypoint_path_m > path_m
    assert new.waypoint_path_m == pytest.approx(old.waypoint_path_m[left] - path_m + longer_m, abs=1e-5)
    check_circle(old, hold, wind)


def check_circle(old: Reference, hold: Hold, wind: tuple[float, float]) -> None:
    """Whole laps of one circle beside the path, as wide as the wind asks and no wider than allowed."""
    new = hold.reference
    first = int(np.argmax(new.curvature != 0.0))
    arcs = slice(first, first + 16 * hold.laps)
    assert np.all(new.phase[arcs] == Phase.LOITER)
    assert new.phase[first + 16 * hold.laps] == Phase.LEG
    radius_m = 1.0 / new.curvature[first] / new.scale[first]
    fastest_mps = LIMITS.airspeed_mps + math.hypot(*wind)
    assert max(250.0, banked_radius_m(fastest_mps, BANK_RAD)) <= radius_m * (1.0 + 1e-9)
    assert radius_m <= LIMITS.radius_max_m * (1.0 + 1e-9)
    assert new.length_m[arcs].sum() == pytest.approx(2.0 * math.pi * hold.laps / new.curvature[first])
    speed_mps = new.length_m[arcs] / new.scale[arcs] / (new.end_time_s[arcs] - new.start_time_s[arcs])
    course_rad = new.course_rad[arcs] + 0.5 * new.curvature[arcs] * new.length_m[arcs]
    through = np.hypot(speed_mps * np.cos(course_rad) - wind[0], speed_mps * np.sin(course_rad) - wind[1])
    assert through == pytest.approx(LIMITS.airspeed_mps, rel=0.03)
    away_m = np.hypot(new.north_m[arcs] - new.north_m[first], new.east_m[arcs] - new.east_m[first])
    assert away_m.max() <= 2.0 * LIMITS.radius_max_m * new.scale[first] * (1.0 + 1e-9)
    assert old.at(hold.path_m).phase is Phase.LEG


def straight(length_m: float = 20_000.0) -> Reference:
    points = [PathPoint(0.0, 0.0, 1000.0, 0.0, 1.0), PathPoint(length_m, 0.0, 1000.0, length_m / 30.0, 1.0)]
    return Reference.through(points, turn_radius_m=250.0, loiter_radius_m=500.0, lead_in_s=0.0)


STILL = (0.0, 0.0)


@pytest.mark.parametrize("early_s", [85.0, 110.0, 124.0, 140.0, 250.0, 600.0, 3600.0])
def test_all_of_the_time_is_lost_or_as_much_as_whole_laps_of_the_largest_circle_take(early_s: float) -> None:
    hold = lay_hold(straight(), 5000.0, early_s, LIMITS, STILL, anywhere)
    assert hold is not None
    lap_s = 2.0 * math.pi / LIMITS.airspeed_mps
    wait_s = hold.until_s - hold.from_s
    possible = math.floor(early_s / (lap_s * LIMITS.smallest_m(STILL)))
    if possible * lap_s * LIMITS.radius_max_m >= early_s:
        assert wait_s == pytest.approx(early_s)
    else:
        assert wait_s == pytest.approx(possible * lap_s * LIMITS.radius_max_m, rel=1e-3)
    assert hold.lap_s * hold.laps == pytest.approx(wait_s)


def test_less_than_a_lap_is_no_hold_and_the_limit_says_how_much_is() -> None:
    assert lay_hold(straight(), 5000.0, LIMITS.early_s - 0.1, LIMITS, STILL, anywhere) is None
    assert lay_hold(straight(), 5000.0, LIMITS.early_s + 0.1, LIMITS, STILL, anywhere) is not None
    assert lay_hold(straight(), 5000.0, LIMITS.early_s + 0.1, LIMITS, (10.0, 0.0), anywhere) is None


@pytest.mark.parametrize("wind", [(27.0, 0.0), (0.0, -23.0), (math.nan, 0.0)])
def test_no_hold_in_a_wind_that_is_too_strong(wind: tuple[float, float]) -> None:
    assert lay_hold(straight(), 5000.0, 2000.0, LIMITS, wind, anywhere) is None


def test_no_hold_where_it_is_not_safe_until_its_end() -> None:
    asked = []

    def safe_till(end_s: float) -> MayHold:
        def may_hold(north_m: float, east_m: float, until_s: float) -> bool:
            asked.append((north_m, east_m, until_s))
            return until_s <= end_s

        return may_hold

    hold = lay_hold(straight(), 5000.0, 200.0, LIMITS, STILL, safe_till(1000.0))
    assert hold is not None
    place = straight().at(hold.path_m)
    assert asked == [(place.north_m, place.east_m, hold.until_s)]
    assert lay_hold(straight(), 5000.0, 200.0, LIMITS, STILL, safe_till(hold.until_s - 1.0)) is None


def test_no_hold_where_no_circle_is_allowed() -> None:
    narrow = HoldLimits(250.0, 200.0, 28.0, BANK_RAD)
    assert lay_hold(straight(), 5000.0, 2000.0, narrow, STILL, anywhere) is None


def test_no_hold_at_a_corner_a_waypoint_a_wait_or_either_end() -> None:
    places = [
        (0.0, 0.0, 0.0),
        (6000.0, 0.0, 200.0),
        (12000.0, 0.0, 400.0),
        (12000.0, 6000.0, 600.0),
        (12000.0, 6000.0, 720.0),
        (12000.0, 12000.0, 920.0),
    ]
    points = [PathPoint(north_m, east_m, 1000.0, time_s, 1.0) for north_m, east_m, time_s in places]
    old = Reference.through(points, turn_radius_m=250.0, loiter_radius_m=500.0, lead_in_s=30.0)
    marks = old.waypoint_path_m.tolist()
    for path_m in np.arange(0.0, old.end_m, 37.0).tolist():
        hold = lay_hold(old, path_m, 150.0, LIMITS, STILL, anywhere)
        near = any(mark - 240.0 + 1e-6 < path_m < mark + 150.0 - 1e-6 for mark in marks)
        if near or old.at(path_m).phase is not Phase.LEG:
            assert hold is None, path_m
        if (
            not any(mark - 600.0 < path_m < mark + 600.0 for mark in marks)
            and old.at(path_m).phase is Phase.LEG
        ):
            assert hold is not None, path_m


@given(references(), st.floats(0.0, 0.9), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_any_place_may_be_where_a_reference_begins(
    assert_continuous: Callable[..., None], old: Reference, share: float, leave: float, rejoin: float
) -> None:
    last_m = float(old.waypoint_path_m[-1])
    from_m = share * last_m
    leave_m = from_m + leave * (last_m - from_m)
    new = with_detour(old, from_m, leave_m, [], leave_m)
    assert_continuous(new)
    assert new.end_m == pytest.approx(old.end_m - from_m)
    assert new.waypoint_path_m == pytest.approx(old.waypoint_path_m[old.waypoint_path_m > from_m] - from_m)
    for path_m in np.linspace(from_m, old.end_m, 9).tolist():
        was, now = old.at(path_m), new.at(path_m - from_m)
        assert now[:4] == pytest.approx(was[:4], abs=1e-5)
        assert math.remainder(now.course_rad - was.course_rad, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-8)


def test_a_detour_round_a_waypoint_passes_the_others(assert_continuous: Callable[..., None]) -> None:
    places = [(0.0, 0.0), (3000.0, 100.0), (6000.0, 200.0), (9000.0, 300.0)]
    points = [PathPoint(3000.0 * i, 0.0, 1000.0, time_s, 1.0) for i, (time_s, _) in enumerate(places)]
    old = Reference.through(points, turn_radius_m=250.0, loiter_radius_m=500.0, lead_in_s=0.0)
    chord = Segment(1000.0, 0.0, 0.0, 0.0, 4000.0, 1.0, Phase.LEG, 1100.0, 5000.0, 1000.0, 1000.0)
    new = with_detour(old, 500.0, 1000.0, [chord], 5000.0)
    assert new.waypoint_path_m == pytest.approx([5500.0, 8500.0])
    assert_continuous(new)


@pytest.mark.parametrize(
    ("from_m", "leave_m", "rejoin_m"),
    [(-1.0, 10.0, 10.0), (20.0, 10.0, 10.0), (0.0, 20.0, 10.0), (0.0, 10.0, 20_001.0), (20_000.0,) * 3],
)
def test_places_out_of_order_are_refused(from_m: float, leave_m: float, rejoin_m: float) -> None:
    with pytest.raises(PathError, match="lay another"):
        with_detour(straight(), from_m, leave_m, [], rejoin_m)
