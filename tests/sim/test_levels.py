"""Flights that choose among levels: one flown, weather at levels, what is refused, what is recorded."""

import math
from pathlib import Path

import msgspec
import numpy as np
import pytest

import recordings
from planner.grid import Grid
from planner.hazards import StageClock
from planner.windfield import WindField
from recordings.recorder import Layer
from recordings.series import measure
from sim.comparison import compare_planners
from sim.departing import Departing
from sim.errors import SimError
from sim.job import Files, run
from sim.level_sheets import LevelLayer, LevelWatch
from sim.plan_job import PlanFiles, plan_job
from sim.plan_text import plan_lines
from sim.preparation import CLIMB_SHARE, make_aircraft, make_plan
from sim.scenario import load_scenario
from sim.weather.cf_writer import write_wind
from sim.weather.source import bring_weather
from sim.weather_job import Wanted, scenario_weather

COARSE = ("grid.cell_m=4000.0", "turbulence.kind=none")


@pytest.fixture(scope="module")
def jet(tmp_path_factory):
    """The demonstration as it ships, planned, flown and judged: what came of it, and its files."""
    files = Files(tmp_path_factory.mktemp("jet"))
    plans = []
    flown = run(
        load_scenario("jet"), files, on_plan=plans.append, on_time=lambda _: None, tell=lambda _: None
    )
    return flown, files, plans[0]


def test_the_demonstration_is_flown_over_the_jet_within_its_limits(jet):
    flown, files, _ = jet
    assert [verdict.limit for verdict in flown.verdicts if not verdict.passed] == []
    assert flown.tracking.arrived
    report = msgspec.json.decode(files.report.read_bytes())
    assert (report["level_changes"], report["levels_m"]) == (2, list(flown.tracking.levels_m))
    assert "2 changes" in flown.tracking.summary()


def test_climbs_are_followed_in_height_path_and_time(jet):
    flown, files, _ = jet
    series = measure(recordings.open(files.mcap))
    reference = flown.tracking.recording.header.reference
    climb_mps = reference.at_many(reference.end_m - series.to_go_m).climb_mps
    changing = np.abs(climb_mps) > 0.1
    assert 300.0 < changing.sum() / 10.0 < 1200.0  # seconds of a flight of twenty-odd minutes
    assert np.percentile(np.abs(series.altitude_error_m[changing]), 95) < 1.0
    assert np.percentile(np.abs(series.cross_track_m[changing]), 95) < 1.0
    envelope = make_aircraft(load_scenario("jet").scenario).envelope
    assert climb_mps.max() <= CLIMB_SHARE * envelope.climb_max_mps * 1.01
    assert climb_mps.min() >= -CLIMB_SHARE * envelope.descent_max_mps * 1.01


def test_wind_is_that_of_the_height_flown(jet):
    flown, _, _ = jet
    sounding = load_scenario("jet").scenario.weather.sounding
    state = flown.tracking.series.state
    heights_m = [level.height_m for level in sounding]
    expected_mps = np.interp(state["altitude_m"], heights_m, [level.north_mps for level in sounding])
    np.testing.assert_allclose(state["wind_north_mps"], expected_mps, atol=0.1)


def test_the_recording_tells_of_levels_and_has_their_weather(jet):
    flown, _, _ = jet
    told = [event.text for event in flown.tracking.recording.events if event.text.startswith("level: ")]
    top_m = max(flown.tracking.levels_m)
    assert told[0] == "level: climbs from 400 m toward 1000 m"
    assert f"level: at {top_m:.0f} m" in told
    assert told[-1] == "level: at 400 m"
    truth = [sheet for sheet in flown.tracking.recording.hazards if sheet.layer is Layer.TRUTH]
    assert len(truth) == len(told) + 1  # within one stage
    altitudes_m = [sheet.altitude_m for sheet in truth]
    assert (altitudes_m[0], altitudes_m[1], max(altitudes_m), altitudes_m[-1]) == (400.0, 700.0, top_m, 400.0)
    sounding = {level.height_m: level.north_mps for level in load_scenario("jet").scenario.weather.sounding}
    for sheet in truth:
        if sheet.altitude_m in sounding:
            np.testing.assert_allclose(sheet.wind_north_mps, sounding[sheet.altitude_m], atol=0.1)


def test_without_levels_it_takes_far_longer(jet):
    _, _, plan = jet
    loaded = load_scenario("jet", ["mission.levels_m=[]"])
    aircraft = make_aircraft(loaded.scenario)
    low = make_plan(loaded.scenario, bring_weather(loaded), aircraft)
    assert plan.outcome.arrival_s < 0.7 * low.outcome.arrival_s
    assert {point.altitude_m for point in low.waypoints} == {400.0}
    assert "levels to Cambria: 400 m, " in "\n".join(plan_lines(plan))
    assert not [line for line in plan_lines(low) if "levels" in line]


