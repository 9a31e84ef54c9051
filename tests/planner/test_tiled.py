"""Values that are read when they are asked for: the same as if they were there, and no more than needed."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.grid import Grid
from planner.tiled import TILE_CELLS, TiledArray, Tiles
from planner.windfield import FieldArray, WindField

SHAPE = (3, 2, 150, 200)
VALUES = np.random.default_rng(3).normal(0.0, 10.0, (3, *SHAPE)).astype(np.float32)
GRID = Grid.covering(*np.radians([24.0, 27.0, -90.0, -86.0]).tolist(), rows=150, columns=200)
TIME_S, HEIGHT_M = 3600.0 * np.arange(3.0), np.array([500.0, 1500.0])


class Source:
    """Counts what is read of it."""

    def __init__(self) -> None:
        self.read_values = 0

    def __call__(self, time: int, *place: slice) -> tuple[Any, ...]:
        found = tuple(VALUES[component, time][place] for component in range(3))
        self.read_values += sum(part.size for part in found)
        return found


def fields() -> tuple[WindField, WindField, Source]:
    """The same field, there and to be read."""
    source = Source()
    tiles = Tiles(source, SHAPE)
    unread = [cast(FieldArray, TiledArray(tiles, component)) for component in range(3)]
    there = WindField(GRID, TIME_S, VALUES[0], VALUES[1], HEIGHT_M, VALUES[2])
    return there, WindField(GRID, TIME_S, unread[0], unread[1], HEIGHT_M, unread[2]), source


@st.composite
def keys(draw: st.DrawFn) -> tuple[Any, ...]:
    """As many indices as a question may have: numbers, runs, and two of each axis."""
    axes = SHAPE[: draw(st.integers(1, 4))]
    if draw(st.booleans()):
        return np.ix_(
            *(sorted(draw(st.lists(st.integers(0, size - 1), min_size=2, max_size=2))) for size in axes)
        )
    found: list[Any] = []
    for size in axes:
        low, high = sorted(draw(st.lists(st.integers(0, size - 1), min_size=2, max_size=2)))
        found.append(draw(st.sampled_from([low, slice(low, high + 1), slice(None)])))
    return tuple(found)


@given(keys(), st.sampled_from([1.0, 1.5]), st.integers(0, 2))
def test_every_index_gives_what_numpy_gives(key: tuple[Any, ...], factor: float, component: int) -> None:
    array = factor * TiledArray(Tiles(Source(), SHAPE), component)
    np.testing.assert_array_equal(array[key], np.float32(factor) * VALUES[component][key])


def test_without_heights_that_axis_is_not_there() -> None:
    tiles = Tiles(lambda time, heights, *place: (VALUES[0, time][heights, *place],), (3, 1, 150, 200))
    flat = TiledArray(tiles, 0, flat=True)
    assert (flat.shape, flat.ndim, flat.dtype) == ((3, 150, 200), 3, np.float32)
    np.testing.assert_array_equal(flat[1:, 100, 60:70], VALUES[0, 1:, 0, 100, 60:70])


def test_a_flight_reads_the_tiles_on_its_way_once() -> None:
    there, unread, source = fields()
    random, share = np.random.default_rng(1), np.linspace(0.0, 1.0, 900)
    points = np.stack(
        [
            share * 0.9 * TIME_S[-1],
            GRID.lat_rad[10] + share * (GRID.lat_rad[50] - GRID.lat_rad[10]),
            GRID.lon_rad[10] + share * (GRID.lon_rad[120] - GRID.lon_rad[10]),
            1000.0 + random.normal(0.0, 5.0, share.size),
        ]
    ).T.tolist()
    theirs, ours = there.probe(), unread.probe()
    assert [ours(*point) for point in points] == [theirs(*point) for point in points]
    assert source.read_values <= 3 * 3 * 2 * 2 * TILE_CELLS**2  # components, times, heights, tiles


def test_what_is_made_of_it_is_the_same() -> None:
    there, unread, _ = fields()
    grid = Grid.covering(*np.radians([24.5, 26.5, -89.5, -86.5]).tolist(), rows=23, columns=31)
    for name in ("north_mps", "east_mps", "down_mps"):
        expected = getattr(there.at_altitude(750.0).resampled(grid), name)
        for field in (there, unread):
            found = field.level(750.0, grid)
            np.testing.assert_array_equal(getattr(found, name), expected)
            assert found.height_m is None
    points = [
        np.array([0.0, 5000.0]),
        np.radians([24.2, 26.9]),
        np.radians([-89.9, -86.1]),
        np.array([500.0, 900.0]),
    ]
    np.testing.assert_array_equal(unread.at_many(*points), there.at_many(*points))


def test_a_level_of_wind_without_heights_is_that_wind() -> None:
    field = WindField(GRID, TIME_S, VALUES[0, :, 0], VALUES[1, :, 0])
    grid = Grid.covering(*np.radians([24.5, 26.5, -89.5, -86.5]).tolist(), rows=5, columns=5)
    np.testing.assert_array_equal(field.level(3.0, grid).north_mps, field.resampled(grid).north_mps)


def test_tiles_read_long_ago_are_read_again() -> None:
    source = Source()
    array = TiledArray(Tiles(source, SHAPE), 0)
    first = array[0, 0, 0, 0]
    once = source.read_values
    assert array[0, 0, 5, 5] == VALUES[0, 0, 0, 5, 5]
    assert source.read_values == once
    for _ in range(20):
        for time in range(3):
            for row in range(0, 150, TILE_CELLS):
                for column in range(0, 200, TILE_CELLS):
                    assert array[time, 1, row, column] == VALUES[0, time, 1, row, column]
    assert array[0, 0, 0, 0] == first


def test_what_is_read_is_as_wide_as_the_question() -> None:
    source = Source()
    array = TiledArray(Tiles(source, SHAPE), 1)
    whole = array[2, 1]
    assert source.read_values == 3 * whole.size
    with pytest.raises(IndexError):
        array[0, 5]
