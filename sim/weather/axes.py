"""The axes of a variable in a weather file: members, times, levels and the two across the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.errors import WeatherError
from sim.weather.levels import is_vertical
from sim.weather.times import counts_time, moments_s, steps_s
from sim.weather.units import SECONDS, has_unit

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

Floats = NDArray[np.float64]

_UNITS = {
    "latitude": ("degrees_north", "degree_north", "degree_N", "degrees_N", "degreeN", "degreesN"),
    "longitude": ("degrees_east", "degree_east", "degree_E", "degrees_E", "degreeE", "degreesE"),
}
_NAMES = {
    "latitude": ("latitude", "lat", "XLAT", "nav_lat"),
    "longitude": ("longitude", "lon", "XLONG", "nav_lon"),
}
_MEMBER_NAMES = ("number", "realization", "member", "members", "ensemble", "ens", "ensemble_member")
_STEP_NAMES = ("step", "forecast_period", "lead_time", "leadtime", "prediction_timedelta", "forecast_hour")
_REFERENCE_NAMES = (
    "forecast_reference_time",
    "reference_time",
    "base_time",
    "analysis_time",
    "forecast_time0",
)


@dataclass(frozen=True, slots=True)
class Axes:
    """The axes of one variable.

    Attributes:
        member: dimension or scalar coordinate that counts ensemble members, if there is one.
        members: their numbers, (0,) without.
        time: the dimension along which time runs, None for a single time.
        time_s: valid times, shape (T,) [s since 1970-01-01 UTC], as in the file.
        issued_s: reference time of the forecast, None where the file has none.
        level: vertical coordinate, a dimension or a scalar, if there is one.
        lat: name of the latitude coordinate, of one or two dimensions.
        lon: likewise of longitude.
        ground: the dimensions along which those run, northward first where each runs along one.
    """

    member: str | None
    members: tuple[int, ...]
    time: str | None
    time_s: Floats
    issued_s: float | None
    level: str | None
    lat: str
    lon: str
    ground: tuple[str, str]

    @property
    def curved(self) -> bool:
        """Whether latitude and longitude depend on both dimensions, as on a map projection's grid."""
        return self.lat not in self.ground and self.lon not in self.ground


def find_axes(variable: xr.DataArray) -> Axes:
    """The axes of a variable.

    Raises:
        WeatherError: if latitude, longitude or time is missing or makes no sense, or if there is a further
            axis of which nobody knows what it counts.
    """
    lat, lon = _angle(variable, "latitude"), _angle(variable, "longitude")
    time, time_s, issued_s = _times(variable)
    ground = _ground(variable, lat, lon, time)
    member = next((name for name in map(str, variable.coords) if _counts_members(variable[name])), None)
    if member is None:
        member = next((name for name in map(str, variable.dims) if name in _MEMBER_NAMES), None)
    rest = [str(name) for name in variable.dims if name not in (time, member, *ground)]
    long = [name for name in rest if variable.sizes[name] > 1]
    levels = [name for name in long if name in variable.coords and is_vertical(variable[name])]
    for name in long:
        if levels != [name]:
            unit = variable[name].attrs.get("units") if name in variable.coords else None
            raise WeatherError(
                f"{variable.name} has an axis {name!r} of {variable.sizes[name]} values "
                f"({has_unit(unit).removeprefix('the ')}) that is neither time, member, height nor pressure; "
                "select one of its values, or name the axis by a CF standard name"
            )
    if not levels:
        used = {lat, lon, time, member}
        levels = [
            str(name)
            for name, values in variable.coords.items()
            if values.size == 1 and name not in used and not counts_time(values) and is_vertical(values)
        ]
    members = np.atleast_1d(variable[member].values) if member in variable.coords else ()
    if member in variable.dims and not len(members):
        members = np.arange(variable.sizes[member])
    return Axes(
        member,
        tuple(int(number) for number in members) or (0,),
        time,
        time_s,
        issued_s,
        levels[0] if levels else None,
        lat,
        lon,
        ground,
    )


