import itertools
import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from planner.errors import BadFieldError, OutsideFieldError
from planner.grid import Grid
from planner.windfield import Wind, WindField

TURN = 2.0 * math.pi
NOON_S = 1664452800.0  # 2022-09-29 12:00 UTC
TIME_S = NOON_S + np.array([0.0, 1800.0, 3000.0, 7200.0])
HEIGHT_M = np.array([10.0, 100.0, 500.0, 2000.0])
GULF = Grid.covering(*map(math.radians, (24.0, 28.0, -88.0, -82.0)), rows=9, columns=13)
DATE_LINE = Grid.covering(*map(math.radians, (-20.0, -16.0, 177.0, 183.0)), rows=9, columns=13)


def random_field(
    grid: Grid = GULF, *, layers: bool = False, dtype: Any = np.float64, **more: Any
) -> WindField:
    shape = (TIME_S.size, *((HEIGHT_M.size,) if layers else ()), *grid.shape)
    north, east, down = np.random.default_rng(7).normal(0.0, 15.0, (3, *shape)).astype(dtype)
    return WindField(grid, TIME_S.copy(), north, east, HEIGHT_M.copy() if layers else None, down, **more)


def random_points(grid: Grid, count: int) -> list[Any]:
    """Time, latitude, longitude and altitude, each of shape (count,)."""
    random = np.random.default_rng(11)
    return [
        random.uniform(TIME_S[0], TIME_S[-1], count),
        random.uniform(grid.lat_rad[0], grid.lat_rad[-1], count),
        random.uniform(grid.lon_rad[0], grid.lon_rad[-1], count),
        random.uniform(HEIGHT_M[0], HEIGHT_M[-1], count),
    ]


def by_xarray(field: WindField, points: list[Any]) -> list[Any]:
    layers = field.height_m is not None
    axes = {
        "time": field.time_s,
        "height": field.height_m,
        "lat": field.grid.lat_rad,
        "lon": field.grid.lon_rad,
    }
    wanted = {"time": points[0], "lat": points[1], "lon": points[2], "height": points[3]}
    dims = [name for name in axes if layers or name != "height"]
    return [
        xr.DataArray(values, dims=dims, coords={name: axes[name] for name in dims})
        .astype(float)
        .interp({name: xr.DataArray(wanted[name], dims="point") for name in dims})
        .values
        for values in (field.north_mps, field.east_mps, field.down_mps)
    ]


@pytest.mark.parametrize("grid", [GULF, DATE_LINE])
@pytest.mark.parametrize("layers", [False, True])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_all_ways_to_ask_agree_with_xarray(grid: Grid, layers: bool, dtype: Any) -> None:
    field = random_field(grid, layers=layers, dtype=dtype)
    points = random_points(grid, 400)
    oracle = by_xarray(field, points)
    np.testing.assert_allclose(field.at_many(*points), oracle, atol=1e-6)
    probe = field.probe()
    each = list(zip(*(values.tolist() for values in points), strict=True))
    np.testing.assert_allclose(np.transpose([probe(*point) for point in each]), oracle, atol=1e-6)
    np.testing.assert_allclose(np.transpose([field.at(*point) for point in each]), oracle, atol=1e-6)


@given(
    fraction=st.tuples(*[st.floats(0.0, 1.0)] * 4),
    turns=st.integers(-1, 1),
)
def test_wind_stays_within_the_range_of_its_neighbours(fraction: tuple[float, ...], turns: int) -> None:
    field = random_field(layers=True)
    axes = [TIME_S, HEIGHT_M, GULF.lat_rad, GULF.lon_rad]
    time_s, altitude_m, lat_rad, lon_rad = (
        float(axis[0] + share * (axis[-1] - axis[0])) for axis, share in zip(axes, fraction, strict=True)
    )
    place = []
    for axis, value in zip(axes, (time_s, altitude_m, lat_rad, lon_rad), strict=True):
        below = min(int(np.searchsorted(axis, value, side="right")) - 1, axis.size - 2)
        place.append((below, below + 1))
    point = time_s, lat_rad, lon_rad + turns * TURN, altitude_m
    asked = (field.at(*point), field.probe()(*point), [float(part) for part in field.at_many(*point)])
    for values, *found in zip((field.north_mps, field.east_mps, field.down_mps), *asked, strict=True):
        corners = values[np.ix_(*place)]  # type: ignore[index]
        for wind_mps in found:
            assert corners.min() - 1e-9 <= wind_mps <= corners.max() + 1e-9


