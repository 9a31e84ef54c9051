"""What is what in a dataset under the CF conventions: winds, axes, units and times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.errors import WeatherError

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

_WIND_STANDARD_NAMES = (("eastward_wind", "northward_wind"), ("x_wind", "y_wind"))
_WIND_NAMES = (
    *(("u", "v"), ("u10", "v10"), ("u100", "v100"), ("ua", "va"), ("uas", "vas")),
    *(("U", "V"), ("UGRD", "VGRD"), ("ugrd10m", "vgrd10m")),
)
_UPWARD_STANDARD_NAME = "upward_air_velocity"
_UPWARD_NAMES = ("w", "W", "wa")
_HEIGHT_STANDARD_NAMES = (
    "height",
    "altitude",
    "height_above_mean_sea_level",
    "height_above_reference_ellipsoid",
)
_STANDARD_CALENDARS = ("standard", "gregorian", "proleptic_gregorian")

_METRES_PER_SECOND = {
    **dict.fromkeys(("m s-1", "m/s", "m s**-1", "m s^-1", "m.s-1", "meter/second", "metre/second"), 1.0),
    **dict.fromkeys(("kt", "kts", "kn", "knot", "knots"), 1852.0 / 3600.0),
    **dict.fromkeys(("km h-1", "km/h", "km hr-1", "km/hr", "km h**-1", "kmh"), 1.0 / 3.6),
}
_METRES = {**dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1.0), "km": 1000.0}


@dataclass(frozen=True, slots=True)
class AxisNames:
    """The coordinates of a wind variable; `height` is None where wind is given at one height only."""

    time: str
    height: str | None
    lat: str
    lon: str


def find_winds(dataset: xr.Dataset, wanted: tuple[str, str] | None) -> tuple[str, str, str | None]:
    """The names of the east, the north and, if there is one, the upward component.

    Raises:
        WeatherError: if there is no pair of winds, or more than one.
    """
    there = ", ".join(_introduced(dataset[name]) for name in dataset.data_vars) or "no variables at all"
    if wanted is not None:
        pairs = [wanted] if all(name in dataset.data_vars for name in wanted) else []
    else:
        pairs = [
            (east, north)
            for standard_names in _WIND_STANDARD_NAMES
            for east, north in zip(
                *(_by_standard_name(dataset, name) for name in standard_names), strict=False
            )
        ] or [pair for pair in _WIND_NAMES if all(name in dataset.data_vars for name in pair)]
    if len(pairs) > 1:
        raise WeatherError(
            f"it has several winds ({there}); name the two to read, eastward and northward "
            "(weather.variables in a scenario)"
        )
    if not pairs:
        missing = "an east and a north wind" if wanted is None else f"the winds {' and '.join(wanted)}"
        raise WeatherError(
            f"it lacks {missing} and has {there}; name the two variables to read, or give them the CF "
            "standard names eastward_wind and northward_wind"
        )
    upward = _by_standard_name(dataset, _UPWARD_STANDARD_NAME) or [
        name
        for name in _UPWARD_NAMES
        if name in dataset.data_vars and "standard_name" not in dataset[name].attrs
    ]
    return *pairs[0], upward[0] if len(upward) == 1 and wanted is None else None


def find_axes(wind: xr.DataArray) -> AxisNames:
    """The axes of a wind variable.

    Raises:
        WeatherError: if latitude, longitude or time is missing or not a single row of values, or if there is
            a further axis that is not a height in metres.
    """
    lat, lon = _angle_axis(wind, "latitude", "degrees_north"), _angle_axis(wind, "longitude", "degrees_east")
    times = [str(name) for name, values in wind.coords.items() if " since " in str(values.attrs.get("units"))]
    times.sort(key=lambda name: (wind[name].size, wind[name].attrs.get("standard_name") == "time"))
    if not times or wind[times[-1]].ndim > 1:
        raise WeatherError(
            f"the wind {wind.name} lacks a time axis with a unit such as 'hours since 2022-09-29' and has "
            f"{', '.join(_introduced(values) for values in wind.coords.values())}; add one"
        )
    known = {dim for name in (lat, lon, times[-1]) for dim in wind[name].dims}
    others = [str(name) for name in wind.dims if name not in known and wind.sizes[name] > 1]
    for name in others:
        attributes = wind.coords[name].attrs if name in wind.coords else {}
        height = attributes.get("standard_name", "height") in _HEIGHT_STANDARD_NAMES
        if not height or attributes.get("units") not in _METRES or len(others) > 1:
            raise WeatherError(
                f"the wind {wind.name} has an axis {name!r} of {wind.sizes[name]} values (unit "
                f"{attributes.get('units', 'unknown')!r}) that is not a height in metres; select one of "
                "them, or interpolate the wind to heights in metres"
            )
    return AxisNames(times[-1], others[0] if others else None, lat, lon)


def metres_per_second(wind: xr.DataArray) -> float:
    """The factor that turns a wind variable into m/s.

    Raises:
        WeatherError: if its unit is none that is known.
    """
    unit = wind.attrs.get("units")
    if unit not in _METRES_PER_SECOND:
        raise WeatherError(
            f"the wind {wind.name} has the unit {unit!r}; it must be one of {', '.join(_METRES_PER_SECOND)}"
        )
    return _METRES_PER_SECOND[unit]


def heights_m(height: xr.DataArray) -> NDArray[np.float64]:
    """The values of a height axis [m], that axis being one `find_axes` has found."""
    return np.asarray(height.values, dtype=np.float64) * _METRES[height.attrs["units"]]


def times_s(time: xr.DataArray) -> NDArray[np.float64]:
    """The values of an undecoded time coordinate, shape (T,) [s since 1970-01-01 UTC].

    Raises:
        WeatherError: if its unit or calendar is unknown, or times do not rise.
    """
    import xarray as xr

    calendar = str(time.attrs.get("calendar", "standard")).lower()
    if calendar not in _STANDARD_CALENDARS:
        raise WeatherError(
            f"the times {time.name} count in the calendar {calendar!r}; it must be one of "
            f"{', '.join(_STANDARD_CALENDARS)}"
        )
    try:
        decoded = xr.decode_cf(xr.Dataset({"decoded": ("time", np.atleast_1d(time.values), time.attrs)}))
        moments = decoded["decoded"].values.astype("datetime64[ns]")
    except (ValueError, TypeError, OverflowError) as error:
        raise WeatherError(
            f"the times {time.name} have the unit {time.attrs['units']!r}, which makes no sense ({error}); "
            "write, say, 'hours since 2022-09-29 00:00:00'"
        ) from error
    falling = ~(np.diff(moments) > np.timedelta64(0))
    if falling.any() or np.isnat(moments).any():
        place = int(np.argmax(falling)) + 1 if falling.any() else 0
        raise WeatherError(
            f"the times {time.name} must rise, but number {place} ({moments[place]}) does not; sort the file "
            "by time and drop doubled or missing times"
        )
    return moments.astype(np.int64) / 1e9


def _by_standard_name(dataset: xr.Dataset, wanted: str) -> list[str]:
    return [
        str(name) for name, values in dataset.data_vars.items() if values.attrs.get("standard_name") == wanted
    ]


def _angle_axis(wind: xr.DataArray, what: str, unit: str) -> str:
    """The name of the latitude or longitude coordinate."""
    found = [
        values
        for name, values in wind.coords.items()
        if values.attrs.get("standard_name") == what
        or ("standard_name" not in values.attrs and values.attrs.get("units") == unit)
        or (not values.attrs and name in (what, what[:3]))
    ]
    if len(found) != 1 or found[0].ndim != 1:
        seen = (
            ", ".join(f"{values.name} on ({', '.join(map(str, values.dims))})" for values in found) or "none"
        )
        raise WeatherError(
            f"the wind {wind.name} needs one {what} axis, a row of values in {unit}, but has {seen}; "
            "regrid it to a regular latitude-longitude grid"
        )
    return str(found[0].name)


def _introduced(values: xr.DataArray) -> str:
    return f"{values.name} ({values.attrs.get('standard_name', values.attrs.get('long_name', 'unnamed'))})"