def several_heights(tmp_path, heights_m=(100.0, 500.0, 1000.0, 1600.0)):
    """A file of wind that turns with height, over the jet's area."""
    grid = Grid.covering(
        math.radians(35.0), math.radians(36.0), math.radians(-121.8), math.radians(-120.6), rows=6, columns=7
    )
    begin_s = load_scenario("jet").scenario.mission.departure_s
    shape = (2, len(heights_m), *grid.shape)
    north = np.broadcast_to(np.linspace(-12.0, 6.0, len(heights_m))[:, np.newaxis, np.newaxis], shape)
    wind = WindField(
        grid,
        begin_s + np.array([0.0, 5 * 3600.0]),
        north.astype(np.float32),
        np.zeros(shape, dtype=np.float32),
        height_m=np.array(heights_m),
    )
    write_wind(tmp_path / "wind.nc", wind, title="wind", source="a test")
    return wind


def scenario_of(tmp_path, *overrides, levels="[1000.0, 1500.0]", more=""):
    text = (Path(__file__).parents[2] / "sim" / "scenarios" / "jet.toml").read_text(encoding="utf-8")
    before, rest = text.split("[weather]")
    after = rest[rest.index("[grid]") :]
    path = tmp_path / "own.toml"
    own = f'{before}[weather]\nfile = "wind.nc"\n{more}\n{after}'
    path.write_text(own.replace("levels_m = [1000.0, 1500.0]", f"levels_m = {levels}"), encoding="utf-8")
    return load_scenario(str(path), [*COARSE, *overrides])


def test_files_are_laid_out_at_the_levels_and_the_heights_between(tmp_path):
    wind = several_heights(tmp_path)
    weather = bring_weather(scenario_of(tmp_path, levels="[700.0, 1200.0]"))
    assert weather.levels.height_m == (400.0, 500.0, 700.0, 1000.0, 1200.0)
    assert weather.forecast.height_m is None
    at = 0.5 * (wind.time_s[0] + wind.time_s[1]), math.radians(35.5), math.radians(-121.0)
    for height_m in weather.levels.height_m:
        laid, own = (field.at(*at, height_m) for field in (weather.levels.forecast, wind))
        assert laid.north_mps == pytest.approx(own.north_mps, abs=1e-4)


def test_a_no_fly_zone_is_closed_at_every_level(tmp_path):
    several_heights(tmp_path)
    ring = [[-121.4, 35.35], [-120.9, 35.35], [-120.9, 35.42], [-121.4, 35.42], [-121.4, 35.35]]
    zone = {"type": "Polygon", "coordinates": [ring]}
    (tmp_path / "zone.geojson").write_bytes(msgspec.json.encode(zone))
    also = '[[hazard.also]]\nkind = "no_fly"\nfile = "zone.geojson"\n'
    loaded = scenario_of(tmp_path, more=also)
    weather = bring_weather(loaded)
    plan = make_plan(loaded.scenario, weather, make_aircraft(loaded.scenario))
    closed = weather.levels.closures.closed
    rows = weather.forecast.grid.rows
    assert closed.shape[1] == len(weather.levels.height_m) * (rows + 2) - 2
    np.testing.assert_array_equal(closed[:, :rows], weather.also.planned.closed)
    inside = [
        point
        for point in plan.waypoints
        if 35.35 <= point.lat_deg <= 35.42 and -121.4 <= point.lon_deg <= -120.9
    ]
    assert plan.outcome.reachable
    assert not inside


@pytest.mark.parametrize(
    ("floor_m", "ceiling_m", "closed"),
    [
        (0, 420, [1, 0, 0, 0]),
        (0, 460, [1, 1, 0, 0]),
        (600, 700, [0, 1, 0, 0]),
        (1240, 1260, [0, 0, 1, 1]),
        (1300, 1400, [0, 0, 0, 1]),
        (1600, 1700, [0, 0, 0, 0]),
    ],
)
def test_a_zone_of_some_heights_closes_the_levels_beside_it(tmp_path, floor_m, ceiling_m, closed):
    """A climb passes what lies between two levels, so a zone there closes the nearer one."""
    several_heights(tmp_path)
    ring = [[-121.4, 35.35], [-120.9, 35.35], [-120.9, 35.42], [-121.4, 35.42], [-121.4, 35.35]]
    zone = {
        "type": "Feature",
        "geometry": {"type": "Polygon", "coordinates": [ring]},
        "properties": {"floor_m": floor_m, "ceiling_m": ceiling_m},
    }
    (tmp_path / "zone.geojson").write_bytes(msgspec.json.encode(zone))
    also = '[[hazard.also]]\nkind = "no_fly"\nfile = "zone.geojson"\n'
    levels = bring_weather(scenario_of(tmp_path, more=also)).levels
    assert levels.height_m == (400.0, 500.0, 1000.0, 1500.0)
    assert [joined.true.any() for joined in levels.also] == closed


@pytest.mark.parametrize(
    ("levels", "said"),
    [
        (
            "[1590.0]",
            "level of 1590 m does not lie within the wind of wind.nc, which is known from 100 to 1600 m",
        ),
        ("[60.0]", "from 120 to 1580"),
    ],
)
def test_levels_beyond_the_wind_are_refused(tmp_path, levels, said):
    several_heights(tmp_path)
    with pytest.raises(SimError, match=said):
        bring_weather(scenario_of(tmp_path, levels=levels))


