"""Joined hazard in whole scenarios: as documented, planned on, recorded and compared."""

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import recordings
from planner.grid import Grid
from planner.hazards import hazard_stages
from planner.planning import staged_problem
from planner.windaware import way_search
from recordings.recorder import Layer
from sim.cli_plan import plan as plan_command
from sim.clock import make_clock
from sim.errors import ScenarioError, WeatherError
from sim.hazard_text import hazard_lines
from sim.preparation import make_aircraft, make_plan, planning_request, prepare_flight, weather_sheets
from sim.scenario import load_scenario
from sim.weather.source import bring_weather

ROOT = Path(__file__).parents[3]
SHORT = str(ROOT / "tests/sim/scenarios/short.toml")
EXAMPLES = re.findall(r"```toml\n(.*?)```", (ROOT / "docs/hazards.md").read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture
def short(tmp_path):
    """Loads the short scenario with more text at its end, from a folder of its own."""

    def loaded(text="", *overrides, **changes):
        scenario = Path(SHORT).read_text(encoding="utf-8")
        for old, new in changes.values():
            assert old in scenario
            scenario = scenario.replace(old, new)
        path = tmp_path / "mine.toml"
        path.write_text(f"{scenario}\n{text}", encoding="utf-8")
        return load_scenario(str(path), overrides)

    return loaded


@pytest.fixture
def own_files(tmp_path, weather_file):
    """The files that the documents' examples name, around the short scenario."""
    grid = bring_weather(load_scenario(SHORT)).forecast.grid
    south, west = (float(np.degrees(nodes[0])) - 0.1 for nodes in (grid.lat_rad, grid.lon_rad))
    place = {"step_deg": 0.1, "south": south, "west": west}
    shape, random = (4, 19, 25), np.random.default_rng(3)
    weather_file("gust.nc", **place, gust=("m s-1", random.uniform(0.0, 22.0, shape)))
    weather_file("members.nc", **place, gust=("m s-1", random.uniform(0.0, 22.0, (9, *shape))))
    weather_file("rain.nc", **place, rain_rate=("kg m-2 s-1", random.uniform(0.0, 6.0, shape) / 3600.0))
    np.savez(tmp_path / "mine.npz", storms=random.random((1, *grid.shape)) < 0.1, other=np.zeros(1))
    zone(-91.5, -90.9, 28.9, 29.5, tmp_path)
    return grid


def zone(west, east, south, north, folder):
    ring = [[west, south], [east, south], [east, north], [west, north], [west, south]]
    (folder / "zones.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))


@pytest.mark.parametrize(
    "example", EXAMPLES, ids=[re.findall(r'kind = "(\w+)"', text)[0] for text in EXAMPLES]
)
def test_the_documents_examples_are_hazards(short, own_files, example):
    weather = bring_weather(short(example))
    (table,) = tomllib.loads(example)["hazard"]["also"]
    if "factor" in table:
        assert weather.also.planned is None
        assert short(example).scenario.hazard.mean_threshold_mps == pytest.approx(20.0 / 1.4)
        return
    closed = weather.also.planned.closed
    assert closed.shape == (1, *own_files.shape)
    assert 0.0 < closed.mean() < 1.0
    assert (weather.also.planned.chance is not None) == (table["kind"] == "ensemble")


def test_every_kind_has_an_example():
    kinds = {tomllib.loads(text)["hazard"]["also"][0]["kind"] for text in EXAMPLES}
    assert kinds == {"gust", "ensemble", "variable", "matrices", "no_fly"}


WALL = (-90.7, -90.4, 29.67, 29.69)  # between start and goal
ALSO = '[[hazard.also]]\nkind = "no_fly"\nfile = "zones.geojson"\n'


def test_a_zone_on_the_way_is_flown_around_by_every_planner(short, tmp_path):
    zone(*WALL, tmp_path)
    with_zone, without = short(ALSO), load_scenario(SHORT)
    aircraft = make_aircraft(without.scenario)
    for planner in ("staged", "windaware"):
        plans = []
        for loaded in (without, with_zone):
            scenario = replaced_planner(loaded.scenario, planner)
            plans.append(make_plan(scenario, bring_weather(loaded), aircraft))
        assert plans[1].outcome.arrival_s > plans[0].outcome.arrival_s
        west, east, south, north = WALL
        through = [west < p.lon_deg < east and south < p.lat_deg < north for p in plans[1].waypoints]
        assert not any(through)
    weather = bring_weather(with_zone)
    request = planning_request(with_zone.scenario, weather, aircraft)
    closed = weather.also.planned.closed
    assert closed.any()
    assert staged_problem(weather.forecast, request).hazard[closed].all()
    assert way_search(weather.forecast, request).hazard[closed].all()


def replaced_planner(scenario, kind):
    import msgspec

    return msgspec.structs.replace(scenario, planner=msgspec.structs.replace(scenario.planner, kind=kind))


def test_sheets_to_record_hold_what_is_planned_on_and_what_is_true(short, tmp_path):
    zone(*WALL, tmp_path)
    loaded = short(ALSO, "hazard.corridor_m=2500", "weather.truth.speed_factor=1.1")
    scenario, weather = loaded.scenario, bring_weather(loaded)
    sheets = weather_sheets(scenario, weather)
    assert {sheet.layer for sheet in sheets} == {Layer.FORECAST, Layer.TRUTH}
    for sheet in sheets:
        forecast = sheet.layer is Layer.FORECAST
        wind = weather.forecast if forecast else weather.truth
        by_wind = hazard_stages(
            wind, make_clock(scenario), threshold_mps=15.0, corridor_m=2500.0 if forecast else 0.0
        )
        closed = weather.also.planned.closed if forecast else weather.also.true
        np.testing.assert_array_equal(sheet.hazard, by_wind[sheet.stage] | closed[sheet.stage])
        np.testing.assert_array_equal(sheet.closed, closed[sheet.stage])
    # A corridor wider than half a cell closes more to the planner than is truly closed.
    assert weather.also.planned.closed.sum() > weather.also.true.sum() > 0


def test_without_other_hazards_nothing_is_recorded_of_them():
    loaded = load_scenario(SHORT)
    assert all(sheet.closed is None for sheet in weather_sheets(loaded.scenario, bring_weather(loaded)))


def test_a_gust_factor_lowers_the_threshold_everywhere(short):
    loaded = short('[[hazard.also]]\nkind = "gust"\nfactor = 1.5\nthreshold_mps = 15\n')
    scenario, weather = loaded.scenario, bring_weather(loaded)
    assert planning_request(scenario, weather, make_aircraft(scenario)).threshold_mps == 10.0
    sheets = weather_sheets(scenario, weather)
    np.testing.assert_array_equal(
        sheets[0].hazard,
        hazard_stages(weather.forecast, make_clock(scenario), threshold_mps=10.0, corridor_m=1100.0)[0],
    )


CALM = {"storm": ('storm = "AL092022"', "calm = true")}


def test_without_wind_it_is_planned_and_not_flown(short, own_files, tmp_path):
    zone(*WALL, tmp_path)
    loaded = short(ALSO, **CALM)
    weather, aircraft = bring_weather(loaded), make_aircraft(loaded.scenario)
    assert not weather.forecast.north_mps.any()
    plan = make_plan(loaded.scenario, weather, aircraft)
    assert plan.outcome.reachable
    with pytest.raises(ScenarioError, match="nothing is known of the wind"):
        prepare_flight(loaded, weather, plan, aircraft)


def test_the_gusts_of_the_st_jude_ensemble_are_planned_on(short, data_folder, tmp_path):
    pytest.importorskip("cfgrib")
    gusts = data_folder / "ens_stjude_gust_20131025.grib"
    if not gusts.exists():
        pytest.skip(f"{gusts} is not there")
    also = (
        f'[[hazard.also]]\nkind = "ensemble"\nfile = "{gusts}"\nvariable = "fg10_3"\n'
        "threshold_mps = 20\nmore_than = 0.8\n"
    )
    changes = {
        "time": ("2022-09-29T00:00:00Z", "2013-10-28T01:00:00Z"),
        "start": ("lat_deg = 29.60, lon_deg = -90.60", "lat_deg = 58.0, lon_deg = 5.0"),
        "goal": ("lat_deg = 29.76, lon_deg = -90.45", "lat_deg = 57.0, lon_deg = 8.0"),
        "south": ("south_deg = 29.0", "south_deg = 54.0"),
        "north": ("north_deg = 30.5", "north_deg = 59.0"),
        "west": ("west_deg = -91.5", "west_deg = 2.0"),
        "east": ("east_deg = -89.5", "east_deg = 10.0"),
        "objective": ('objective = "earliest"', 'objective = "survival"'),
    }
    sizes = ("stages.count=6", "stages.step_s=300", "stages.steps=12", "grid.cell_m=8000")
    with pytest.raises(
        WeatherError,
        match=r"fg10_3 of ens_stjude_gust_20131025\.grib has no values between 2013-10-28T00:00:00 and "
        r"2013-10-28T03:00:00 UTC, 3 h apart \(limit 1 h\); .* weather\.bridge_gaps_h = 3",
    ):
        bring_weather(short(also, *sizes, **changes, **CALM))
    within = ("mission.departure=2013-10-28T03:00:00Z", "stages.count=3", *sizes[1:])
    one_window = bring_weather(short(also, *within, **changes, **CALM)).also.planned.chance
    assert (one_window == one_window[0]).all()
    loaded = short(also, *sizes, "weather.bridge_gaps_h=3", **changes, **CALM)
    weather, aircraft = bring_weather(loaded), make_aircraft(loaded.scenario)
    closures = weather.also.planned
    assert weather.also.true is None
    assert 0.0 < closures.closed.mean() < closures.chance.mean() < 1.0
    # In the south, off Jutland, most members have the storm; in the north few.
    assert closures.chance[:, :8].mean() > closures.chance[:, -8:].mean() + 0.2
    safest = make_plan(loaded.scenario, weather, aircraft)
    request = replace(planning_request(loaded.scenario, weather, aircraft), objective="earliest")
    assert safest.outcome.reachable
    from planner.planning import plan_staged

    quickest = plan_staged(weather.forecast, request)
    assert safest.outcome.survival > quickest.outcome.survival
    assert isinstance(weather.forecast.grid, Grid)


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        (
            '[{kind="gusty"}]',
            "hazard.also.kind is 'gusty'; choose one of gust, ensemble, matrices, variable, no_fly",
        ),
        ("[{threshold_mps=1}]", "hazard.also.kind is missing"),
        (
            '[{kind="gust",treshold_mps=1}]',
            "unknown key 'hazard.also.treshold_mps'; did you mean 'threshold_mps'",
        ),
        ('[{kind="gust",threshold_mps=0,factor=1.4}]', r"hazard.also\[0\].threshold_mps is 0; .*above 0"),
        ('[{kind="gust",threshold_mps=9,factor=0.5}]', r"hazard.also\[0\].factor is 0.5; .*from 1 to 5"),
        ('[{kind="gust",threshold_mps=20}]', "looks for a gust speed in the weather's file, but the wind is"),
        ('[{kind="gust",threshold_mps=20,factor=1.4,file="a.nc"}]', "gust factor and names a variable"),
        ('[{kind="no_fly"}]', r"hazard.also\[0\].*lacks file; add file = text"),
        ('[{kind="variable",variable="a",unit="m",file="a.nc"}]', "neither above nor below"),
        (
            '[{kind="variable",variable="a",unit="m",above=1,below=2,file="a.nc"}]',
            "every value of a hazardous",
        ),
        ('[{kind="variable",variable="a",unit="m",above=nan,file="a.nc"}]', "give a finite number"),
        ('[{kind="variable",variable="a",unit="m",above=1}]', 'name the file, such as file = "more.nc"'),
        ('[{kind="ensemble",more_than=2}]', r"hazard.also\[0\].more_than is 2; .*from 0 to 1"),
        ('[{kind="ensemble",more_than=0.1,variable="g"}]', "looks for g in the weather's file"),
        ('[{kind="ensemble",more_than=0.1},{kind="ensemble",more_than=0.2}]', "has several ensembles"),
        ("3", "hazard.also is 3"),
    ],
)
def test_tables_that_make_no_sense_are_named(tables, message):
    with pytest.raises(ScenarioError, match=message):
        load_scenario("ian", [f"hazard.also={tables}"])


