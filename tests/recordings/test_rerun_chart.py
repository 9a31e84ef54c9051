import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.grid import Grid
from recordings.rerun_chart import Chart


def grid_of(south_deg, north_deg, west_deg, east_deg, rows, columns):
    bounds = (math.radians(angle_deg) for angle_deg in (south_deg, north_deg, west_deg, east_deg))
    return Grid.covering(*bounds, rows=rows, columns=columns)


@pytest.fixture(scope="module")
def chart():
    return Chart(grid_of(20.0, 50.0, -90.0, -70.0, 90, 80))


def pixel_centres(chart):
    down, east = np.indices(chart.shape)
    return (
        chart.extent.west + chart.cell_km * (east + 0.5),
        chart.extent.north - chart.cell_km * (down + 0.5),
    )


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_each_pixel_has_the_weather_of_the_cell_nearest_to_its_position(chart, seed):
    grid = chart.grid
    hazard = np.random.default_rng(seed).random(grid.shape) < 0.5
    picture = chart.upright(hazard)
    east_km, north_km = pixel_centres(chart)
    lat_rad, lon_rad = grid.frame.to_geodetic(1000.0 * north_km, 1000.0 * east_km)
    rows, columns = grid.indices(lat_rad, lon_rad)
    inside = rows > -0.5
    rows, columns = np.rint(rows[inside]).astype(int), np.rint(columns[inside]).astype(int)
    rows = np.minimum(rows, grid.rows - 1)
    np.testing.assert_array_equal(picture[inside], hazard[rows, columns])


def test_the_picture_covers_the_grid_and_less_than_a_pixel_more(chart):
    half_north_deg, half_east_deg = 15.0 / 89.0, 10.0 / 79.0
    west_km, south_km = chart.km(20.0 - half_north_deg, -90.0 - half_east_deg)
    east_km, north_km = chart.km(50.0 + half_north_deg, -70.0 + half_east_deg)
    extent = chart.extent
    assert (extent.west, extent.east, extent.north) == pytest.approx((west_km, east_km, north_km))
    assert south_km - chart.cell_km < extent.south <= south_km
    assert extent.north - extent.south == pytest.approx(chart.cell_km * chart.shape[0])
    assert extent.east - extent.west == pytest.approx(chart.cell_km * chart.shape[1])


def test_the_view_leaves_room_for_legend_and_labels_in_the_proportions_of_the_screen(chart):
    view, extent, px_km = chart.view, chart.extent, chart.px_km
    assert extent.west - view.west == pytest.approx(236.0 * px_km)
    assert view.west < extent.west < extent.east < view.east
    assert view.south < extent.south < extent.north < view.north
    assert view.east - view.west <= 830.0 * px_km * (1.0 + 1e-9)
    assert view.north - view.south <= 612.0 * px_km * (1.0 + 1e-9)
    fills = (view.east - view.west) / 830.0, (view.north - view.south) / 612.0
    assert max(fills) == pytest.approx(px_km)


def test_cells_lie_where_their_latitudes_and_longitudes_do(chart):
    east_km, north_km = chart.cells_km
    grid = chart.grid
    for row, column in ((0, 0), (40, 13), (89, 79)):
        at_km = chart.km(math.degrees(grid.lat_rad[row]), math.degrees(grid.lon_rad[column]))
        assert (east_km[column], north_km[row]) == pytest.approx(at_km)


def test_lines_of_the_graticule_carry_the_degrees_where_they_lie(chart):
    lines = chart.graticule()
    names = {line.name: line for line in lines}
    assert {"20°N", "30°N", "50°N", "90°W", "75°W"} <= set(names)
    assert names["30°N"].north_km[0] == pytest.approx(chart.km(30.0, -80.0)[1])
    assert names["75°W"].east_km[1] == pytest.approx(chart.km(40.0, -75.0)[0])
    assert 8 <= len(lines) <= 20


def test_the_chart_goes_on_across_the_date_line():
    chart = Chart(grid_of(-20.0, -10.0, 174.0, 186.0, 30, 36))
    assert {"178°E", "180°W", "176°W", "16°S"} <= {line.name for line in chart.graticule()}
    assert chart.km(-15.0, -175.0)[0] > chart.km(-15.0, 179.0)[0]
    assert chart.extent.west < chart.km(-15.0, 179.0)[0] < chart.extent.east


def test_the_scale_bar_is_a_true_length_in_the_middle(chart):
    bar_km = chart.scale_bar_km()
    half_deg = math.degrees(bar_km / 2.0 / (6378.137 * math.cos(math.radians(35.0))))
    west_km, east_km = chart.km(35.0, -80.0 - half_deg)[0], chart.km(35.0, -80.0 + half_deg)[0]
    assert east_km - west_km == pytest.approx(bar_km, rel=0.005)
    assert bar_km in (100.0, 200.0)
