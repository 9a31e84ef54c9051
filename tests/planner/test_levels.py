"""Plans that choose among levels: earlier or safe for it, within the climb, and nothing else without need."""

import math
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.closures import Closures, MemberHazard, closures_at_levels
from planner.errors import PlannerError
from planner.export import export
from planner.grid import Grid
from planner.hazards import StageClock
from planner.levels import Climbing, Levels, stacked
from planner.place import Place
from planner.planning import PlanningRequest, plan_staged
from planner.windaware import plan_windaware
from planner.windfield import WindField

STEP_DEG = 3600.0 / 111_000.0
ROWS, COLUMNS = 9, 26
GRID = Grid(
    math.radians(20.0), math.radians(-80.0), math.radians(STEP_DEG), math.radians(STEP_DEG), ROWS, COLUMNS
)
HEIGHT_M = np.array([500.0, 800.0, 1400.0])
TIME_S = np.arange(5) * 3600.0
CLIMBING = Climbing(3.0, 2.5)
THRESHOLD_MPS = 15.0


def place(name, row, column):
    return Place(name, 20.0 + row * STEP_DEG, -80.0 + column * STEP_DEG)


REQUEST = PlanningRequest(
    start=place("start", 4, 1),
    goals=(place("far", 4, 24), place("aside", 1, 12)),
    goal="far",
    altitude_m=500.0,
    clock=StageClock(0.0, stage_count=3),
    threshold_mps=THRESHOLD_MPS,
    corridor_m=1100.0,
    airspeed_min_mps=22.0,
    airspeed_max_mps=39.0,
    objective="earliest",
    cruise_mps=27.0,
    levels_m=(800.0, 1400.0),
    climbing=CLIMBING,
)
AT_LEVEL = replace(REQUEST, levels_m=(), climbing=None)


REQUEST_AT_ITS_OWN = replace(REQUEST, levels_m=(500.0,))


def wind_of(*east_mps, height_m=HEIGHT_M, paint=lambda *_: None):
    """One wind toward east at each height, painted over."""
    shape = (TIME_S.size, height_m.size, ROWS, COLUMNS)
    east = np.broadcast_to(np.array(east_mps)[:, np.newaxis, np.newaxis], shape).copy()
    north = np.zeros(shape)
    paint(north, east)
    return WindField(GRID, TIME_S, north, east, height_m=height_m)


def wall(height):
    """A storm across the way at one height, from one edge to the other."""

    def paint(_, east):
        east[:, height, :, 10:15] = 24.0

    return paint


def climb_rates(plan):
    return [(b.altitude_m - a.altitude_m) / (b.time_s - a.time_s) for a, b in pairwise(plan.waypoints)]


def flown(plan, wind, samples=15):
    """Along every leg, at the times and altitudes of the plan: airspeed (of moving legs) and wind speed."""
    frame = wind.grid.frame
    share = np.linspace(0.0, 1.0, samples)
    airspeeds, winds = [], []
    for a, b in pairwise(plan.waypoints):
        lat_rad, lon_rad = np.radians([[w.lat_deg, w.lon_deg] for w in (a, b)]).T
        north_m, east_m = frame.to_plane(lat_rad, lon_rad)
        lat, lon = frame.to_geodetic(
            north_m[0] + share * np.ptp(north_m) * np.sign(np.diff(north_m)),
            east_m[0] + share * np.diff(east_m),
        )
        took_s = b.time_s - a.time_s
        altitude_m = a.altitude_m + share * (b.altitude_m - a.altitude_m)
        north, east, _ = wind.at_many(a.time_s + share * took_s, lat, lon, altitude_m)
        winds.append(np.hypot(north, east))
        if np.hypot(*np.diff([north_m, east_m])[:, 0]) > 1.0:
            scale = np.array([frame.scale(float(value)) for value in lat])
            airspeeds.append(
                np.hypot(np.diff(north_m) / took_s / scale - north, np.diff(east_m) / took_s / scale - east)
            )
    return np.concatenate(airspeeds), np.concatenate(winds)


