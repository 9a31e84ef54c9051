from __future__ import annotations

import math
from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aircraft.errors import PathError
from aircraft.reference import PathPoint, Phase, Reference

TURN_M, LOITER_M, LEAD_IN_S, AIRSPEED_MPS = 250.0, 400.0, 30.0, 28.0
WIND = (6.0, -9.0)

QUARTERS = [0.0, math.pi / 2.0, math.pi, -math.pi / 2.0]
courses = st.one_of(st.sampled_from(QUARTERS), st.floats(-math.pi, math.pi))
waits = st.none()


@st.composite
def plans(draw: st.DrawFn, shortest_m: float = 150.0) -> list[PathPoint]:
    """Grid staircases, reversals, short and oblique legs, waits of one or several steps, and climbs."""
    north_m, east_m, altitude_m, time_s = 0.0, 0.0, 1000.0, 0.0
    scale = draw(st.floats(0.9, 1.1))
    points = [PathPoint(north_m, east_m, altitude_m, time_s, scale)]
    legs = st.tuples(courses, st.one_of(st.just(3600.0), st.floats(shortest_m, 4000.0)))
    for move in draw(st.lists(st.one_of(legs, legs, waits), min_size=1, max_size=8)):
        if move is None:
            time_s += 120.0
        else:
            course_rad, length_m = move
            north_m += scale * length_m * math.cos(course_rad)
            east_m += scale * length_m * math.sin(course_rad)
            time_s += length_m / 30.0
            altitude_m += draw(st.sampled_from([0.0, 40.0, -40.0]))
        points.append(PathPoint(north_m, east_m, altitude_m, time_s, scale))
    return points


def lay(points: list[PathPoint], wind: tuple[float, float] = WIND) -> Reference:
    return Reference.through(
        points,
        turn_radius_m=TURN_M,
        loiter_radius_m=LOITER_M,
        lead_in_s=LEAD_IN_S,
        wind_at=lambda *_: wind,
        loiter_airspeed_mps=AIRSPEED_MPS,
    )


def flat(*waypoints: tuple[float, float, float]) -> list[PathPoint]:
    return [PathPoint(north_m, east_m, 1000.0, time_s, 1.0) for north_m, east_m, time_s in waypoints]


def is_wait(points: list[PathPoint], i: int) -> bool:
    return any(points[i][:2] == points[j][:2] for j in (i - 1, i + 1) if 0 <= j < len(points))


def corner_radius_m(leg_m: float) -> float:
    """What a corner has at least: its tangents take half the leg, and are 1 + sqrt(3) radii at most."""
    return min(TURN_M, leg_m / 2.0 / (1.0 + math.sqrt(3.0)))


BANKED_MPS2 = 0.72 * 9.80665 * math.tan(math.radians(35.0))


def widest_radius_m(before: PathPoint, point: PathPoint, after: PathPoint) -> float:
    """What a corner has at most: the bank's share, at the fastest over ground on any course at all."""
    airspeeds = []
    for a, b in ((before, point), (point, after)):
        taken_s = (b.time_s - a.time_s) * a.scale
        north_mps, east_mps = (b.north_m - a.north_m) / taken_s, (b.east_m - a.east_m) / taken_s
        airspeeds.append(math.hypot(north_mps - WIND[0], east_mps - WIND[1]))
    return max(TURN_M, (max(airspeeds) + math.hypot(*WIND)) ** 2 / BANKED_MPS2)


@given(plans())
@settings(derandomize=True, deadline=None, max_examples=120)
def test_position_follows_course_without_a_break(points: list[PathPoint]) -> None:
    reference = lay(points)
    step_m = 0.5
    path_m = np.arange(0.0, reference.end_m, step_m)
    along = reference.at_many(path_m)
    course = reference.at_many(path_m[:-1] + step_m / 2.0).course_rad
    steepest = np.abs(reference.curvature).max()
    north, east = np.diff(along.north_m), np.diff(along.east_m)

    assert np.hypot(north, east).max() <= step_m + 1e-6
    off_course = np.abs(-north * np.sin(course) + east * np.cos(course)) / step_m
    assert off_course.max() <= steepest * step_m + 1e-4  # the sine of an angle
    assert (north * np.cos(course) + east * np.sin(course)).min() > 0.0