def _angle(variable: xr.DataArray, what: str) -> str:
    """The name of the latitude or longitude coordinate."""
    found = [
        values
        for name, values in variable.coords.items()
        if values.attrs.get("standard_name") == what
        or ("standard_name" not in values.attrs and values.attrs.get("units") in _UNITS[what])
        or (not values.attrs and name in _NAMES[what])
    ]
    if len(found) != 1 or not 1 <= found[0].ndim <= 3:
        seen = (
            ", ".join(f"{values.name} on ({', '.join(map(str, values.dims))})" for values in found) or "none"
        )
        raise WeatherError(
            f"{variable.name} needs one {what}, in {_UNITS[what][0]}, but has {seen}; give its coordinates "
            "the "
            f"standard name {what}, and drop those that it does not lie on"
        )
    return str(found[0].name)


def _ground(variable: xr.DataArray, lat: str, lon: str, time: str | None) -> tuple[str, str]:
    """The dimensions of latitude and longitude."""
    rows, columns = ([str(dim) for dim in variable[name].dims if dim != time] for name in (lat, lon))
    if len(rows) == len(columns) == 1 and rows != columns:
        return rows[0], columns[0]
    if len(rows) == 2 and rows == columns:
        return rows[0], rows[1]
    raise WeatherError(
        f"{variable.name} has {lat} on ({', '.join(rows)}) and {lon} on ({', '.join(columns)}); a grid needs "
        "rows and columns: regrid scattered or reduced points to regular latitudes and longitudes"
    )


def _counts_members(values: xr.DataArray) -> bool:
    """Whether a coordinate gives the number of an ensemble's member."""
    named = values.attrs.get("standard_name", "realization") == "realization" and values.name in _MEMBER_NAMES
    whole = values.ndim <= 1 and np.issubdtype(values.dtype, np.number)
    return whole and (values.attrs.get("standard_name") == "realization" or named)


def _times(variable: xr.DataArray) -> tuple[str | None, Floats, float | None]:
    """The dimension of time, the valid times, and the time the forecast was issued."""
    counting = [values for values in variable.coords.values() if counts_time(values)]
    issued = [values for values in counting if _is_reference(values)]
    valid = sorted(
        (values for values in counting if not _is_reference(values)),
        key=lambda values: (values.size, values.attrs.get("standard_name") == "time"),
    )
    steps = [
        values
        for name, values in variable.coords.items()
        if (values.attrs.get("standard_name") == "forecast_period" or name in _STEP_NAMES)
        and values.attrs.get("units") in SECONDS
    ]
    reference_s = moments_s(issued[0]) if len(issued) == 1 else None
    if reference_s is not None and reference_s.size > 1 and not valid:
        raise WeatherError(
            f"{variable.name} holds {reference_s.size} forecasts ({issued[0].name}); give the files of "
            "one, or "
            "select one of them"
        )
    issued_s = float(reference_s.ravel()[0]) if reference_s is not None and reference_s.size == 1 else None
    if valid:
        chosen, time_s = valid[-1], moments_s(valid[-1])
    elif len(steps) == 1 and issued_s is not None:
        chosen, time_s = steps[0], issued_s + steps_s(steps[0])
    elif issued_s is not None and not steps and issued[0].name in variable.dims:
        chosen, time_s = issued[0], np.array([issued_s])
    else:
        seen = ", ".join(
            f"{name} ({values.attrs.get('units', 'no unit')})" for name, values in variable.coords.items()
        )
        raise WeatherError(
            f"{variable.name} lacks a time axis with a unit such as 'hours since 2022-09-29', or a reference "
            f"time and a forecast step in hours, and has {seen or 'no coordinates'}; add one"
        )
    dims = [str(dim) for dim, size in zip(chosen.dims, chosen.shape, strict=True) if size > 1] or list(
        map(str, chosen.dims[:1])
    )
    if len(dims) > 1:
        raise WeatherError(
            f"{variable.name} has {chosen.name} on ({', '.join(dims)}), several forecasts; give the files of "
            "one, or select one of them"
        )
    return dims[0] if dims and dims[0] in variable.dims else None, time_s.ravel(), issued_s


def _is_reference(values: xr.DataArray) -> bool:
    """Whether a time is that at which the forecast was issued."""
    standard_name = values.attrs.get("standard_name")
    return standard_name == "forecast_reference_time" or (
        standard_name is None and values.name in _REFERENCE_NAMES
    )
