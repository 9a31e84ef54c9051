import math

import numpy as np
import pyproj
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.errors import OutsideGridError
from planner.grid import Grid, LocalFrame, geodesic_m

GEOD = pyproj.Geod(ellps="WGS84")
TURN = 2.0 * math.pi


def degrees_grid(south: float, north: float, west: float, east: float, rows: int, columns: int) -> Grid:
    return Grid.covering(*map(math.radians, (south, north, west, east)), rows=rows, columns=columns)


GULF = degrees_grid(22.5, 34.5, -91.5, -76.5, 371, 408)
DATE_LINE = degrees_grid(-20.0, -10.0, 175.0, 190.0, 41, 61)


@pytest.mark.parametrize("grid", [GULF, DATE_LINE])
def test_cell_sizes_agree_with_geodesics(grid: Grid) -> None:
    lat, lon = np.degrees(grid.lat_rad), np.degrees(grid.lon_rad)
    north_m = GEOD.inv(np.full(grid.rows - 1, lon[0]), lat[:-1], np.full(grid.rows - 1, lon[0]), lat[1:])[2]
    east_m = GEOD.inv(np.full(grid.rows, lon[0]), lat, np.full(grid.rows, lon[1]), lat)[2]
    np.testing.assert_allclose(grid.north_cell_m[:-1], north_m, rtol=1e-6)
    np.testing.assert_allclose(grid.east_cell_m, east_m, rtol=1e-6)


@given(row=st.integers(0, 370), column=st.integers(0, 407), turns=st.integers(-2, 2))
def test_the_centre_of_a_cell_lies_in_it_whatever_turn_the_longitude_counts(
    row: int, column: int, turns: int
) -> None:
    lat_rad, lon_rad = float(GULF.lat_rad[row]), float(GULF.lon_rad[column]) + turns * TURN
    assert GULF.nearest_cell(lat_rad, lon_rad) == (row, column)
    np.testing.assert_allclose(GULF.indices(lat_rad, lon_rad), (row, column), atol=1e-9)


def test_indices_take_arrays_and_agree_with_scalars() -> None:
    lat_rad, lon_rad = np.radians([-19.9, -12.3, -5.0]), np.radians([179.9, -179.9, -171.0])
    rows, columns = DATE_LINE.indices(lat_rad, lon_rad)
    for index in range(3):
        one = DATE_LINE.indices(float(lat_rad[index]), float(lon_rad[index]))
        assert one == (rows[index], columns[index])
    np.testing.assert_allclose(columns, (np.array([179.9, 180.1, 189.0]) - 175.0) / 0.25, atol=1e-9)


def test_longitudes_rise_across_the_date_line() -> None:
    assert (np.diff(DATE_LINE.lon_rad) > 0.0).all()
    assert DATE_LINE.nearest_cell(math.radians(-15.0), math.radians(-175.0)) == (20, 40)


def test_half_a_cell_beyond_the_outermost_centres_is_still_on_the_grid() -> None:
    half_rad = 0.499 * GULF.north_step_rad
    north_rad = float(GULF.lat_rad[-1])
    assert GULF.nearest_cell(north_rad + half_rad, float(GULF.lon_rad[0])) == (370, 0)
    with pytest.raises(
        OutsideGridError, match=r"the goal at 34\.5.*covers 22\.50 N to 34\.50 N.*move it inside"
    ):
        GULF.nearest_cell(north_rad + 1.1 * half_rad, float(GULF.lon_rad[0]), "goal")


@pytest.mark.parametrize(
    ("lat_deg", "lon_deg"), [(22.0, -80.0), (35.0, -80.0), (28.0, -92.0), (28.0, -76.0), (math.nan, -80.0)]
)
def test_positions_off_the_grid_are_refused(lat_deg: float, lon_deg: float) -> None:
    with pytest.raises(OutsideGridError, match="off the grid"):
        GULF.nearest_cell(math.radians(lat_deg), math.radians(lon_deg))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, 0.0, 0.1, 0.1, 0, 3), "at least one cell, not 0 x 3"),
        ((0.0, 0.0, 0.0, 0.1, 3, 3), "north step of a grid must be positive, not 0"),
        ((0.0, 0.0, 0.1, -0.1, 3, 3), "east step of a grid must be positive, not -0.1"),
        ((0.0, 0.0, math.nan, 0.1, 3, 3), "north step"),
        ((25.0, -80.0, 0.1, 0.1, 3, 3), "give angles in radians"),
        ((0.0, math.inf, 0.1, 0.1, 3, 3), "does not lie on the Earth"),
    ],
)
def test_impossible_grids_are_refused(
    arguments: tuple[float, float, float, float, int, int], message: str
) -> None:
    with pytest.raises(OutsideGridError, match=message):
        Grid(*arguments)