@given(plans())
@settings(derandomize=True, deadline=None, max_examples=120)
def test_curvature_is_bounded_by_the_radii(points: list[PathPoint]) -> None:
    reference = lay(points)
    shortest_m = min(
        (d for a, b in pairwise(points) if (d := math.dist(a[:2], b[:2]) / a.scale) > 1.0), default=math.inf
    )
    widest = {Phase.TURN: corner_radius_m(shortest_m), Phase.LOITER: min(LOITER_M, shortest_m / 2.0 / 2.74)}
    for i in range(len(reference.start_m)):
        curvature = abs(reference.curvature[i] * reference.scale[i])
        if reference.phase[i] in (Phase.LEG, Phase.LEAD_IN):
            assert curvature == 0.0
        else:  # a loiter and its transitions have at least 0.45 of the widest circle, to fit the time
            assert curvature <= 1.0 / (0.45 * min(widest.values())) + 1e-9
        if reference.phase[i] == Phase.TURN and not any(is_wait(points, k) for k in range(len(points))):
            assert curvature <= 1.0 / widest[Phase.TURN] + 1e-9


@given(plans())
@settings(derandomize=True, deadline=None, max_examples=120)
def test_waypoints_are_passed_in_time_at_height_and_no_further_than_the_corner_cut(
    points: list[PathPoint],
) -> None:
    reference = lay(points)
    assert reference.start_time_s[0] == -LEAD_IN_S
    assert reference.end_time_s[-1] == points[-1].time_s
    np.testing.assert_array_equal(reference.start_time_s[1:], reference.end_time_s[:-1])
    assert (reference.end_time_s > reference.start_time_s).all()
    assert (np.diff(reference.waypoint_path_m) > 0.0).all()

    for i, point in enumerate(points):
        passed = reference.at(reference.waypoint_path_m[i])
        assert passed.time_s == pytest.approx(point.time_s, abs=1e-6)
        assert passed.altitude_m == pytest.approx(point.altitude_m, abs=1e-3)
        away_m = math.dist(passed[:2], point[:2]) / point.scale
        if is_wait(points, i):
            assert away_m <= 2.0 * LOITER_M
        elif i in (0, len(points) - 1):
            assert away_m < 1e-3
        else:
            before, after = points[i - 1], points[i + 1]
            turn_rad = math.remainder(
                math.atan2(after.east_m - point.east_m, after.north_m - point.north_m)
                - math.atan2(point.east_m - before.east_m, point.north_m - before.north_m),
                2.0 * math.pi,
            )
            sharp = abs(turn_rad) > math.radians(120.0)
            radius_m = widest_radius_m(before, point, after)
            cut_m = 0.0 if sharp else radius_m * (1.0 / math.cos(turn_rad / 2.0) - 1.0)
            assert away_m <= cut_m + 1e-3


@given(
    plans(),
    st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(-60.0, 60.0), st.floats(-40.0, 40.0)), min_size=20),
)
@settings(derandomize=True, deadline=None, max_examples=120)
def test_projection_finds_the_nearest_point_in_its_window(
    points: list[PathPoint], samples: list[tuple[float, float, float]]
) -> None:
    reference = lay(points)
    for share, right_m, ahead_m in samples:
        path_m = share * reference.end_m
        there = reference.at(path_m)
        north_m = there.north_m - right_m * math.sin(there.course_rad)
        east_m = there.east_m + right_m * math.cos(there.course_rad)
        near_m = min(max(path_m + ahead_m, 0.0), reference.end_m)
        found = reference.project(north_m, east_m, near_m)

        nearest = reference.at(found.path_m)
        distance_m = math.dist(nearest[:2], (north_m, east_m))
        assert abs(found.cross_track_m) * nearest.scale <= distance_m + 1e-6

        window = np.linspace(max(near_m - 150.0, 0.0), min(near_m + 150.0, reference.end_m), 601)
        sampled = reference.at_many(window)
        cost = (
            (sampled.north_m - north_m) ** 2 + (sampled.east_m - east_m) ** 2 + 1e-4 * (window - near_m) ** 2
        )
        assert distance_m**2 + 1e-4 * (found.path_m - near_m) ** 2 <= cost.min() + 0.05