def test_the_nodes_themselves_come_back() -> None:
    field = random_field(layers=True)
    for time, height, row, column in itertools.product((0, 3), (0, 2, 3), (0, 4, 8), (0, 7, 12)):
        point = TIME_S[time], GULF.lat_rad[row], GULF.lon_rad[column], HEIGHT_M[height]
        assert field.at(*point).north_mps == pytest.approx(
            field.north_mps[time, height, row, column], abs=1e-9
        )


def test_a_probe_follows_a_flight_over_the_date_line_and_back() -> None:
    field = random_field(DATE_LINE)
    probe = field.probe()
    share = np.linspace(0.0, TURN, 3000)
    lat_rad = np.radians(-18.0 + 1.7 * np.sin(share))
    lon_rad = np.radians(180.0 + 2.8 * np.cos(3.0 * share))
    lon_rad = np.where(lon_rad > math.pi, lon_rad - TURN, lon_rad)  # as an aircraft counts it
    assert lon_rad.min() < -3.1
    assert lon_rad.max() > 3.1
    time_s = NOON_S + 1000.0 * share
    flown = [
        probe(*point, 300.0)
        for point in zip(time_s.tolist(), lat_rad.tolist(), lon_rad.tolist(), strict=True)
    ]
    np.testing.assert_allclose(np.transpose(flown), field.at_many(time_s, lat_rad, lon_rad), atol=1e-9)


def test_a_probe_goes_on_after_a_point_outside() -> None:
    field = random_field()
    probe = field.probe()
    point = NOON_S + 60.0, math.radians(26.1), math.radians(-85.3), 100.0
    before = probe(*point)
    with pytest.raises(OutsideFieldError):
        probe(NOON_S - 60.0, *point[1:])
    assert probe(*point) == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize("grid", [GULF, DATE_LINE])
@pytest.mark.parametrize("layers", [False, True])
def test_a_probe_says_the_same_however_often_it_is_in_a_cell(grid: Grid, layers: bool) -> None:
    field = random_field(grid, layers=layers, hold=True)
    probe, random = field.probe(), np.random.default_rng(5)
    points = np.transpose(random_points(grid, 300))
    points[:100, 1:] = points[0, 1:] + random.uniform(-2e-2, 2e-2, (100, 3))  # often in one of a few cells
    points[150:200] = points[rows := random.integers(0, 100, 50)]
    points[200:250, 2] += random.choice([-TURN, TURN], 50)
    points[250:, 1] += random.choice([-0.08, 0.0, 0.08], 50)  # to the fringe and beyond
    for _ in range(3):
        found = [probe(*point) for point in points.tolist()]
        np.testing.assert_allclose(np.transpose(found), field.at_many(*points.T), atol=1e-9)
    np.testing.assert_allclose(np.array(found)[150:200], np.array(found)[rows], rtol=1e-12)


def test_a_probe_reads_components_of_different_precision() -> None:
    wide = random_field(layers=True)
    mixed = WindField(GULF, TIME_S, wide.north_mps, wide.east_mps.astype(np.float32), HEIGHT_M)
    points = random_points(GULF, 50)
    found = [mixed.at(*point) for point in zip(*(values.tolist() for values in points), strict=True)]
    np.testing.assert_allclose(np.transpose(found), mixed.at_many(*points), atol=1e-9)


