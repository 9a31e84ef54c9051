"""Units of weather files: what turns their values into SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from sim.errors import WeatherError

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

METRES_PER_SECOND = {
    **dict.fromkeys(("m s-1", "m/s", "m s**-1", "m s^-1", "m.s-1", "meter/second", "metre/second"), 1.0),
    **dict.fromkeys(("kt", "kts", "kn", "knot", "knots"), 1852.0 / 3600.0),
    **dict.fromkeys(("km h-1", "km/h", "km hr-1", "km/hr", "km h**-1", "kmh"), 1.0 / 3.6),
}
METRES = {
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres", "gpm"), 1.0),
    "km": 1000.0,
    **dict.fromkeys(("ft", "feet", "foot"), 0.3048),
}
PASCALS = {
    **dict.fromkeys(("Pa", "pascal"), 1.0),
    **dict.fromkeys(("hPa", "mbar", "mb", "millibar", "millibars"), 100.0),
    "kPa": 1000.0,
}
SECONDS = {
    **dict.fromkeys(("s", "sec", "second", "seconds"), 1.0),
    **dict.fromkeys(("min", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hour", "hours"), 3600.0),
    **dict.fromkeys(("d", "day", "days"), 86400.0),
    "nanoseconds": 1e-9,
}
RADIANS = {
    **dict.fromkeys(
        ("degree", "degrees", "deg", "degree_true", "degrees_true", "Degree true"), math.pi / 180
    ),
    **dict.fromkeys(("rad", "radian", "radians"), 1.0),
}
GEOPOTENTIAL_METRES = METRES | dict.fromkeys(("m2 s-2", "m**2 s**-2", "m2/s2", "J kg-1"), 1.0 / 9.80665)


def factor(values: xr.DataArray, known: Mapping[str, float], what: str) -> float:
    """What turns a variable, called `what` in messages, into SI.

    Raises:
        WeatherError: if its unit is none of the known ones.
    """
    unit = values.attrs.get("units")
    if unit in known:
        return known[str(unit)]
    usual: dict[float, str] = {}
    for name, scale in known.items():
        usual.setdefault(scale, name)
    raise WeatherError(
        f"the {what} {values.name} has {has_unit(unit)}; it must be one of {', '.join(usual.values())}: "
        "convert it"
    )


def has_unit(unit: object) -> str:
    """What a variable has for a unit, in messages; None where there is none."""
    return "no unit" if unit is None else f"the unit {str(unit)!r}"