@given(plans(), st.floats(0.0, 1.0))
@settings(derandomize=True, deadline=None, max_examples=120)
def test_projection_inverts_at(points: list[PathPoint], share: float) -> None:
    reference = lay(points)
    path_m = share * reference.end_m
    there = reference.at(path_m)
    found = reference.project(there.north_m, there.east_m, path_m)
    assert found.path_m == pytest.approx(path_m, abs=1e-4)
    assert found.cross_track_m == pytest.approx(0.0, abs=1e-4)
    assert reference.path_at_time(there.time_s) == pytest.approx(path_m, abs=1e-3)


@given(plans(shortest_m=1500.0), st.floats(-300.0, 1500.0), st.floats(0.0, 3.0))
@settings(derandomize=True, deadline=None, max_examples=120)
def test_a_late_flight_is_found_where_it_is(points: list[PathPoint], late_m: float, off_m: float) -> None:
    reference = lay(points)
    time_s = np.arange(-LEAD_IN_S, points[-1].time_s, 0.5)
    expected_m = reference.path_at_times(time_s)
    grown = np.clip(np.linspace(0.0, 4.0, len(time_s)), 0.0, 1.0)  # lateness comes gradually
    flown_m = np.clip(expected_m - late_m * grown, 0.0, reference.end_m)
    off = off_m * np.sin(time_s / 7.0)
    there = reference.at_many(flown_m)
    north_m = there.north_m - off * np.sin(there.course_rad) * there.scale
    east_m = there.east_m + off * np.cos(there.course_rad) * there.scale

    path_m, cross_m = reference.project_many(north_m, east_m, expected_m)

    np.testing.assert_allclose(path_m, flown_m, atol=3.0)
    np.testing.assert_allclose(cross_m, off, atol=0.3)
    for i in range(0, len(path_m), 29):
        alone = reference.project(north_m[i], east_m[i], path_m[i])
        assert alone.path_m == pytest.approx(path_m[i], abs=0.2)
        assert alone.cross_track_m == pytest.approx(cross_m[i], abs=0.2)


def test_a_right_angle_is_cut_by_its_fillet_and_passed_half_way_at_the_waypoints_time() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (3600, 3600, 240)), wind=(0.0, 0.0))
    passed = reference.at(reference.waypoint_path_m[1])
    cut_m = TURN_M * (math.sqrt(2.0) - 1.0)
    assert math.dist(passed[:2], (3600.0, 0.0)) == pytest.approx(cut_m)
    assert passed.north_m < 3600.0
    assert passed.east_m > 0.0
    assert passed.course_rad == pytest.approx(math.pi / 4.0)
    assert passed.curvature_radpm == pytest.approx(1.0 / TURN_M)
    assert passed.speed_mps == pytest.approx((3600.0 - TURN_M + TURN_M * math.pi / 4.0) / 120.0)


def test_corners_between_fast_legs_are_wider() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (3600, 3600, 200)), wind=(0.0, 0.0))
    passed = reference.at(reference.waypoint_path_m[1])
    assert passed.curvature_radpm * (3600.0 / 80.0) ** 2 == pytest.approx(BANKED_MPS2)