def test_levels_above_the_ceiling_are_refused():
    scenario = load_scenario("jet", ["mission.levels_m=[2500.0]"]).scenario
    with pytest.raises(SimError, match=r"mission.levels_m 2500 is above the ceiling of aerosonde, 2000 m"):
        make_aircraft(scenario)


def test_wind_of_one_height_leaves_nothing_to_choose():
    one = "weather.sounding=[{height_m=10, north_mps=3.0, east_mps=0.0}]"
    with pytest.raises(SimError, match=r"weather.sounding has wind at one level alone"):
        bring_weather(load_scenario("jet", [one]))


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (["planner.kind=staged"], 'the staged planner does not; set planner.kind = "windaware"'),
        (["planner.objective=fuel"], "does not go with planner.objective 'fuel'"),
        (["planner.replan=each_stage"], "replan"),
        (["mission.levels_m=[420.0]"], "400 and 420 m, which are less than 40 m apart"),
        (["mission.levels_m=[400.0]"], "names no altitude but mission.altitude_m"),
        (["mission.levels_m=[30.0]"], "levels_m"),
        (["weather.sounding=[]", "weather.storm=AL092022"], "the storm AL092022 is the same at all heights"),
        (["weather.sounding=[]", "weather.calm=true"], "calm air is the same at all heights"),
        (["weather.error.kind=growing"], "weather.error.kind 'growing' is for storms and files"),
        (["weather.file=wind.nc"], "or a sounding alone"),
        (
            ["weather.sounding=[]", "weather.file=wind.nc", "weather.error.kind=growing"],
            "err at one altitude",
        ),
        (
            [
                "weather.sounding=[{height_m=9, north_mps=0.0, east_mps=0.0}, "
                "{height_m=9, north_mps=0.0, east_mps=0.0}]"
            ],
            "weather.sounding goes from 9 to 9 m; let the heights rise",
        ),
    ],
)
def test_what_does_not_go_with_levels_is_refused(overrides, said):
    with pytest.raises(SimError, match=said):
        load_scenario("jet", overrides)


def test_departures_are_chosen_by_the_planner_of_one_altitude():
    departing = Departing.parsed("0:30:10", None, distinct=False)
    with pytest.raises(SimError, match=r"--planner staged --set mission.levels_m=\[\]"):
        plan_job(load_scenario("jet"), departing, PlanFiles(), lambda _: None)


def test_the_weather_of_a_scenario_is_told_at_every_level():
    told = scenario_weather(load_scenario("jet", COARSE), Wanted())
    assert "the above is at 400 m; at the levels, in all stages:" in told
    assert "   1000 m    3.2 m/s at most, 0.0% hazardous by it" in told


def test_planners_are_compared_at_one_altitude():
    with pytest.raises(SimError, match=r"--set mission.levels_m=\[\]"):
        compare_planners(load_scenario("jet"), (), None)


def watch(heights_m=(400.0, 700.0, 1000.0, 1500.0), levels_m=(400.0, 1000.0, 1500.0)):
    """A watch over hazard at 700 m alone, by the wind in the south and for another reason in the north."""
    grid = Grid.covering(0.6, 0.61, -2.1, -2.09, rows=4, columns=3)
    shape = (2, len(heights_m), *grid.shape)
    north = np.zeros(shape, dtype=np.float32)
    north[:, 1, 0] = 20.0
    wind = WindField(
        grid, np.array([0.0, 7200.0]), north, np.zeros(shape, dtype=np.float32), height_m=np.array(heights_m)
    )
    closed = [np.zeros((2, *grid.shape), dtype=np.bool_) for _ in heights_m]
    closed[1][:, 3] = True
    clock = StageClock(0.0, 2, 30, 120.0)
    layer = LevelLayer(Layer.TRUTH, wind, closed, corridor_m=0.0, threshold_mps=15.0, clock=clock)
    return LevelWatch((layer,), levels_m)


def test_sheets_come_with_another_stage_or_level_alone():
    levels = watch()
    (first,) = levels.due(-60.0, 402.0)
    assert not first.hazard.any()
    assert levels.due(-59.0, 410.0) == []
    (between,) = levels.due(30.0, 450.0)
    assert levels.news == ["level: climbs from 400 m toward 1000 m"]
    np.testing.assert_array_equal(between.hazard[:, 0], [True, False, False, True])
    np.testing.assert_array_equal(between.closed[:, 0], [False, False, False, True])
    assert between.peak_mps[0, 0] == 20.0
    (above,) = levels.due(200.0, 990.0)
    assert levels.news == ["level: at 1000 m"]
    assert not above.hazard.any()
    (later,) = levels.due(3600.0, 1003.0)
    assert (later.stage, levels.news) == (1, [])
    levels.due(3700.0, 900.0)
    assert levels.news == ["level: descends from 1000 m toward 400 m"]
    assert len(levels.due(3800.0, 120.0)) == 1
    assert levels.news == ["level: at 400 m"]


def test_holds_are_flown_where_every_level_is_safe():
    hazard = watch().layers[0].hazard()
    np.testing.assert_array_equal(hazard[0, :, 0], [True, False, False, True])