def test_what_is_hazardous_is_told_in_a_line_each():
    tables = (
        '[{kind="gust",threshold_mps=21,factor=1.4},{kind="gust",threshold_mps=20,file="g.nc"},'
        '{kind="ensemble",more_than=0.1,file="e.nc"},{kind="matrices",file="m.npy"},{kind="no_fly",file="z"},'
        '{kind="variable",variable="rain",unit="mm h-1",above=5,below=-1,file="r.nc"}]'
    )
    assert hazard_lines(load_scenario("ian", [f"hazard.also={tables}"]).scenario.hazard) == [
        "hazard: wind over 15 m/s",
        "        gusts over 21 m/s, 1.4 times the wind: wind over 15 m/s",
        "        gusts over 20 m/s (g.nc)",
        "        wind over 15 m/s in more than 10 % of an ensemble (e.nc)",
        "        matrices (m.npy)",
        "        no-fly zones (z)",
        "        rain over 5 mm h-1 or under -1 mm h-1 (r.nc)",
    ]


def test_plans_are_headed_by_what_is_hazardous(short, tmp_path):
    zone(*WALL, tmp_path)
    short(ALSO)
    done = CliRunner().invoke(plan_command, [str(tmp_path / "mine.toml")])
    assert done.exit_code == 0, done.output
    assert done.output.splitlines()[:2] == [
        "hazard: wind over 15 m/s",
        "        no-fly zones (zones.geojson)",
    ]
    assert "hazard:" not in CliRunner().invoke(plan_command, [SHORT]).output