def test_a_corner_into_a_tailwind_is_as_wide_as_its_end_asks() -> None:
    points = flat((0, 0, 0), (3600, 0, 150), (3600, 3600, 233))  # 28 m/s of airspeed in 15 m/s to the east
    into = lay(points, wind=(0.0, 15.0)).at_many(np.linspace(0.0, 9000.0, 9000))
    fastest_mps = math.hypot(24.0, 15.0) + 15.0
    assert np.abs(into.curvature_radpm).max() * fastest_mps**2 == pytest.approx(BANKED_MPS2, rel=0.02)


@given(plans())
@settings(derandomize=True, deadline=None, max_examples=60)
def test_between_waypoints_one_airspeed_is_asked_for(points: list[PathPoint]) -> None:
    reference = lay(points)
    middle = reference.at_many(reference.start_m + reference.length_m / 2.0)
    airspeed = np.hypot(
        middle.speed_mps * np.cos(middle.course_rad) - WIND[0],
        middle.speed_mps * np.sin(middle.course_rad) - WIND[1],
    )
    for a, b in pairwise(points):
        between = (middle.time_s > a.time_s) & (middle.time_s < b.time_s)
        if a[:2] != b[:2] and middle.speed_mps[between].min() > 8.0:  # no slower are times laid
            assert airspeed[between] == pytest.approx(airspeed[between].mean(), rel=1e-6)


def test_a_reversal_passes_the_waypoint_and_comes_back_on_the_same_line() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (0, 0, 240)), wind=(0.0, 0.0))
    turning = reference.phase == Phase.TURN
    assert math.dist(reference.at(reference.waypoint_path_m[1])[:2], (3600.0, 0.0)) < 1e-6
    assert reference.length_m[turning].sum() == pytest.approx(TURN_M * math.radians(60 + 300 + 60))
    assert reference.at(reference.end_m - 100.0).east_m == pytest.approx(0.0, abs=1e-6)
    assert reference.at_many(np.linspace(0, reference.end_m, 2000)).north_m.max() <= 3600.0 + 1e-6


def test_points_in_line_and_tiny_changes_of_course_make_no_detour() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (7200, 0.001, 240), (10800, 1.0, 360)))
    assert reference.end_m == pytest.approx(10800.0 + LEAD_IN_S * 30.0, abs=0.01)
    assert reference.waypoint_path_m[-1] == reference.end_m


def test_stretched_planes_keep_true_radii_and_speeds() -> None:
    points = [
        PathPoint(2.0 * n, 2.0 * e, 0.0, t, 2.0) for n, e, t in [(0, 0, 0), (3600, 0, 120), (3600, 3600, 240)]
    ]
    stretched, plain = lay(points), lay(flat((0, 0, 0), (3600, 0, 120), (3600, 3600, 240)))
    np.testing.assert_allclose(stretched.length_m, 2.0 * plain.length_m)
    mine, theirs = stretched.at(0.6 * stretched.end_m), plain.at(0.6 * plain.end_m)
    assert mine.speed_mps == pytest.approx(theirs.speed_mps)
    assert mine.curvature_radpm == pytest.approx(theirs.curvature_radpm)
    off = stretched.project(mine.north_m, mine.east_m + 20.0, 0.6 * stretched.end_m)
    assert abs(off.cross_track_m) <= 10.0 + 1e-9


