"""The tables of a scenario that say where the wind comes from, and how forecast and truth differ."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

Positive = Annotated[float, Meta(gt=0.0)]
Component = Annotated[float, Meta(ge=-120.0, le=120.0)]
Files = str | Annotated[tuple[str, ...], Meta(min_length=1)]
Member = Annotated[int, Meta(ge=0)] | Literal["mean"]


class Truth(Struct, frozen=True):
    """How the wind that is flown through differs from the forecast.

    It is that of other weather files, if `file` names some (`variables` and `member` as in [weather]), and
    `speed_factor` times as strong.
    """

    speed_factor: Positive = 1.0
    file: Files | None = None
    variables: tuple[str, str] | None = None
    member: Member = "mean"


class ForecastError(Struct, frozen=True):
    """How forecasts err: not at all, or by what grows with lead time as published errors do.

    With `growing` a forecast is issued at every stage, each better near its own time, all from the scenario's
    seed. `scale`: times the published errors. `members`: of the ensemble that comes with each forecast.
    """

    kind: Literal["none", "growing"] = "none"
    scale: Positive = 1.0
    members: Annotated[int, Meta(ge=0, le=200)] = 0


class SoundingLevel(Struct, frozen=True):
    """The wind at one height above the sea, toward."""

    height_m: Annotated[float, Meta(ge=0.0, le=20_000.0)]
    north_mps: Component
    east_mps: Component


class Weather(Struct, frozen=True):
    """Where the wind comes from: a storm by its HURDAT2 id, weather files of one's own, or a sounding.

    `calm`: nothing is known of the wind, and it is planned as if there were none, for hazard of other kinds;
    that cannot be flown. `sounding`: the wind at some heights, rising, the same everywhere and always, linear
    in height between them. `file`: names or patterns of NetCDF, GRIB or Zarr files of one forecast; with a
    storm, a best track in HURDAT2's format (without, the storm is one that ships). `core_radius`:
    "estimated" has radii of maximum wind that a best track lacks taken from wind and latitude. `variables`:
    names of the eastward and the northward wind, where there are several. `levels` and `wind_axes`: what else
    has to be chosen, as in `sim.weather.files.Reading`. `member`: of an ensemble. `bridge_gaps_h`: how far
    apart two times may be where others are nearer together, or two windows, such as those of gusts. It is
    the truth, but for what `truth` says, and the forecast but for `error`.
    """

    storm: str | None = None
    calm: bool = False
    sounding: tuple[SoundingLevel, ...] = ()
    file: Files | None = None
    variables: tuple[str, str] | None = None
    levels: Literal["height", "pressure"] | None = None
    wind_axes: Literal["earth", "grid"] | None = None
    member: Member = "mean"
    bridge_gaps_h: Annotated[float, Meta(ge=1.0, le=240.0)] = 1.0
    core_radius: Literal["published", "estimated"] = "published"
    truth: Truth = Truth()
    error: ForecastError = ForecastError()
