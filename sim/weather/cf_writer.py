"""Wind written as NetCDF under the CF conventions, version 1.11, as `sim.weather.files` reads it."""

from __future__ import annotations

import math
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from planner.windfield import FieldArray, WindField
from sim.errors import WeatherError

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

_TIME = {
    "standard_name": "time",
    "long_name": "time",
    "units": "seconds since 1970-01-01 00:00:00",
    "calendar": "standard",
    "units_metadata": "leap_seconds: none",
    "axis": "T",
}
_HEIGHT = {
    "standard_name": "height_above_mean_sea_level",
    "long_name": "height above the sea",
    "units": "m",
    "positive": "up",
    "axis": "Z",
}
_LAT = {"standard_name": "latitude", "long_name": "latitude", "units": "degrees_north", "axis": "Y"}
_LON = {"standard_name": "longitude", "long_name": "longitude", "units": "degrees_east", "axis": "X"}
_WGS84 = {
    "grid_mapping_name": "latitude_longitude",
    "semi_major_axis": 6378137.0,
    "inverse_flattening": 298.257223563,
    "longitude_of_prime_meridian": 0.0,
}
_COMPRESSED = {"zlib": True, "complevel": 4, "shuffle": True, "_FillValue": None}


def write_wind(path: Path, wind: WindField, *, title: str, source: str) -> None:
    """Write a wind field; what `read_wind` makes of the file has the same values, to the bit.

    The same field gives the same bytes: the file holds no time of writing. It gets its name when it is whole.

    Args:
        path: to write; ends in .nc.
        wind: with or without heights.
        title: one line about what it is.
        source: where the wind is from.

    Raises:
        WeatherError: if the file is not to be named .nc, or cannot be written.
    """
    check_writable(path)
    partial = path.with_suffix(".partial.nc")
    try:
        dataset, encoding = _dataset(wind, title, source)
        dataset.to_netcdf(partial, engine="netcdf4", format="NETCDF4", encoding=encoding)
        partial.replace(path)
    except (OSError, RuntimeError) as error:  # netCDF4 raises either
        partial.unlink(missing_ok=True)
        raise WeatherError(f"cannot write the weather to {path}: {error}; name another file") from error


def check_writable(path: Path) -> None:
    """Find out before the weather is made whether it can be written.

    Raises:
        WeatherError: if the file is not to be named .nc, or its folder does not exist.
    """
    if path.suffix != ".nc":
        raise WeatherError(
            f"weather is saved as NetCDF; name it {path.with_suffix('.nc').name}, not {path.name}"
        )
    if not path.parent.is_dir():
        raise WeatherError(f"there is no folder {path.parent} for {path.name}; make it first")


def _dataset(wind: WindField, title: str, source: str) -> tuple[xr.Dataset, dict[str, dict[str, Any]]]:
    """The dataset, and how each variable is stored."""
    import xarray as xr

    coordinates: dict[str, Any] = {"time": ("time", wind.time_s, _TIME)}
    if wind.height_m is not None:
        coordinates["level"] = ("level", wind.height_m, _HEIGHT)
    coordinates["lat"] = ("lat", np.degrees(wind.grid.lat_rad), _LAT)
    coordinates["lon"] = ("lon", np.degrees(wind.grid.lon_rad), _LON)
    axes = tuple(coordinates)
    parts: dict[str, tuple[str, FieldArray]] = {
        "u": ("eastward_wind", wind.east_mps),
        "v": ("northward_wind", wind.north_mps),
    }
    if wind.down_mps is not None:
        parts["w"] = ("upward_air_velocity", -wind.down_mps)
    variables: dict[str, Any] = {
        name: (axes, values, _described(standard_name)) for name, (standard_name, values) in parts.items()
    }
    variables["crs"] = ((), np.int32(0), {"long_name": "coordinate reference system", **_WGS84})
    dataset = xr.Dataset(variables, coordinates, _about(wind, title, source))
    encoding = dict.fromkeys(parts, _COMPRESSED) | {name: {"_FillValue": None} for name in coordinates}
    return dataset, encoding


def _described(standard_name: str) -> dict[str, str]:
    return {
        "standard_name": standard_name,
        "long_name": standard_name.replace("_", " "),
        "units": "m s-1",
        "grid_mapping": "crs",
    }


def _about(wind: WindField, title: str, source: str) -> dict[str, str]:
    south, north = math.degrees(wind.grid.lat_rad[0]), math.degrees(wind.grid.lat_rad[-1])
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "institution": "galeway",
        "source": source,
        "history": f"written by galeway {version('galeway')}",
        "references": "https://cfconventions.org",
        "comment": f"Wind is the velocity of the air, toward. Latitudes {south:.3f} to {north:.3f} deg.",
    }
