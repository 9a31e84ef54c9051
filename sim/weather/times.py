"""When the values of a weather file hold: valid times, or a reference time plus a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.errors import WeatherError
from sim.weather.units import SECONDS, factor

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

Floats = NDArray[np.float64]

_STANDARD_CALENDARS = ("standard", "gregorian", "proleptic_gregorian")
_ROUND_S = (1.0, 60.0, 300.0, 900.0, 3600.0)
_LONGEST_PLAIN_STEP_S = 3600.0


def counts_time(values: xr.DataArray) -> bool:
    """Whether a coordinate counts from a moment, as in "hours since 2022-09-29"."""
    return " since " in str(values.attrs.get("units"))


def moments_s(time: xr.DataArray) -> Floats:
    """The values of an undecoded time coordinate [s since 1970-01-01 UTC], of its shape.

    What single precision has rounded off is put back: times that are whole seconds, minutes or hours but for
    the resolution of their own numbers become so.

    Raises:
        WeatherError: if its unit or calendar is unknown, or a time is missing.
    """
    import xarray as xr

    calendar = str(time.attrs.get("calendar", "standard")).lower()
    if calendar not in _STANDARD_CALENDARS:
        raise WeatherError(
            f"the times {time.name} count in the calendar {calendar!r}; it must be one of "
            f"{', '.join(_STANDARD_CALENDARS)}"
        )
    counts = np.asarray(time.values)
    attributes = {"units": time.attrs["units"], "calendar": calendar}
    try:
        flat = xr.Dataset({"decoded": ("time", counts.ravel(), attributes)})
        moments = xr.decode_cf(flat)["decoded"].values.astype("datetime64[ns]")
    except (ValueError, TypeError, OverflowError) as error:
        raise WeatherError(
            f"the times {time.name} have the unit {time.attrs['units']!r}, which makes no sense; "
            "write, say, 'hours since 2022-09-29 00:00:00'"
        ) from error
    if np.isnat(moments).any():
        place = int(np.argmax(np.isnat(moments)))
        raise WeatherError(
            f"the times {time.name} must be numbers, but number {place} (NaT) is none; drop missing times"
        )
    return _rounded(moments.astype(np.int64) / 1e9, counts, time.attrs["units"]).reshape(counts.shape)


def _rounded(times_s: Floats, counts: NDArray[np.generic], unit: str) -> Floats:
    """Times on the finest round step that their own resolution allows to tell apart."""
    if not np.issubdtype(counts.dtype, np.floating) or not counts.size:
        return times_s
    unit_s = SECONDS.get(unit.split(" since ")[0].strip().lower(), 0.0)
    resolution_s = unit_s * float(np.spacing(np.abs(counts).max()))
    for step_s in _ROUND_S:
        even_s = step_s * np.rint(times_s / step_s)
        if resolution_s < step_s / 2.0 and np.abs(times_s - even_s).max() <= max(resolution_s, 1e-6):
            return np.asarray(even_s, dtype=np.float64)
    return times_s


def steps_s(step: xr.DataArray) -> Floats:
    """The values of a forecast step [s], of its shape.

    Raises:
        WeatherError: if its unit is unknown.
    """
    return np.asarray(step.values, dtype=np.float64) * factor(step, SECONDS, "forecast step")


def refuse_falling(times_s: Floats, name: str) -> None:
    """Refuse a row of times that does not rise.

    Raises:
        WeatherError: naming the first time that does not.
    """
    falling = ~(np.diff(times_s) > 0.0)
    if falling.any():
        place = int(np.argmax(falling)) + 1
        raise WeatherError(
            f"the times {name} must rise, but number {place} ({utc(times_s[place])}) does not; sort the file "
            "by time and drop doubled or missing times"
        )


def gaps_s(times_s: Floats) -> list[tuple[float, float]]:
    """Where times are missing: (begin, end) of each interval over an hour and longer than its neighbours.

    So a file of three-hourly times has no gap, nor one that goes on with six-hourly ones; a file that lacks
    one of its times has one.
    """
    steps = np.diff(times_s)
    around = np.concatenate(([0.0], steps, [0.0]))
    lonely = np.maximum(around[:-2], around[2:]) < steps - 1.0
    found = lonely & (steps > _LONGEST_PLAIN_STEP_S + 1.0) & (steps.size > 1)
    return [(float(times_s[i]), float(times_s[i + 1])) for i in np.flatnonzero(found)]


def utc(time_s: float) -> str:
    """A moment as 2022-09-29T03:00:00."""
    return str(np.datetime64(round(time_s * 1000.0), "ms"))[:19]