@pytest.mark.parametrize(
    "points",
    [
        flat((0, 0, 0), (3600, 0, 120), (3600, 0, 240), (3600, 0, 360), (7200, 0, 480)),
        flat((0, 0, 0), (3600, 0, 120), (3600, 0, 360), (3600, -3600, 480)),
        flat((0, 0, 0), (3600, 0, 120), (3600, 0, 240), (0, 0, 360)),
        flat((0, 0, 0), (0, 0, 120), (3600, 0, 240)),
        flat((0, 0, 0), (3600, 0, 120), (3600, 0, 1320)),
        flat((0, 0, 0), (0, 0, 90)),
    ],
    ids=["straight on", "with a left turn", "with a reversal", "at the start", "at the goal", "nothing else"],
)
def test_a_wait_is_whole_laps_through_the_waypoint_at_one_airspeed(points: list[PathPoint]) -> None:
    reference = lay(points)
    first = next(i for i, (a, b) in enumerate(pairwise(points)) if a[:2] == b[:2])
    last = max(i for i, point in enumerate(points) if point[:2] == points[first][:2])
    begin, end = (
        reference.at(reference.waypoint_path_m[first]),
        reference.at(reference.waypoint_path_m[last] - 1e-9),
    )
    assert math.dist(begin[:2], points[first][:2]) < 1e-6
    assert math.dist(end[:2], points[first][:2]) < 1e-6
    assert (begin.time_s, end.time_s) == pytest.approx((points[first].time_s, points[last].time_s))
    laps = abs(math.remainder(end.course_rad - begin.course_rad, 2.0 * math.pi))
    assert laps == pytest.approx(0.0, abs=1e-6)

    path_m = np.arange(reference.waypoint_path_m[first], reference.waypoint_path_m[last], 1.0)
    there = reference.at_many(path_m)
    assert (there.phase == Phase.LOITER).all()
    assert (
        np.hypot(there.north_m - points[first].north_m, there.east_m - points[first].east_m).max()
        <= 2 * LOITER_M
    )
    airspeed = np.hypot(
        there.speed_mps * np.cos(there.course_rad) - WIND[0],
        there.speed_mps * np.sin(there.course_rad) - WIND[1],
    )
    assert airspeed.mean() == pytest.approx(AIRSPEED_MPS, rel=0.02)
    assert np.abs(airspeed - AIRSPEED_MPS).max() < 2.5  # each arc has one ground speed


def test_a_long_wait_keeps_its_time_while_the_wind_turns() -> None:
    reference = Reference.through(
        flat((0, 0, 0), (3600, 0, 120), (3600, 0, 7320), (7200, 0, 7440)),
        turn_radius_m=TURN_M,
        loiter_radius_m=LOITER_M,
        lead_in_s=0.0,
        wind_at=lambda _north, _east, time_s: (12 * math.cos(time_s / 2000), 12 * math.sin(time_s / 2000)),
        loiter_airspeed_mps=AIRSPEED_MPS,
    )
    begin_m, end_m = reference.waypoint_path_m[1:3].tolist()
    there = reference.at_many(np.linspace(begin_m, end_m, 20000, endpoint=False))
    wind_north, wind_east = 12 * np.cos(there.time_s / 2000), 12 * np.sin(there.time_s / 2000)
    airspeed = np.hypot(
        there.speed_mps * np.cos(there.course_rad) - wind_north,
        there.speed_mps * np.sin(there.course_rad) - wind_east,
    )
    assert airspeed.mean() == pytest.approx(AIRSPEED_MPS, rel=0.02)
    assert 1.0 / there.curvature_radpm.max() > 0.9 * LOITER_M


def test_at_and_at_many_agree() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (3600, 0, 240), (3600, 3600, 360), (0, 3600, 480)))
    path_m = np.linspace(-10.0, reference.end_m + 10.0, 500)
    many = reference.at_many(path_m)
    for i, distance_m in enumerate(path_m):
        np.testing.assert_allclose(
            reference.at(distance_m), [column[i] for column in many], rtol=1e-12, atol=1e-9
        )


def test_a_reference_can_be_rebuilt_from_its_arrays() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (3600, 3600, 240)))
    again = Reference(**{field.name: getattr(reference, field.name).copy() for field in fields(reference)})
    assert again.at(3000.0) == reference.at(3000.0)
    assert again.project(3000.0, 3.0, 3000.0) == reference.project(3000.0, 3.0, 3000.0)
    with pytest.raises(ValueError, match="read-only"):
        again.north_m[0] = 1.0
    with pytest.raises(PathError, match="scale has the shape"):
        replace(reference, scale=reference.scale[1:])


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (flat((0, 0, 0)), "two waypoints or more, not 1"),
        ([], "two waypoints or more, not 0"),
        (flat((0, 0, 0), (3600, 0, 120), (3600, 0, 120)), "waypoint 2 .* drop one"),
        (flat((0, 0, 0), (3600, 0, 120), (7200, 0, 100)), "waypoint 2 .* let the times rise"),
        (flat((0, 0, 0), (math.nan, 0, 120)), "waypoint 1 is not finite"),
        (
            flat((0, 0, 0), (3600, 0, 120), (3600, 0, 130), (7200, 0, 250)),
            "waypoint 1 is shorter than half a lap",
        ),
    ],
)
def test_impossible_paths_are_refused(points: list[PathPoint], message: str) -> None:
    with pytest.raises(PathError, match=message):
        lay(points)