def test_it_climbs_out_of_a_head_wind_and_comes_down_at_the_end():
    wind = wind_of(-12.0, -9.0, 6.0)
    plan, low = plan_windaware(wind, REQUEST), plan_windaware(wind, AT_LEVEL)
    altitudes_m = [point.altitude_m for point in plan.waypoints]
    assert (altitudes_m[0], altitudes_m[-1], max(altitudes_m)) == (500.0, 500.0, 1400.0)
    assert plan.outcome.arrival_s < 0.75 * low.outcome.arrival_s
    assert [altitude_m for altitude_m, _ in plan.level_flight] == [500.0, 1400.0, 500.0]
    assert {point.altitude_m for point in low.waypoints} == {500.0}
    assert low.level_flight == ((500.0, 0.0),)


def test_only_another_level_leads_past_a_storm():
    wind = wind_of(0.0, 0.0, 0.0, paint=wall(0))
    plan, low = plan_windaware(wind, REQUEST), plan_windaware(wind, AT_LEVEL)
    assert not low.outcome.reachable
    assert plan.outcome.reachable
    _, winds = flown(plan, wind)
    assert winds.max() <= THRESHOLD_MPS
    assert max(point.altitude_m for point in plan.waypoints) == 800.0  # no higher than it has to


def test_a_height_between_two_levels_has_to_be_safe_to_pass():
    request = replace(REQUEST, levels_m=(1400.0,))
    calm = plan_windaware(wind_of(-12.0, 0.0, 6.0), request)
    jet = plan_windaware(wind_of(-12.0, 20.0, 6.0), request)
    assert max(point.altitude_m for point in calm.waypoints) == 1400.0
    assert {point.altitude_m for point in jet.waypoints} == {500.0}
    assert 800.0 not in [altitude_m for altitude_m, _ in calm.level_flight]


@pytest.mark.parametrize("name", ["way.geojson", "way.kml", "way.gpx", "way.plan", "way.waypoints"])
def test_exports_carry_the_altitudes(tmp_path, name):
    plan = plan_windaware(wind_of(-12.0, -9.0, 6.0), REQUEST)
    export(plan, tmp_path / name)
    text = (tmp_path / name).read_text(encoding="utf-8")
    for altitude_m in ("500", "1400"):
        assert re.search(rf"\b{altitude_m}(\.0+)?\b", text), altitude_m


def test_without_anything_to_gain_it_keeps_its_level():
    wind = wind_of(4.0, 4.0, 4.0)
    plan, low = plan_windaware(wind, REQUEST), plan_windaware(wind, AT_LEVEL)
    assert plan.waypoints == low.waypoints


def test_one_level_gives_the_same_plan_to_the_byte():
    def gusty(north, east):
        random = np.random.default_rng(5)
        north += random.uniform(-6.0, 6.0, north.shape)
        east += random.uniform(-6.0, 6.0, east.shape)
        east[:2, 0, 2:7, 8] = 22.0  # a door that opens

    one = wind_of(0.0, height_m=HEIGHT_M[:1], paint=gusty)
    for objective in ("earliest", "score"):
        today = plan_windaware(one.at_altitude(500.0), replace(AT_LEVEL, objective=objective))
        levels = replace(REQUEST_AT_ITS_OWN, objective=objective)
        assert plan_windaware(one, levels).to_json() == today.to_json()
    assert plan_windaware(one, AT_LEVEL).to_json() == plan_windaware(one, REQUEST_AT_ITS_OWN).to_json()


