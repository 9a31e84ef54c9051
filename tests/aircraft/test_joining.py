"""References left in flight for others: no jump in position, course, height or time."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from aircraft.errors import PathError
from aircraft.holding import HoldLimits, lay_hold
from aircraft.joining import Joint, joined, joints
from aircraft.reference import PathPoint, Phase, Reference

BANK_RAD = math.radians(35.0)
STEP_S = 120.0
CELL_M = 3600.0
SCALE = 1.1
TURN_RADIUS_M, LOITER_RADIUS_M = 250.0, 500.0
NORTH, EAST, SOUTH, WEST, STAY = (1, 0), (0, 1), (-1, 0), (0, -1), (0, 0)
moves = st.sampled_from([NORTH, EAST, SOUTH, WEST, STAY])


def through(points: list[PathPoint], circling_rad: float | None = None) -> Reference:
    return Reference.through(
        points,
        turn_radius_m=TURN_RADIUS_M,
        loiter_radius_m=LOITER_RADIUS_M,
        lead_in_s=0.0,
        wind_at=lambda *_: (4.0, -6.0),
        bank_max_rad=BANK_RAD,
        circling_rad=circling_rad,
    )


def walk(start: PathPoint, route: list[tuple[int, int]]) -> list[PathPoint]:
    """A plan on cells: a point a step, of a wait the first and the last."""
    points = [start]
    for north, east in route:
        last = points[-1]
        point = last._replace(
            north_m=last.north_m + north * CELL_M * SCALE,
            east_m=last.east_m + east * CELL_M * SCALE,
            time_s=last.time_s + STEP_S,
        )
        waits_on = len(points) > 1 and points[-2][:2] == last[:2] == point[:2]
        points[-1:] = [point] if waits_on else [last, point]
    return points


def start(altitude_m: float = 1000.0) -> PathPoint:
    return PathPoint(0.0, 0.0, altitude_m, 0.0, SCALE)


routes = st.lists(moves, min_size=6, max_size=14).filter(
    lambda route: sum(move != STAY for move in route) > 3 and route[0] != STAY
)
onwards = st.lists(moves, min_size=2, max_size=6).filter(lambda route: any(move != STAY for move in route))


def leave(
    old: Reference, points: list[PathPoint], joint: Joint, route: list[tuple[int, int]], steps: int
) -> Reference:
    """The path onward from a joint: some steps later than the old one is there, then along a route."""
    index = len(points) - len(old.waypoint_path_m) + joint.place
    if joint.circling:
        at = points[index]._replace(time_s=joint.time_s)
        first = at._replace(time_s=STEP_S * (math.ceil(joint.time_s / STEP_S) + 1 + steps))
        return through([at, *walk(first, route)], old.at(joint.path_m).course_rad)
    later = points[index]._replace(time_s=points[index].time_s + steps * STEP_S)
    return through([points[index - 1], *walk(later, route)])


@settings(max_examples=40, deadline=None)
@given(routes, st.floats(0.0, 0.95), onwards, st.integers(0, 3), st.sampled_from([0, 0, 0, 2]))
def test_any_plan_is_left_for_any_other_without_a_jump(
    assert_continuous: Callable[..., None],
    assert_same_place: Callable[..., None],
    route: list[tuple[int, int]],
    share: float,
    onward: list[tuple[int, int]],
    which: int,
    steps: int,
) -> None:
    points = walk(start(), route)
    old = through(points)
    path_m = share * old.end_m
    found = list(joints(old, points, path_m))
    assume(len(found) > which)
    joint = found[which]
    new = leave(old, points, joint, onward, steps)
    result = joined(old, path_m, joint, new)
    assert_continuous(result)
    moved_s = result.at(0.0).time_s - old.at(path_m).time_s
    assert moved_s == pytest.approx(0.0 if joint.circling else steps * STEP_S, abs=1e-6)
    for along_m in np.linspace(path_m, joint.path_m, 5).tolist():
        assert_same_place(old, along_m, result, along_m - path_m, moved_s)
    longer_m = result.end_m - new.end_m
    for along_m in np.linspace(0.0, 1.0, 7).tolist():
        behind_m = new.waypoint_path_m[1] + along_m * (new.end_m - new.waypoint_path_m[1])
        assert_same_place(new, behind_m, result, behind_m + longer_m, 0.0)
    assert result.waypoint_path_m[-1] == pytest.approx(result.end_m)
    assert np.all(np.diff(result.waypoint_path_m) > 0.0)
    tightest = max(np.abs(old.curvature * old.scale).max(), np.abs(new.curvature * new.scale).max())
    assert np.abs(result.curvature * result.scale).max() <= tightest * (1.0 + 1e-9)
    assert tightest < 1.0 / 180.0


@settings(max_examples=20, deadline=None)
@given(routes, st.floats(0.0, 1.0))
def test_joints_lie_ahead_in_order_on_straight_legs_and_at_the_ends_of_laps(
    route: list[tuple[int, int]], share: float
) -> None:
    points = walk(start(), route)
    old = through(points)
    path_m = share * old.end_m
    found = list(joints(old, points, path_m))
    assert [joint.path_m for joint in found] == sorted(joint.path_m for joint in found)
    for joint in found:
        assert joint.path_m >= path_m + 3.0 * old.at(path_m).speed_mps * SCALE - 1e-6
        at, point = old.at(joint.path_m), points[joint.place]
        if joint.circling:
            assert math.dist(at[:2], point[:2]) < 1e-3
            assert at.phase is Phase.LOITER
            assert joint.time_s == at.time_s
        else:
            assert at.phase is Phase.LEG
            assert math.dist(at[:2], point[:2]) >= CELL_M * SCALE / 2.0 - 1e-2
            assert joint.time_s == pytest.approx(point.time_s, abs=1e-6)


def test_each_leg_and_each_lap_but_the_last_is_a_place_to_leave() -> None:
    points = walk(start(), [NORTH, NORTH, EAST, STAY, STAY, STAY, NORTH, NORTH])
    old = through(points)
    found = list(joints(old, points, 0.0))
    assert [joint.circling for joint in found] == [False] * 3 + [True] * 4 + [False] * 2
    waits_s = [joint.time_s - 360.0 for joint in found if joint.circling]
    assert waits_s[0] == pytest.approx(0.0, abs=1e-6)  # when it is there, before the first lap
    assert np.diff([*waits_s, 360.0]) == pytest.approx(90.0, abs=10.0)
    later = list(joints(old, points, found[4].path_m - 10.0))
    assert later[0].path_m == pytest.approx(found[5].path_m)


def test_after_joining_the_next_joint_is_found_on_what_was_joined(
    assert_continuous: Callable[..., None],
) -> None:
    points = walk(start(), [NORTH] * 6)
    old = through(points)
    joint = next(joints(old, points, 5000.0))
    new = joined(old, 5000.0, joint, leave(old, points, joint, [EAST, EAST, NORTH], 0))
    amended = [*points[:2], *walk(points[2], [EAST, EAST, NORTH])]
    assert len(new.waypoint_path_m) == 4
    again = list(joints(new, amended, 100.0))
    assert [joint.place for joint in again] == [0, 1, 2, 3][-len(again) :]
    assert len(again) >= 3
    for found in again:
        assert_continuous(joined(new, 100.0, found, leave(new, amended, found, [SOUTH, WEST], 0)))


def test_a_leg_is_left_behind_the_hold_that_is_flown_on_it(assert_continuous: Callable[..., None]) -> None:
    points = walk(start(), [NORTH] * 4)
    old = through(points)
    limits = HoldLimits(250.0, 550.0, 28.0, BANK_RAD)
    hold = lay_hold(old, 4500.0, 150.0, limits, (0.0, 0.0), lambda *_: True)
    assert hold is not None
    held = hold.reference
    circle = np.flatnonzero(held.phase == Phase.LOITER)
    joint = next(joints(held, points, 0.0))
    end_m = held.start_m[circle[-1]] + held.length_m[circle[-1]]
    assert joint.path_m == pytest.approx(end_m)
    assert joint.place == 0
    assert_continuous(joined(held, 0.0, joint, leave(held, points, joint, [EAST, EAST], 0)))


def test_a_path_that_is_not_met_is_refused() -> None:
    points = walk(start(), [NORTH] * 4)
    old = through(points)
    joint = next(joints(old, points, 100.0))
    aside = [point._replace(east_m=point.east_m + 1.0) for point in points]
    with pytest.raises(PathError, match=r"lies 1\.000 m"):
        joined(old, 100.0, joint, through(aside))
    other = [points[0], points[1]._replace(north_m=0.0, east_m=CELL_M * SCALE)]
    with pytest.raises(PathError, match="deg off"):
        joined(old, 100.0, joint, through([*other, other[1]._replace(east_m=2 * CELL_M, time_s=400.0)]))


def test_the_time_at_the_next_waypoint_moves_the_schedule_before_it(
    assert_continuous: Callable[..., None],
) -> None:
    points = walk(start(), [NORTH] * 4)
    old = through(points)
    joint = next(joints(old, points, 100.0))
    result = joined(old, 100.0, joint, leave(old, points, joint, [EAST, EAST], 1))
    assert result.at(0.0).time_s == pytest.approx(old.at(100.0).time_s + STEP_S, abs=1e-6)
    assert result.at(float(result.waypoint_path_m[0])).time_s == pytest.approx(2.0 * STEP_S, abs=1e-6)
    assert_continuous(result)
