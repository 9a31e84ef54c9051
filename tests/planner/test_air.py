"""The air between stages and times of the field, and the chart of the cells."""

import math

import numpy as np

from planner.air import Air, Chart
from planner.grid import Grid
from planner.hazards import StageClock
from planner.windfield import WindField

GRID = Grid.covering(*map(math.radians, (24.0, 28.0, -88.0, -82.0)), rows=9, columns=13)


def test_wind_is_linear_between_the_times_of_the_air():
    random = np.random.default_rng(1)
    time_s = np.array([0.0, 1000.0, 2500.0, 9000.0])
    wind = WindField(GRID, time_s, *random.normal(0.0, 10.0, (2, 4, *GRID.shape)))
    clock = StageClock(500.0, stage_count=3, steps_per_stage=5)
    air = Air.over(wind, clock)
    assert air.time_s.tolist() == [0.0, 500.0, 600.0, 1200.0, 1800.0]
    for at_s in (0.0, 250.0, 550.0, 1199.0, 1500.0, 1800.0):
        north, east = wind.sheet(500.0 + at_s)
        place = int(np.searchsorted(air.time_s, at_s, side="right")) - 1
        place = min(place, air.time_s.size - 2)
        share = (at_s - air.time_s[place]) / (air.time_s[place + 1] - air.time_s[place])
        blend = (1.0 - share) * air.wind_mps[place] + share * air.wind_mps[place + 1]
        np.testing.assert_allclose(blend, north + 1j * east, atol=1e-5)


def test_the_chart_is_the_mercator_plane_of_the_grid():
    chart = Chart.of(GRID)
    for row, column in ((0, 0), (3, 7), (8, 12)):
        north_m, east_m = GRID.frame.to_plane(GRID.lat_rad[row], GRID.lon_rad[column])
        np.testing.assert_allclose((chart.north_m[row], chart.east_m[column]), (north_m, east_m), atol=1e-6)
    true_m = np.diff(chart.north_m) / (0.5 * (chart.scale[1:] + chart.scale[:-1]))
    np.testing.assert_allclose(true_m, GRID.north_cell_m[:-1], rtol=2e-5)
    np.testing.assert_allclose(np.diff(chart.east_m)[0] / chart.scale, GRID.east_cell_m, rtol=1e-9)
