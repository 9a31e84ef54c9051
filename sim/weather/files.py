"""Wind from NetCDF files that follow the CF conventions."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from planner.errors import PlannerError
from planner.grid import Grid
from planner.windfield import WindField
from sim.errors import WeatherError
from sim.weather.cf import AxisNames, find_axes, find_winds, heights_m, metres_per_second, times_s

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

_REGULAR = 1e-3  # nodes this share of a step off even spacing are taken for even
_MOST_STRETCH = 1.25  # steps may differ by this factor, as they do on Mercator and Gaussian grids

Bounds = tuple[float, float, float, float]


def read_wind(
    path: Path,
    *,
    variables: tuple[str, str] | None = None,
    area_rad: Bounds | None = None,
    hold: bool = False,
) -> WindField:
    """Read the wind of a CF NetCDF file on the file's own grid, in the file's own precision.

    East and north components are found by standard name (`eastward_wind`, `northward_wind`; `x_wind`,
    `y_wind` on a latitude-longitude grid), else by usual names; an upward component (`upward_air_velocity`)
    is taken along if there is one. A height axis in metres becomes the field's heights: heights above the
    ground are taken for heights above the sea, which holds over water. Latitudes may run either way,
    longitudes may count to 180 or 360 deg. Latitudes or longitudes whose steps differ by up to a quarter
    (Mercator, Gaussian grids) are interpolated linearly to as many evenly spaced ones.

    Args:
        path: of the file.
        variables: the names of the east and the north component, where a file has several winds.
        area_rad: south, north, west and east bound [rad] of the part to read; it grows to whole cells.
        hold: see `WindField`.

    Raises:
        WeatherError: if the file is missing or no NetCDF, lacks winds or axes, has an unknown unit, calendar
            or height axis, uneven spacing, times that do not rise, or gaps in the part that is read.
    """
    import xarray as xr

    if not path.is_file():
        raise WeatherError(f"there is no weather file {path}; check the path")
    try:
        dataset = xr.open_dataset(path, engine="netcdf4", decode_times=False)
    except (OSError, ValueError) as error:
        raise WeatherError(f"{path} cannot be read as NetCDF ({error}); convert it to NetCDF") from error
    with dataset:
        try:
            return _field(dataset, variables, area_rad, hold)
        except (WeatherError, PlannerError) as error:
            raise WeatherError(f"the weather file {path} cannot be used: {error}") from error


def _field(
    dataset: xr.Dataset, variables: tuple[str, str] | None, area_rad: Bounds | None, hold: bool
) -> WindField:
    east, north, up = find_winds(dataset, variables)
    names = [east, north] if up is None else [east, north, up]
    for name in names:
        if set(dataset[name].dims) != set(dataset[east].dims):
            raise WeatherError(
                f"the winds {east} and {name} lie on different axes, {dataset[east].dims} and "
                f"{dataset[name].dims}; give them the same"
            )
    axes = find_axes(dataset[east])
    factors = [metres_per_second(dataset[name]) for name in names]
    time_s = times_s(dataset[axes.time])
    winds = _in_order(dataset[names], axes).assign_coords(
        {axes.time: (time_s * 1e9).astype("datetime64[ns]")}
    )
    if area_rad is not None:
        winds = _cut(winds, axes, area_rad)
    winds = winds.load()
    for name in names:
        _refuse_gaps(winds[name])
    winds = _evenly_spaced(_evenly_spaced(winds, axes.lat), axes.lon)
    east_mps, north_mps, *up_mps = (
        winds[name].values * factor for name, factor in zip(names, factors, strict=True)
    )
    lat_rad, lon_rad = np.radians(winds[axes.lat].values), np.radians(winds[axes.lon].values)
    grid = Grid.covering(
        float(lat_rad[0]),
        float(lat_rad[-1]),
        float(lon_rad[0]),
        float(lon_rad[-1]),
        rows=lat_rad.size,
        columns=lon_rad.size,
    )
    return WindField(
        grid,
        time_s,
        north_mps,
        east_mps,
        None if axes.height is None else heights_m(winds[axes.height]),
        -up_mps[0] if up_mps else None,
        hold,
    )


def _in_order(winds: xr.Dataset, axes: AxisNames) -> xr.Dataset:
    """Dimensions time, (height,) lat, lon, named for their coordinates, all but time sorted to rise."""
    kept = [name for name in (axes.time, axes.height, axes.lat, axes.lon) if name is not None]
    named = {winds[name].dims[0]: name for name in kept if winds[name].ndim and winds[name].dims[0] != name}
    winds = winds.swap_dims(named)
    winds = winds.isel({name: 0 for name in winds.dims if name not in kept})
    if winds[axes.time].ndim == 0:
        winds = winds.expand_dims(axes.time)
    lon_deg = np.unwrap(winds[axes.lon].values.astype(np.float64), period=360.0)  # 359, 0 becomes 359, 360
    winds = winds.assign_coords({axes.lon: lon_deg, axes.lat: winds[axes.lat].values.astype(np.float64)})
    return winds.sortby(kept[1:]).transpose(*kept)


def _cut(winds: xr.Dataset, axes: AxisNames, area_rad: Bounds) -> xr.Dataset:
    """The cells around an area, with longitudes counted so that they rise through it."""
    south, north, west, east = (math.degrees(bound) for bound in area_rad)
    lon_deg = winds[axes.lon].values
    turned = lon_deg - 360.0 * np.rint((lon_deg - (west + east) / 2.0) / 360.0)
    winds = winds.assign_coords({axes.lon: turned}).sortby(axes.lon).drop_duplicates(axes.lon)
    for name, low, high in ((axes.lat, south, north), (axes.lon, west, east)):
        nodes = winds[name].values
        first = max(int(np.searchsorted(nodes, low, side="right")) - 1, 0)
        end = int(np.searchsorted(nodes, high, side="left")) + 1
        if end - first < 2 or low > nodes[-1] or high < nodes[0]:
            raise WeatherError(
                f"its {name} runs from {nodes[0]:.3f} to {nodes[-1]:.3f} and has less than two values from "
                f"{low:.3f} to {high:.3f} deg; choose an area inside"
            )
        winds = winds.isel({name: slice(first, end)})
    return winds


def _refuse_gaps(wind: xr.DataArray) -> None:
    gaps = np.isnan(wind.values)
    if gaps.any():
        first = np.unravel_index(int(np.argmax(gaps)), gaps.shape)
        place = ", ".join(
            f"{name} {str(wind[name].values[index])[:19]}"
            for name, index in zip(wind.dims, first, strict=True)
        )
        raise WeatherError(
            f"the wind {wind.name} has {np.count_nonzero(gaps)} gaps (NaN or fill values) among {gaps.size} "
            f"values, the first at {place}; fill them or choose an area without"
        )


def _evenly_spaced(winds: xr.Dataset, axis: str) -> xr.Dataset:
    """The winds on evenly spaced values of an axis that is nearly so.

    Raises:
        WeatherError: if it is not.
    """
    nodes = winds[axis].values
    steps = np.diff(nodes)
    if nodes.size < 2 or not steps.min() * _MOST_STRETCH >= steps.max() > 0.0:
        detail = f"steps from {steps.min():.5g} to {steps.max():.5g} deg" if steps.size else "one value"
        raise WeatherError(
            f"its {axis} has {detail}, but a grid needs two values or more and steps that differ by less "
            "than a quarter; regrid it to a regular latitude-longitude grid"
        )
    even = np.linspace(nodes[0], nodes[-1], nodes.size)
    if np.abs(nodes - even).max() <= _REGULAR * steps.max():
        return winds.assign_coords({axis: even})
    return winds.interp({axis: even}).astype({name: values.dtype for name, values in winds.data_vars.items()})
