"""What reading the wind at a point costs, against scipy and xarray on the same field and points."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import xarray as xr
from scipy.interpolate import RegularGridInterpolator
from tables import table, times
from timing import clocked, say

from planner.grid import Grid
from planner.windfield import WindField

TITLE = "Wind at a point"

TARGET_US, CACHED_TARGET_US = 5.0, 2.0
SAME_MPS = 1e-6
POINTS, FEW = 20_000, 20
_SHAPE = (19, 7, 120, 160)

Point = tuple[float, float, float, float]
Points = Sequence[Point]


def field() -> WindField:
    """Eighteen hours on seven heights, no two values alike."""
    grid = Grid.covering(*map(math.radians, (24.0, 28.0, -88.0, -82.0)), rows=_SHAPE[2], columns=_SHAPE[3])
    north, east = np.random.default_rng(7).normal(0.0, 15.0, (2, *_SHAPE)).astype(np.float32)
    height_m = np.array([10.0, 100.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0])
    return WindField(grid, 3600.0 * np.arange(_SHAPE[0]), north, east, height_m)


def scattered(wind: WindField) -> Points:
    """Anywhere, so that hardly two lie in one cell."""
    random = np.random.default_rng(11)
    assert wind.height_m is not None
    axes = (wind.time_s, wind.grid.lat_rad, wind.grid.lon_rad, wind.height_m)
    columns = [random.uniform(axis[0], axis[-1], POINTS) for axis in axes]
    return list(zip(*(column.tolist() for column in columns), strict=True))


def flown(wind: WindField) -> Points:
    """Five times a second along a straight line at 30 m/s, about 1000 m."""
    second = np.arange(POINTS) / 5.0
    lat_rad = wind.grid.lat_rad[3] + second * 20.0 / 6_370_000.0
    lon_rad = wind.grid.lon_rad[3] + second * 22.0 / 6_370_000.0
    altitude_m = 1000.5 + np.sin(second)
    return list(zip(*(a.tolist() for a in (second, lat_rad, lon_rad, altitude_m)), strict=True))


def _each(look: Callable[..., object], points: Points) -> None:
    for point in points:
        look(*point)


def by_scipy(wind: WindField) -> Callable[[Point], tuple[float, float]]:
    """One interpolator for both components."""
    assert wind.height_m is not None
    axes = (wind.time_s, wind.height_m, wind.grid.lat_rad, wind.grid.lon_rad)
    both = RegularGridInterpolator(axes, np.stack([wind.north_mps, wind.east_mps], axis=-1).astype(float))

    def look(point: Point) -> tuple[float, float]:
        time_s, lat_rad, lon_rad, altitude_m = point
        ((north, east),) = both((time_s, altitude_m, lat_rad, lon_rad)).reshape(1, 2)
        return float(north), float(east)

    return look


def by_xarray(wind: WindField) -> Callable[[Point], tuple[float, float]]:
    """`xarray.interp` of a dataset with both components."""
    coords = {
        "time": wind.time_s,
        "height": wind.height_m,
        "lat": wind.grid.lat_rad,
        "lon": wind.grid.lon_rad,
    }
    parts = {"north": wind.north_mps, "east": wind.east_mps}
    data = xr.Dataset(
        {name: (list(coords), part.astype(float)) for name, part in parts.items()}, coords=coords
    )

    def look(point: Point) -> tuple[float, float]:
        time_s, lat_rad, lon_rad, altitude_m = point
        found = data.interp(time=time_s, height=altitude_m, lat=lat_rad, lon=lon_rad)
        return float(found["north"]), float(found["east"])

    return look


def section() -> str:
    """The section of the page."""
    repeats, wind = 12, field()
    everywhere, along = scattered(wind), flown(wind)
    scipy_look, xarray_look = by_scipy(wind), by_xarray(wind)
    for name, look in (("scipy", scipy_look), ("xarray", xarray_look)):
        for point in everywhere[:FEW]:
            apart_mps = np.abs(np.subtract(look(point), wind.at(*point)[:2])).max()
            if not apart_mps < SAME_MPS:
                raise SystemExit(f"{name} says {look(point)} at {point}, the field {wind.at(*point)}")
    say("scipy and xarray agree; taking times")
    asked: dict[str, Callable[[], None]] = {
        "along a flight, the cell cached": lambda: _each(wind.probe(), along),
        "anywhere, no cell cached": lambda: _each(wind.probe(), everywhere),
    }
    cost_us = {name: 1e6 * clocked(ask, repeats)[0] / POINTS for name, ask in asked.items()}
    many = partial(wind.at_many, *np.transpose(everywhere))
    cost_us["20,000 points anywhere in one call"] = 1e6 * clocked(many, repeats)[0] / POINTS
    theirs_us = {
        "scipy": 1e6 * clocked(lambda: [scipy_look(point) for point in everywhere[:500]], repeats)[0] / 500,
        "xarray": 1e6 * clocked(lambda: [xarray_look(point) for point in everywhere[:FEW]])[0] / FEW,
    }
    targets = (f"{CACHED_TARGET_US:g} µs", f"{TARGET_US:g} µs", f"{TARGET_US:g} µs")
    rows = [
        [name, f"{us:.2f} µs", target, times(theirs_us["scipy"] / us), times(theirs_us["xarray"] / us)]
        for (name, us), target in zip(cost_us.items(), targets, strict=True)
    ]
    lines = [
        f"North, east and down at one time, place and height of a field of {' x '.join(map(str, _SHAPE))} "
        "values (time, height, north, east), interpolated linearly along all four. Scipy's "
        f"`RegularGridInterpolator` takes {theirs_us['scipy']:.0f} µs for two components in the same run, "
        f"`xarray.interp` {theirs_us['xarray'] / 1e3:.1f} ms; all agree to {SAME_MPS:g} m/s. The flight is "
        "read five times a second at 30 m/s.",
        "",
        table(["asked", "a lookup", "target, below", "times as fast as scipy", "as xarray"], rows),
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    print(section())
