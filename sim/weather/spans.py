"""What time each of a row of values is of: a moment, or a window, such as the highest gust of three hours."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.errors import WeatherError
from sim.weather.times import counts_time, gaps_s, moments_s, refuse_falling, utc
from sim.weather.variables import Role, role_of

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

Floats = NDArray[np.float64]

LONGEST_SPACING_S = 6 * 3600.0
"""Between two moments of a file without gaps that are bridged unasked: as far as in global forecasts."""

_ROUNDING_S = 1e-3
_SAME_TIME_S = 1.0
_OF_A_MOMENT = ("point", "instant")
_OVER_TIME = {
    **dict.fromkeys(("max", "maximum"), "highest"),
    **dict.fromkeys(("min", "minimum"), "lowest"),
    **dict.fromkeys(("avg", "mean"), "mean"),
    **dict.fromkeys(("accum", "sum"), "sum"),
}


@dataclass(frozen=True, slots=True, eq=False)
class Spans:
    """When each of a row of values holds; both rising, shape (T,) [s since 1970-01-01 UTC].

    A value from `begin_s` to a later `end_s` is of that whole window and of nothing outside it, as a maximum
    is; one with both the same is of that moment, and what lies between two of those may be that of either.
    """

    begin_s: Floats
    end_s: Floats

    @classmethod
    def at(cls, time_s: Floats) -> Spans:
        """Of moments."""
        return cls(time_s, time_s)

    @property
    def windowed(self) -> bool:
        """Whether any of them is longer than a moment."""
        return bool((self.end_s > self.begin_s).any())

    def part(self, which: slice) -> Spans:
        """Some of them."""
        return Spans(self.begin_s[which], self.end_s[which])

    def during(self, begin_s: float, end_s: float) -> slice:
        """The values that say something of a stretch of time.

        Those are all that hold at a time within it; where none holds at its begin or its end, also the last
        one before, or the first one after.
        """
        first = int(np.searchsorted(self.begin_s, begin_s + _ROUNDING_S, side="right")) - 1
        end = int(np.searchsorted(self.end_s, end_s - _ROUNDING_S, side="left")) + 1
        return slice(max(first, 0), end)

    def gaps_s(self) -> list[tuple[float, float]]:
        """Where values are missing: what no window covers, or where a moment of a row is left out."""
        if not self.windowed:
            return gaps_s(self.end_s)
        ends = zip(self.end_s[:-1].tolist(), self.begin_s[1:].tolist(), strict=True)
        return [(end_s, begin_s) for end_s, begin_s in ends if begin_s - end_s > _SAME_TIME_S]

    def refuse_gaps(self, begin_s: float, end_s: float, bridge_s: float, source: str, what: str) -> None:
        """Refuse times between which values change in ways that nobody knows.

        Two windows or moments may be as far apart as `bridge_s`; moments farther, up to six hours, only where
        all of the file's are that far apart anyway, so that none is missing between them.

        Args:
            begin_s: of the mission; gaps outside it do no harm.
            end_s: of the mission.
            bridge_s: what the scenario lets be bridged.
            source: the file, for messages.
            what: it has none of in the gap, for messages.

        Raises:
            WeatherError: naming the first gap in the mission.
        """
        missing, windowed = self.gaps_s(), self.windowed
        for before_s, after_s in zip(self.end_s[:-1].tolist(), self.begin_s[1:].tolist(), strict=True):
            plain = not windowed and (before_s, after_s) not in missing
            allowed_s = max(bridge_s, LONGEST_SPACING_S) if plain else bridge_s
            apart_s = after_s - before_s
            if after_s > begin_s and before_s < end_s and apart_s > allowed_s + _SAME_TIME_S:
                how = "the values on either side" if windowed else "a straight line"
                raise WeatherError(
                    f"{source} has no {what} between {utc(before_s)} and {utc(after_s)} UTC, "
                    f"{apart_s / 3600.0:g} h apart (limit {allowed_s / 3600.0:g} h); bring the missing "
                    f"times, or let the gap be bridged by {how} with weather.bridge_gaps_h = "
                    f"{apart_s / 3600.0:g}"
                )


def spans_of(dataset: xr.Dataset, variable: xr.DataArray, time_s: Floats) -> Spans:
    """When the values of a variable hold, as the bounds of its times say.

    Args:
        dataset: that the variable is in, undecoded in time, with the variables that bounds are.
        variable: by its cell methods or GRIB's type of step it is of moments or of windows; a gust that does
            not say is of windows, as its standard name has it.
        time_s: its times, shape (T,) [s since 1970-01-01 UTC].

    Raises:
        WeatherError: if the bounds make no sense.
    """
    method = method_over_time(variable)
    if method in _OF_A_MOMENT or (method is None and role_of(variable) is not Role.GUST):
        return Spans.at(time_s)
    for time in variable.coords.values():
        bounds = str(time.attrs.get("bounds", ""))
        if counts_time(time) and bounds in dataset.variables:
            return Spans(*_bounds_s(dataset[bounds], time, time_s))
    return Spans.at(time_s)


def bounds_names(dataset: xr.Dataset) -> set[str]:
    """The variables of a dataset that are the bounds of others."""
    said = {str(values.attrs.get("bounds", "")) for values in dataset.variables.values()}
    return said & set(map(str, dataset.variables))


def over_time(variable: xr.DataArray) -> str | None:
    """What a value is of its time, such as the highest; None if it is of a moment, or nobody knows."""
    return _OVER_TIME.get(method_over_time(variable) or "")


def method_over_time(variable: xr.DataArray) -> str | None:
    """How a value was made of its time, by CF's cell methods or GRIB's type of step; None if neither says."""
    methods = str(variable.attrs.get("cell_methods", ""))
    names = {"time", *(str(name) for name, values in variable.coords.items() if counts_time(values))}
    for axes, method in re.findall(r"((?:[\w.]+:\s+)+)(\w+)", methods):
        if names & set(axes.replace(":", " ").split()):
            return str(method)
    said = variable.attrs.get("GRIB_stepType")
    return None if said is None else str(said)


def joined(spans: Spans, name: str) -> Spans:
    """Windows that begin before others end, such as all those since a forecast's start, cut to follow them.

    What a window says is true of each part of it, and a shorter one says more.

    Raises:
        WeatherError: if windows lie in each other in another way.
    """
    if not spans.windowed:
        return spans
    refuse_falling(spans.end_s, f"at which the windows of {name} end")
    inside = np.flatnonzero(np.diff(spans.begin_s) < -_SAME_TIME_S)
    if inside.size:
        one, other = (
            f"{utc(float(spans.begin_s[place]))} to {utc(float(spans.end_s[place]))}"
            for place in (inside[0], inside[0] + 1)
        )
        raise WeatherError(
            f"{name} has windows of different kinds, {one} within {other}; keep those of one kind"
        )
    begin_s = spans.begin_s.copy()
    begin_s[1:] = np.maximum(begin_s[1:], spans.end_s[:-1])
    return Spans(begin_s, spans.end_s)


def _bounds_s(bounds: xr.DataArray, time: xr.DataArray, time_s: Floats) -> tuple[Floats, Floats]:
    """The begin and the end of each window."""
    import xarray as xr

    if bounds.size != 2 * time_s.size:
        raise WeatherError(
            f"the bounds {bounds.name} must be a begin and an end for each of the {time_s.size} times "
            f"{time.name}, and are {bounds.size} values; mend them"
        )
    counts = bounds.values.reshape(-1, 2)
    missing = np.asarray([value != value for value in counts.ravel()]).reshape(-1, 2).any(axis=1)
    if missing.any():
        raise WeatherError(
            f"the bounds {bounds.name} of {time.name} lack a begin or an end at "
            f"{utc(float(time_s[int(np.argmax(missing))]))}, or windows of different lengths end there; keep "
            "those of one length"
        )
    words = {name: bounds.attrs.get(name, time.attrs.get(name)) for name in ("units", "calendar")}
    said = {name: word for name, word in words.items() if word is not None}
    pairs = xr.DataArray(counts, dims=("time", "end"), name=bounds.name, attrs=said)
    begin_s, end_s = np.sort(moments_s(pairs), axis=1).T
    outside = (time_s < begin_s - _SAME_TIME_S) | (time_s > end_s + _SAME_TIME_S)
    if outside.any():
        place = int(np.argmax(outside))
        raise WeatherError(
            f"the bounds {bounds.name} give {time.name} {utc(float(time_s[place]))} the window "
            f"{utc(float(begin_s[place]))} to {utc(float(end_s[place]))}, which does not hold it; mend them"
        )
    return begin_s, end_s