INSIDE = {
    "time_s": NOON_S,
    "lat_rad": math.radians(26.0),
    "lon_rad": math.radians(-85.0),
    "altitude_m": 100.0,
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"time_s": NOON_S - 1.0},
            r"time 2022-09-29T11:59:59Z.*covers 2022-09-29T12:00:00Z to 2022-09-29T14:00:00Z",
        ),
        ({"time_s": NOON_S + 7201.0}, "time 2022-09-29T14:00:01Z"),
        ({"altitude_m": 5.0}, r"altitude 5\.0 m.*covers 10\.0 m to 2000\.0 m"),
        ({"altitude_m": 2500.0}, r"altitude 2500\.0 m"),
        ({"lat_rad": math.radians(28.3)}, r"latitude 28\.3000 deg.*covers 24\.0000 deg to 28\.0000 deg"),
        ({"lat_rad": math.nan}, "latitude nan"),
        ({"lon_rad": math.radians(-88.3)}, r"longitude -88\.3000 deg"),
        ({"lon_rad": math.radians(278.3)}, r"longitude -81\.7000 deg"),
    ],
)
def test_outside_is_refused_with_value_limit_and_remedy(change: dict[str, float], message: str) -> None:
    field = random_field(layers=True)
    query = INSIDE | change
    with pytest.raises(OutsideFieldError, match=f"{message}.*set hold"):
        field.at(**query)
    with pytest.raises(OutsideFieldError, match=message):
        field.at_many(**{name: [INSIDE[name], value] for name, value in query.items()})


@pytest.mark.parametrize("layers", [False, True])
def test_hold_answers_outside_with_the_outermost_value(layers: bool) -> None:
    held, strict = random_field(layers=layers, hold=True), random_field(layers=layers)
    random = np.random.default_rng(3)
    points = [
        random.uniform(NOON_S - 1e5, NOON_S + 1e5, 200),
        random.uniform(math.radians(15.0), math.radians(40.0), 200),
        random.uniform(math.radians(-100.0), math.radians(-70.0), 200),
        random.uniform(-1000.0, 5000.0, 200),
    ]
    ends = [(axis[0], axis[-1]) for axis in (TIME_S, GULF.lat_rad, GULF.lon_rad, HEIGHT_M)]
    clamped = [np.clip(values, *end) for values, end in zip(points, ends, strict=True)]
    expected = strict.at_many(*clamped)
    np.testing.assert_allclose(held.at_many(*points), expected, atol=1e-9)
    probe = held.probe()
    each = [probe(*point) for point in zip(*(values.tolist() for values in points), strict=True)]
    np.testing.assert_allclose(np.transpose(each), expected, atol=1e-9)


def test_the_area_reaches_half_a_cell_beyond_the_outermost_centres() -> None:
    field = random_field()
    corner = field.at(NOON_S, GULF.lat_rad[-1], GULF.lon_rad[0])
    beyond = GULF.lat_rad[-1] + 0.49 * GULF.north_step_rad, GULF.lon_rad[0] - 0.49 * GULF.east_step_rad
    assert field.at(NOON_S, *beyond) == pytest.approx(corner)
    with pytest.raises(OutsideFieldError):
        field.at(NOON_S, GULF.lat_rad[-1] + 0.51 * GULF.north_step_rad, GULF.lon_rad[0])


def test_many_points_broadcast() -> None:
    field = random_field()
    north, east, down = field.at_many(TIME_S[:, np.newaxis], GULF.lat_rad[4], GULF.lon_rad, 0.0)
    np.testing.assert_allclose(north, field.north_mps[:, 4], atol=1e-9)
    assert east.shape == down.shape == (4, 13)


def test_a_layer_is_the_field_at_that_altitude() -> None:
    field = random_field(layers=True, hold=True)
    time_s, lat_rad, lon_rad, _ = random_points(GULF, 100)
    for altitude_m in (10.0, 250.0, 2000.0, 3000.0):
        layer = field.at_altitude(altitude_m)
        assert layer.height_m is None
        assert layer.hold
        np.testing.assert_allclose(
            layer.at_many(time_s, lat_rad, lon_rad, -9.0),
            field.at_many(time_s, lat_rad, lon_rad, altitude_m),
            atol=1e-9,
        )
    assert layer.at_altitude(5.0) is layer
    with pytest.raises(OutsideFieldError, match=r"altitude 3000\.0 m"):
        random_field(layers=True).at_altitude(3000.0)


