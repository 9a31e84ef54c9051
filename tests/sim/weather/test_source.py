"""The planner's grid for each kind of weather, and what a scenario can get wrong about it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.grid import Grid
from sim.errors import ScenarioError, WeatherError
from sim.scenario import GridTable, load_scenario
from sim.weather.source import bring_weather, refined_grid

NATIVE = Grid.covering(*map(math.radians, (20.0, 24.0, -92.0, -88.0)), rows=41, columns=41)


def degrees(values):
    return np.degrees(values).tolist()


def test_ian_has_cells_of_3600_m_over_its_area():
    weather = bring_weather(load_scenario("ian", ["stages.count=1"]))
    grid = weather.forecast.grid
    assert degrees(grid.lat_rad)[0] == pytest.approx(22.5)
    assert degrees(grid.lat_rad)[-1] == pytest.approx(34.5)
    assert degrees(grid.lon_rad)[0] == pytest.approx(-91.5)
    assert degrees(grid.lon_rad)[-1] == pytest.approx(-76.5)
    assert grid.north_cell_m == pytest.approx(3600.0, rel=0.01)
    assert grid.east_cell_m[grid.rows // 2] == pytest.approx(3600.0, rel=0.01)
    assert weather.forecast is weather.truth
    assert weather.truth.time_s[0] == 1664409600.0
    assert weather.truth.time_s[-1] >= 1664409600.0 + 2 * 3600.0  # an hour for a flight that is late


@given(st.floats(400.0, 20_000.0))
def test_refining_keeps_every_node_of_the_file(cell_m):
    grid = refined_grid(NATIVE, GridTable(cell_m=cell_m), "wind.nc")
    for native, own in ((NATIVE.lat_rad, grid.lat_rad), (NATIVE.lon_rad, grid.lon_rad)):
        nearest = np.abs(own[:, None] - native[None, :]).min(axis=0)
        assert nearest.max() < 1e-9
    if cell_m < float(NATIVE.north_cell_m.min()):
        assert grid.north_cell_m.max() < 1.51 * cell_m


def test_an_area_is_cut_out_at_the_nodes_around_it():
    table = GridTable(cell_m=20_000.0, south_deg=21.03, north_deg=22.5, west_deg=-91.0, east_deg=-88.55)
    grid = refined_grid(NATIVE, table, "wind.nc")
    assert degrees(grid.lat_rad)[0] == pytest.approx(21.0)
    assert degrees(grid.lat_rad)[-1] == pytest.approx(22.5)
    assert degrees(grid.lon_rad)[0] == pytest.approx(-91.0)
    assert degrees(grid.lon_rad)[-1] == pytest.approx(-88.5)


def test_longitudes_to_360_mean_the_same_area():
    tables = [
        GridTable(south_deg=21.0, north_deg=22.0, west_deg=west_deg, east_deg=west_deg + 1.0)
        for west_deg in (-90.0, 270.0)
    ]
    here, there = (refined_grid(NATIVE, table, "wind.nc") for table in tables)
    assert here == there


@pytest.mark.parametrize(
    ("bounds", "word"),
    [((19.0, 22.0, -91.0, -89.0), "latitudes"), ((21.0, 22.0, -91.0, -87.0), "longitudes")],
)
def test_an_area_outside_the_file_is_refused(bounds, word):
    with pytest.raises(
        WeatherError, match=f"wind.nc covers 20.00 N to 24.00 N, .* and does not hold all {word}"
    ):
        refined_grid(NATIVE, GridTable(3600.0, *bounds), "wind.nc")


def test_a_file_up_to_the_poles_asks_for_an_area():
    world = Grid.covering(*map(math.radians, (-90.0, 90.0, 0.0, 358.0)), rows=91, columns=180)
    with pytest.raises(WeatherError, match=r"90\.0 deg of latitude"):
        refined_grid(world, GridTable(), "world.nc")
    area = GridTable(cell_m=3600.0, south_deg=20.0, north_deg=70.0, west_deg=200.0, east_deg=300.0)
    with pytest.raises(WeatherError, match=r"grid\.cell_m"):
        refined_grid(world, area, "world.nc")


def test_an_unknown_storm_is_refused():
    with pytest.raises(WeatherError, match=r"there are .*AL092022.* for another one name a best track"):
        bring_weather(load_scenario("ian", ["weather.storm=AL112022"]))


def test_a_storm_comes_from_a_best_track_of_ones_own(data_folder):
    path = data_folder / "hurdat2_atlantic_2021_2022.txt"
    few = ["stages.count=1", "grid.cell_m=20000.0"]
    own = bring_weather(load_scenario("ian", [*few, f'weather.file="{path}"']))
    shipped = bring_weather(load_scenario("ian", few))
    np.testing.assert_array_equal(own.forecast.north_mps, shipped.forecast.north_mps)
    with pytest.raises(WeatherError, match="cannot read the best track"):
        bring_weather(load_scenario("ian", ["weather.file=missing.txt"]))


@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_a_truth_stronger_or_weaker_than_the_forecast(factor):
    weather = bring_weather(load_scenario("ian", ["stages.count=1", f"weather.truth.speed_factor={factor}"]))
    asked = bring_weather(load_scenario("ian", ["stages.count=1"])).forecast
    np.testing.assert_array_equal(weather.forecast.north_mps, asked.north_mps)
    np.testing.assert_allclose(weather.truth.north_mps, factor * asked.north_mps, rtol=1e-6)
    np.testing.assert_allclose(weather.truth.east_mps, factor * asked.east_mps, rtol=1e-6)


def test_a_truth_without_wind_is_refused():
    with pytest.raises(ScenarioError, match="speed_factor"):
        load_scenario("ian", ["weather.truth.speed_factor=0.0"])


def test_forecasts_are_right_unless_the_scenario_says_otherwise():
    weather = bring_weather(load_scenario("ian", ["stages.count=1"]))
    assert weather.issued is None
    assert weather.members is None


def test_a_growing_error_gives_a_forecast_for_every_stage_and_its_ensemble():
    error = ["weather.error.kind=growing", "weather.error.members=3"]
    coarse = ["stages.count=6", "grid.cell_m=20000.0"]
    weather = bring_weather(load_scenario("ian", coarse + error))
    asked = bring_weather(load_scenario("ian", coarse))
    np.testing.assert_array_equal(weather.truth.north_mps, asked.truth.north_mps)
    off = np.abs(weather.forecast.north_mps - weather.truth.north_mps).max(axis=(1, 2))
    assert off[0] == 0.0
    assert off[-1] > 2.0
    np.testing.assert_array_equal(weather.issued(0).north_mps, weather.forecast.north_mps)
    late = np.abs(weather.issued(5).north_mps - weather.truth.north_mps).max(axis=(1, 2))
    assert (late[:11] == 0.0).all()  # five hours of known weather
    assert 0.0 < late[-1] < off[-1]
    assert len(weather.members(2)) == 3


def test_members_of_forecasts_that_do_not_err_are_refused():
    with pytest.raises(ScenarioError, match=r"weather\.error\.members is 3, but forecasts do not err"):
        load_scenario("ian", ["weather.error.members=3"])