@settings(max_examples=4, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_every_leg_keeps_airspeed_threshold_and_climb(seed):
    random = np.random.default_rng(seed)

    def rough(north, east):
        for part in (north, east):
            coarse = random.normal(0.0, 9.0, (TIME_S.size, HEIGHT_M.size, 4, 8))
            rows, columns = np.linspace(0, 3, ROWS), np.linspace(0, 7, COLUMNS)
            for sheet in np.ndindex(coarse.shape[:2]):
                across = np.array([np.interp(columns, range(8), line) for line in coarse[sheet]])
                part[sheet] = np.array([np.interp(rows, range(4), line) for line in across.T]).T
        north[:, 0, 3:6, 0:3] = east[:, 0, 3:6, 0:3] = 0.0

    wind = wind_of(0.0, 0.0, 0.0, paint=rough)
    plan, low = plan_windaware(wind, REQUEST), plan_windaware(wind, AT_LEVEL)
    for with_levels, alone in zip(plan.goals, low.goals, strict=True):
        assert not alone.reachable or with_levels.arrival_s <= alone.arrival_s + 1e-6
    if plan.waypoints:
        rates = climb_rates(plan)
        assert -CLIMBING.down_mps * 1.001 <= min(rates) <= max(rates) <= CLIMBING.up_mps * 1.001
        airspeeds, winds = flown(plan, wind)
        assert winds.max() <= THRESHOLD_MPS + 0.05
        assert 24.0 < airspeeds.mean() < 27.2


def test_score_and_survival_choose_among_levels_too():
    wind = wind_of(-12.0, -9.0, 6.0)
    for objective, error_mps in (("score", 0.0), ("survival", 2.0)):
        asked = replace(REQUEST, objective=objective, forecast_error_mps=error_mps)
        plan = plan_windaware(wind, asked)
        low = plan_windaware(wind, replace(asked, levels_m=(), climbing=None))
        assert max(point.altitude_m for point in plan.waypoints) > 500.0
        figure = "score" if objective == "score" else "survival"
        assert getattr(plan.outcome, figure) > getattr(low.outcome, figure)


def test_closures_hold_at_the_levels_that_they_are_of():
    shape = (3, ROWS, COLUMNS)
    closed = [np.zeros(shape, dtype=np.bool_) for _ in HEIGHT_M]
    closed[1][:, :, 12] = True
    wind = wind_of(-12.0, 6.0, 5.0)
    free = plan_windaware(wind, REQUEST)
    plan = plan_windaware(
        wind, replace(REQUEST, closures=closures_at_levels([Closures(one) for one in closed]))
    )
    assert max(point.altitude_m for point in free.waypoints) == 800.0
    lon_deg = math.degrees(GRID.lon_rad[12])
    over = [point.altitude_m for point in plan.waypoints if abs(point.lon_deg - lon_deg) < STEP_DEG]
    assert plan.outcome.reachable
    assert over
    assert not set(over) & {800.0}


def test_closures_of_levels_are_stacked_with_hazard_between():
    random = np.random.default_rng(2)
    members = [random.random((4, 3, ROWS, COLUMNS)) < 0.3 for _ in range(2)]
    parts = [Closures(one[0], one.mean(axis=0), MemberHazard.packed(one)) for one in members]
    tall = closures_at_levels(parts)
    levels = Levels(HEIGHT_M[:2], np.array([True, True]), ROWS)
    for level, part in enumerate(parts):
        np.testing.assert_array_equal(levels.parts(tall.closed)[level], part.closed)
        np.testing.assert_array_equal(levels.parts(tall.chance)[level], part.chance)
        cell = (5, 7)
        visited = [(1, levels.cell(level, cell))]
        assert tall.members.survivors(visited) == part.members.survivors([(1, cell)])
        assert levels.split(levels.cell(level, cell)) == (level, cell)
    assert tall.closed[:, ROWS : ROWS + 2].all()


def test_sheets_are_stacked_lowest_first_with_rows_between():
    sheets = np.arange(12.0).reshape(3, 2, 2)
    tall = stacked(sheets, -1.0)
    assert tall.shape == (10, 2)
    assert (tall[2:4] == -1.0).all()
    np.testing.assert_array_equal(tall[4:6], sheets[1])
    assert stacked(sheets[:1], -1.0).shape == (2, 2)


@pytest.mark.parametrize(
    ("wind", "changes", "said"),
    [
        (
            wind_of(0.0, 0.0, 0.0),
            {"levels_m": (900.0,)},
            "not laid out at the level of 900 m, but at 500, 800",
        ),
        (wind_of(0.0, 0.0, 0.0).at_altitude(500.0), {}, "the same at all heights; leave it out"),
        (wind_of(0.0, 0.0, 0.0), {"climbing": None}, "rates of climbing, which is missing"),
    ],
)
def test_what_does_not_fit_is_refused(wind, changes, said):
    with pytest.raises(PlannerError, match=said):
        plan_windaware(wind, replace(REQUEST, **changes))


def test_rates_have_to_be_above_zero():
    with pytest.raises(PlannerError, match="both have to be above 0"):
        Climbing(3.0, 0.0)


def test_the_staged_planner_refuses_levels():
    wind = wind_of(0.0, 0.0, 0.0).at_altitude(500.0)
    with pytest.raises(PlannerError, match="take the wind-aware planner"):
        plan_staged(wind, REQUEST)