@pytest.mark.parametrize("layers", [False, True])
def test_resampling_takes_the_wind_of_the_old_grid_at_the_new_cells(layers: bool) -> None:
    field = random_field(layers=layers)
    grid = Grid.covering(*map(math.radians, (24.3, 27.1, 273.0, 276.9)), rows=17, columns=5)
    moved = field.resampled(grid)
    assert moved.grid is grid
    lat_rad, lon_rad = np.meshgrid(grid.lat_rad, grid.lon_rad, indexing="ij")
    query = TIME_S[2], lat_rad, lon_rad, 777.0
    np.testing.assert_allclose(moved.at_many(*query), field.at_many(*query), atol=1e-9)


@pytest.mark.parametrize("time_s", [TIME_S[0], NOON_S + 700.0, TIME_S[-1]])
def test_a_sheet_is_the_wind_of_every_cell_at_one_time(time_s: float) -> None:
    field = random_field()
    lat_rad, lon_rad = np.meshgrid(GULF.lat_rad, GULF.lon_rad, indexing="ij")
    north, east, _ = field.at_many(time_s, lat_rad, lon_rad, 0.0)
    np.testing.assert_allclose(field.sheet(time_s), (north, east), atol=1e-9)
    with pytest.raises(OutsideFieldError):
        field.sheet(TIME_S[-1] + 60.0)
    held = random_field(hold=True)
    np.testing.assert_array_equal(held.sheet(TIME_S[-1] + 60.0)[0], held.north_mps[-1])


def test_resampling_keeps_the_precision_and_changes_nothing_on_the_same_grid() -> None:
    field = random_field(dtype=np.float32)
    same = field.resampled(GULF)
    assert same.north_mps.dtype == np.float32
    np.testing.assert_array_equal(same.east_mps, field.east_mps)
    too_wide = Grid.covering(*map(math.radians, (23.0, 28.0, -88.0, -82.0)), rows=9, columns=13)
    with pytest.raises(OutsideFieldError, match=r"latitude 23\.0000 deg"):
        field.resampled(too_wide)


def test_a_field_of_one_time_holds_at_that_time_only() -> None:
    calm = np.zeros((1, *GULF.shape))
    field = WindField(GULF, TIME_S[:1], calm, calm + 3.0)
    assert field.at(NOON_S, INSIDE["lat_rad"], INSIDE["lon_rad"]) == Wind(0.0, 3.0, 0.0)
    with pytest.raises(OutsideFieldError, match="time"):
        field.at(NOON_S + 1.0, INSIDE["lat_rad"], INSIDE["lon_rad"])


def test_arrays_are_read_only_and_whole_numbers_become_floats() -> None:
    north: Any = np.ones((4, *GULF.shape), dtype=np.int64)
    field = WindField(GULF, TIME_S.copy(), north, north)
    assert field.north_mps.dtype == np.float64
    for values in (field.time_s, field.north_mps, field.east_mps):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0


def test_shapes_that_disagree_are_refused() -> None:
    right, wrong = np.zeros((4, 9, 13)), np.zeros((4, 13, 9))
    with pytest.raises(
        BadFieldError, match=r"east_mps has shape \(4, 13, 9\).*time, latitude, longitude.*\(4, 9, 13\)"
    ):
        WindField(GULF, TIME_S, right, wrong)
    with pytest.raises(BadFieldError, match=r"north_mps has shape \(4, 9, 13\).*altitude"):
        WindField(GULF, TIME_S, right, right, HEIGHT_M)
    with pytest.raises(BadFieldError, match="down_mps"):
        WindField(GULF, TIME_S, right, right, None, wrong)
    with pytest.raises(BadFieldError, match="time must be finite and rise"):
        WindField(GULF, TIME_S[::-1], right, right)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_values_that_are_not_finite_are_refused_naming_the_first(bad: float) -> None:
    calm, broken = np.zeros((4, 9, 13)), np.zeros((4, 9, 13))
    broken[1, 2, 3] = broken[2, 0, 0] = bad
    message = (
        rf"east_mps has 2 values of 468 that are not finite, the first \({bad}\) at time "
        r"2022-09-29T12:30:00Z, latitude 25\.0000 deg, longitude -86\.5000 deg; fill the gaps"
    )
    with pytest.raises(BadFieldError, match=message):
        WindField(GULF, TIME_S, calm, broken)


def test_wind_knows_its_speed() -> None:
    assert Wind(3.0, -4.0).speed_mps == 5.0
