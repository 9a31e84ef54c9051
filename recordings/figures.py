"""The figures of a report, and the moments they come from."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.whereabouts import place_text

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Moment:
    """Where and when a statistic was at its worst, and what was measured there; `time_s` since departure."""

    value: float
    unit: str
    time_s: float
    lat_deg: float
    lon_deg: float

    def __str__(self) -> str:
        measured = f"{number(self.value)} {self.unit}".rstrip()
        return f"{measured} at {clock(self.time_s)}, {place_text(self.lat_deg, self.lon_deg)}"


@dataclass(frozen=True, slots=True)
class Spread:
    """Mean, 95th percentile and maximum of absolute errors; None where there are none."""

    mean: float | None
    p95: float | None
    max: float | None


@dataclass(frozen=True, slots=True)
class Extent:
    """Smallest, mean and greatest value; None where there are none."""

    min: float | None
    mean: float | None
    max: float | None


@dataclass(frozen=True, slots=True)
class Largest:
    """The greatest value alone; None where there is none."""

    max: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """When, where and in which phase of the reference values were measured; arrays of their shape."""

    time_s: Floats
    lat_deg: Floats
    lon_deg: Floats
    phase: NDArray[np.int64]

    def moment(self, index: int, value: float, unit: str) -> Moment:
        """What was measured at one of them."""
        time_s, lat_deg, lon_deg = (float(of[index]) for of in (self.time_s, self.lat_deg, self.lon_deg))
        return Moment(value, unit, time_s, lat_deg, lon_deg)

    def chosen(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> Places:
        """Some of them."""
        return Places(self.time_s[which], self.lat_deg[which], self.lon_deg[which], self.phase[which])

    def lasting_s(self) -> Floats:
        """For how long each stands: until the next one, the last for as long as the one before it."""
        steps_s = np.diff(self.time_s)
        return np.append(steps_s, steps_s[-1:] if len(steps_s) else math.inf)[: len(self.time_s)]


class Statistics:
    """Makes figures of values, and keeps in `worst`, by the figure's name, the moment it was at its worst."""

    def __init__(self) -> None:
        self.worst: dict[str, Moment] = {}

    def spread(self, name: str, errors: Floats, places: Places) -> Spread:
        """Of absolute errors; NaN, where nothing could be measured, is left out."""
        sizes = np.abs(errors)
        known = sizes[np.isfinite(sizes)]
        if not len(known):
            return Spread(None, None, None)
        greatest = int(np.nanargmax(sizes))
        for figure in ("mean", "p95", "max"):
            self.note(f"{name}.{figure}", float(sizes[greatest]), places, greatest, unit_of(name))
        return Spread(float(known.mean()), float(np.percentile(known, 95.0)), float(known.max()))

    def extent(self, name: str, values: Floats, places: Places) -> Extent:
        """Of any values; the mean's moment is that of the greatest."""
        if not len(values):
            return Extent(None, None, None)
        least, greatest = int(values.argmin()), int(values.argmax())
        for figure, index in (("min", least), ("mean", greatest), ("max", greatest)):
            self.note(f"{name}.{figure}", float(values[index]), places, index, unit_of(name))
        return Extent(float(values[least]), float(values.mean()), float(values[greatest]))

    def largest(self, name: str, values: Floats, places: Places) -> Largest:
        """Of any values."""
        if not len(values):
            return Largest(None)
        greatest = int(values.argmax())
        self.note(f"{name}.max", float(values[greatest]), places, greatest, unit_of(name))
        return Largest(float(values[greatest]))

    def note(self, name: str, value: float, places: Places, index: int, unit: str) -> None:
        """Keep the moment of one value."""
        self.worst[name] = places.moment(index, value, unit)


def unit_of(name: str) -> str:
    """The unit that a figure's name ends in, as it is written."""
    return {"m": "m", "s": "s", "mps": "m/s", "deg": "°", "kg": "kg"}.get(name.rpartition("_")[2], "")


def number(value: float) -> str:
    """A number in as many digits as say something; zero has no sign."""
    value += 0.0  # which makes 0.0 of -0.0
    return f"{value:.1f}".removesuffix(".0") if abs(value) >= 1000.0 else f"{value:.4g}"


def clock(time_s: float) -> str:
    """A time as hours:minutes:seconds."""
    seconds = math.floor(abs(time_s) + 0.5)
    sign = "-" if time_s < 0.0 and seconds else ""
    return f"{sign}{seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"


def clock_tenths(time_s: float) -> str:
    """The same with tenths of a second."""
    tenths = math.floor(abs(time_s) * 10.0 + 0.5)
    sign = "-" if time_s < 0.0 and tenths else ""
    return f"{sign}{clock(tenths // 10)}.{tenths % 10}"