def test_bounds_in_the_wrong_order_or_with_one_row_are_refused() -> None:
    with pytest.raises(OutsideGridError, match="east step"):
        degrees_grid(20.0, 30.0, 179.0, -179.0, 10, 10)
    with pytest.raises(OutsideGridError, match="2 x 2 cells between them, not 1 x 10"):
        degrees_grid(20.0, 30.0, 170.0, 179.0, 1, 10)


def test_covering_puts_the_outermost_centres_on_the_bounds() -> None:
    lat, lon = np.degrees(GULF.lat_rad), np.degrees(GULF.lon_rad)
    np.testing.assert_allclose((lat[0], lat[-1], lon[0], lon[-1]), (22.5, 34.5, -91.5, -76.5), atol=1e-12)
    assert GULF.shape == (lat.size, lon.size) == (371, 408)


positions = st.tuples(st.floats(22.5, 34.5), st.floats(-91.5, -76.5))


@given(position=positions, bearing_deg=st.floats(-180.0, 180.0))
def test_the_plane_is_true_in_angle_and_its_scale_in_length(
    position: tuple[float, float], bearing_deg: float
) -> None:
    lat_deg, lon_deg = position
    end_lon_deg, end_lat_deg, _ = GEOD.fwd(lon_deg, lat_deg, bearing_deg, 100.0)
    start = GULF.frame.to_plane(math.radians(lat_deg), math.radians(lon_deg))
    end = GULF.frame.to_plane(math.radians(end_lat_deg), math.radians(end_lon_deg))
    north_m, east_m = end[0] - start[0], end[1] - start[1]
    scale = GULF.frame.scale(math.radians((lat_deg + end_lat_deg) / 2.0))
    assert math.hypot(north_m, east_m) / scale == pytest.approx(100.0, rel=1e-6)
    off_rad = math.remainder(math.atan2(east_m, north_m) - math.radians(bearing_deg), TURN)
    assert abs(off_rad) < 1e-4


@given(position=positions)
def test_the_plane_gives_positions_back(position: tuple[float, float]) -> None:
    lat_rad, lon_rad = map(math.radians, position)
    back = GULF.frame.to_geodetic(*GULF.frame.to_plane(lat_rad, lon_rad))
    np.testing.assert_allclose(back, (lat_rad, lon_rad), atol=1e-11)


def test_the_plane_has_its_origin_in_the_middle_and_scale_one_there() -> None:
    frame = GULF.frame
    np.testing.assert_allclose(frame.to_plane(math.radians(28.5), math.radians(-84.0)), (0.0, 0.0), atol=1e-6)
    assert frame.scale(math.radians(28.5)) == pytest.approx(1.0, abs=1e-12)
    assert frame.scale(math.radians(34.5)) > 1.0 > frame.scale(math.radians(22.5))


def test_the_plane_has_no_seam_at_the_date_line() -> None:
    frame = DATE_LINE.frame
    west = frame.to_plane(math.radians(-15.0), math.radians(179.9))
    east = frame.to_plane(math.radians(-15.0), math.radians(-179.9))
    true_m = GEOD.inv(179.9, -15.0, -179.9, -15.0)[2]
    assert (east[1] - west[1]) / frame.scale(math.radians(-15.0)) == pytest.approx(true_m, rel=1e-5)


def test_a_plane_near_a_pole_is_refused() -> None:
    with pytest.raises(OutsideGridError, match=r"85\.00 deg.*within 80 deg"):
        LocalFrame(math.radians(85.0), 0.0)


def test_geodesic_agrees_with_a_published_line() -> None:
    # Flinders Peak to Buninyong, the test line of the GDA94 Technical Manual (GRS80): 54 972.271 m.
    flinders = -(37 + 57 / 60 + 3.72030 / 3600), 144 + 25 / 60 + 29.52440 / 3600
    buninyong = -(37 + 39 / 60 + 10.15610 / 3600), 143 + 55 / 60 + 35.38390 / 3600
    length_m = geodesic_m(*map(math.radians, (*flinders, *buninyong)))
    assert length_m == pytest.approx(54972.271, abs=2e-3)


@given(lat_deg=st.floats(-79.0, 79.0), lon_deg=st.floats(-179.0, 179.0), turns=st.integers(-1, 1))
def test_a_single_point_lies_where_proj_puts_it(lat_deg: float, lon_deg: float, turns: int) -> None:
    frame = LocalFrame(math.radians(28.5), math.radians(-84.0))
    lat_rad, lon_rad = math.radians(lat_deg), math.radians(lon_deg)
    north_m, east_m, scale = frame.plane_point(lat_rad, lon_rad + turns * TURN)
    expected_north_m, expected_east_m = frame.to_plane(lat_rad, lon_rad)
    assert north_m == pytest.approx(expected_north_m, abs=1e-6)
    assert math.remainder(
        east_m - expected_east_m, 2.0 * frame.plane_point(0.0, frame.origin_lon_rad + math.pi)[1]
    ) == pytest.approx(0.0, abs=1e-6)
    assert scale == pytest.approx(frame.scale(lat_rad), rel=1e-12)