def test_a_loiter_in_too_strong_a_wind_is_refused() -> None:
    with pytest.raises(PathError, match=r"wind of 25\.0 m/s at waypoint 1 .* \(limit 22\.4 m/s"):
        lay(flat((0, 0, 0), (3600, 0, 120), (3600, 0, 360)), wind=(15.0, 20.0))


def test_a_lap_is_not_mistaken_for_another_by_a_flight_late_by_more_than_one() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (3600, 0, 1320), (7200, 0, 1440)))
    time_s = np.arange(0.0, 1440.0, 0.1)
    expected_m = reference.path_at_times(time_s)
    flown_m = expected_m * 0.9  # at the end late by more than a lap
    there = reference.at_many(flown_m)
    path_m, cross_m = reference.project_many(there.north_m, there.east_m, expected_m)
    assert (expected_m - flown_m).max() > 2.0 * math.pi * LOITER_M
    np.testing.assert_allclose(path_m, flown_m, atol=1e-3)
    np.testing.assert_allclose(cross_m, 0.0, atol=1e-3)


def test_a_flight_is_followed_to_the_end_however_late_it_comes_there() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (3600, 3600, 240)))
    time_s = np.arange(0.0, 600.0, 0.1)
    flown_m = np.minimum(time_s * 15.0, reference.end_m)  # half as fast as planned
    there = reference.at_many(flown_m)
    path_m, cross_m = reference.project_many(there.north_m, there.east_m, reference.path_at_times(time_s))
    np.testing.assert_allclose(path_m, flown_m, atol=1e-3)
    np.testing.assert_allclose(cross_m, 0.0, atol=1e-3)


@given(plans(), st.lists(st.floats(-0.1, 1.1), min_size=1, max_size=20))
@settings(derandomize=True, deadline=None, max_examples=100)
def test_a_target_is_the_point_without_its_position(points: list[PathPoint], shares: list[float]) -> None:
    reference = lay(points)
    for share in shares:  # to and fro, so that remembered stretches are left and entered again
        point, target = reference.at(share * reference.end_m), reference.target(share * reference.end_m)
        for name in target._fields[:-1]:
            assert getattr(target, name) == pytest.approx(getattr(point, name), rel=1e-12, abs=1e-7), name


@given(plans(), st.lists(st.floats(-0.1, 1.1), min_size=1, max_size=20), st.floats(0.0, 0.999))
@settings(derandomize=True, deadline=None, max_examples=100)
def test_a_target_says_how_far_it_holds(points: list[PathPoint], shares: list[float], onward: float) -> None:
    reference = lay(points)
    for share in shares:
        path_m = share * reference.end_m
        target = reference.target(path_m)
        if target.straight_to_m == -math.inf:
            assert target.curvature_radpm
            continue
        to_m = min(target.straight_to_m, 2.0 * reference.end_m)
        assert to_m > path_m
        assert reference.target(path_m + onward * (to_m - path_m))[2:] == target[2:]


def test_a_target_where_segments_meet_is_the_later_ones() -> None:
    reference = lay(flat((0.0, 0.0, 0.0), (3000.0, 0.0, 100.0), (3000.0, 3000.0, 200.0)))
    for start_m in reference.start_m.tolist():
        assert reference.target(start_m)[3:-1] == (*reference.at(start_m)[5:8], reference.at(start_m).phase)
