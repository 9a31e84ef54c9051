"""Values of weather files in the unit that a scenario gives its limit in."""

from __future__ import annotations

from collections.abc import Mapping

from sim.errors import HazardError
from sim.weather.units import METRES, METRES_PER_SECOND, PASCALS, SECONDS

_RAIN = {
    **dict.fromkeys(("kg m-2 s-1", "kg m**-2 s**-1", "kg/m2/s", "mm s-1", "mm/s"), 1.0),
    **dict.fromkeys(("mm h-1", "mm/h", "mm hr-1", "mm/hr", "kg m-2 h-1"), 1.0 / 3600.0),
    **dict.fromkeys(("mm day-1", "mm d-1", "mm/day"), 1.0 / 86400.0),
}
_WATER = {**dict.fromkeys(("kg m-2", "kg m**-2", "mm"), 1.0), "cm": 10.0, "m": 1000.0}
_SHARE = {**dict.fromkeys(("1", "", "0-1", "(0 - 1)"), 1.0), **dict.fromkeys(("%", "percent"), 0.01)}
_KELVINS = dict.fromkeys(("K", "kelvin"), 0.0)
_CELSIUS = dict.fromkeys(("degC", "Celsius", "celsius", "deg_C", "degree_Celsius", "C"), 273.15)
_TEMPERATURE = _KELVINS | _CELSIUS
_BY_FACTOR: tuple[Mapping[str, float], ...] = (
    *(_RAIN, _WATER, _SHARE, METRES_PER_SECOND, METRES, PASCALS, SECONDS),
)


def limit_in(unit: str, limit: float, wanted: str, name: str) -> float:
    """A limit in the unit of a file.

    Args:
        unit: the file's.
        limit: in the unit `wanted`.
        wanted: the scenario's.
        name: of the variable, for messages.

    Raises:
        HazardError: if one cannot be turned into the other.
    """
    if unit == wanted:
        return limit
    if unit in _TEMPERATURE and wanted in _TEMPERATURE:
        return limit + _TEMPERATURE[wanted] - _TEMPERATURE[unit]
    for known in _BY_FACTOR:
        if unit in known and wanted in known:
            return limit * known[wanted] / known[unit]
    others = {other for known in (*_BY_FACTOR, _TEMPERATURE) if unit in known for other in known} - {unit, ""}
    remedy = f"write unit = {unit!r}" + (f", or one of {', '.join(sorted(others))}" if others else "")
    raise HazardError(f"{name} has the unit {unit!r}, the scenario's limit {wanted!r}; {remedy}")