def test_a_flight_around_a_zone_is_recorded_with_it_and_never_in_it(galeway, short, tmp_path):
    zone(*WALL, tmp_path)
    short(ALSO, limits=("limits = [", 'limits = ["hazard_exposure_s == 0", '))
    done = galeway("fly", str(tmp_path / "mine.toml"), "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stdout + done.stderr
    recording = recordings.open(tmp_path / "out" / "flight.mcap")
    closed = [sheet for sheet in recording.hazards if sheet.layer is Layer.TRUTH]
    assert all(sheet.closed is not None and sheet.closed.any() for sheet in closed)
    west, east, south, north = np.radians(WALL)
    lat, lon = recording.state["lat_rad"], recording.state["lon_rad"]
    assert not ((lat > south) & (lat < north) & (lon > west) & (lon < east)).any()
    assert (lat > north).any()
    assert (lat < south).any()


def test_the_ensemble_that_the_weather_draws_is_planned_on_and_comes_anew_in_flight(short):
    also = '[[hazard.also]]\nkind = "ensemble"\nmore_than = 0.6\nthreshold_mps = 7.2\nblur_cells = 0\n'
    loaded = short(also, "stages.count=2", "weather.error.kind=growing", "weather.error.members=8")
    weather = bring_weather(loaded)
    clock = make_clock(loaded.scenario)
    for issue in (0, 1):
        over = [
            hazard_stages(wind, clock, threshold_mps=7.2, corridor_m=1100.0)
            for wind in weather.members(issue)
        ]
        closures = weather.also.issued(issue)
        np.testing.assert_allclose(closures.chance, np.mean(over, axis=0), atol=1e-12)
        np.testing.assert_array_equal(closures.closed, np.mean(over, axis=0) > 0.6)
    np.testing.assert_array_equal(weather.also.planned.chance, weather.also.issued(0).chance)
    assert weather.also.true is None
    assert 0.0 < weather.also.planned.chance.mean() < 1.0
    assert (weather.also.issued(1).chance != weather.also.planned.chance).any()
