"""What galeway sees in weather files: variables, area, times, levels, members, wind and gaps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planner.errors import PlannerError
from sim.errors import WeatherError
from sim.weather.components import STRONGEST_MPS, read_components
from sim.weather.cube import Cube, cube_of
from sim.weather.curved import regridding
from sim.weather.files import Reading, window_of
from sim.weather.forecast import Forecast, WindCubes, open_forecast
from sim.weather.ground import Ground, Window, spacing_deg
from sim.weather.spacing import evenly_spaced
from sim.weather.spans import Spans, over_time
from sim.weather.tally import STAGE_S, SpeedAtLevel, StageShare, Tally
from sim.weather.units import METRES_PER_SECOND, factor
from sim.weather.variables import HORIZONTAL, Role

Floats = NDArray[np.float64]

_KM_PER_DEG = 111.195


@dataclass(frozen=True, slots=True)
class VariableSeen:
    """A variable and what it is taken for.

    `problem` says why it cannot be used, if it cannot; `left_out` why it is not, where another one is.
    """

    name: str
    taken_for: str | None
    says: str
    unit: str
    levels: str
    times: int
    members: int
    problem: str | None
    left_out: str | None = None


@dataclass(frozen=True, slots=True)
class Quantity:
    """The speed that is shown: of the wind, or of gusts where no more is known.

    Attributes:
        name: of its variables.
        kind: "wind", "wind speed" or "gust speed".
        area_deg: south, north, west, east.
        points: rows and columns.
        spacing_km: from row to row, and from column to column in the middle.
        curved: whether it lies on the grid of a map projection.
        issued_s: reference time of the forecast, None for none.
        time_s: all its times.
        windows_s: begin and end of what its values are of; None where they are of these times, or of what was
            before each.
        gaps_s: begin and end of each stretch in which times are missing.
        over_time: what a value is of its window, such as the highest; None if it is of a moment.
        levels: of the quantity, for people.
        height_m: of its levels above the sea as galeway takes them, None where it is not known.
        members: their numbers.
        missing: how many of its values are NaN or fill values.
        values: how many there are.
        speeds: by level.
        threshold_mps: of `stages`.
        stages: of an hour each, from the first time on.
    """

    name: str
    kind: str
    area_deg: tuple[float, ...]
    points: tuple[int, int]
    spacing_km: tuple[float, float]
    curved: bool
    issued_s: float | None
    time_s: tuple[float, ...]
    windows_s: tuple[tuple[float, float], ...] | None
    gaps_s: tuple[tuple[float, float], ...]
    over_time: str | None
    levels: str
    height_m: tuple[float, ...] | None
    members: tuple[int, ...]
    missing: int
    values: int
    speeds: tuple[SpeedAtLevel, ...]
    threshold_mps: float
    stages: tuple[StageShare, ...]


@dataclass(frozen=True, slots=True)
class Survey:
    """What is in weather files, and whether a flight can be flown in them; `why_not` says why not."""

    files: tuple[tuple[str, str], ...]
    variables: tuple[VariableSeen, ...]
    quantity: Quantity | None
    flyable: bool
    why_not: str | None


def survey(paths: Sequence[Path], *, reading: Reading = Reading(), threshold_mps: float = 15.0) -> Survey:  # noqa: B008
    """Look through weather files, a time at a time.

    Args:
        paths: of the files of one forecast.
        reading: what to take where there is a choice.
        threshold_mps: above which a point counts as over it.

    Raises:
        WeatherError: if a file cannot be opened, or breaks off.
    """
    with open_forecast(paths) as forecast:
        files = dict.fromkeys((str(one.path), one.format) for one in forecast.opened)
        variables = tuple(_seen(forecast, name) for name in forecast.variables)
        shown: WindCubes | Cube | None
        try:
            shown, why_not = forecast.wind(reading.variables, reading.levels), None
        except WeatherError as error:
            shown, why_not = _speed_alone(forecast, reading), str(error)
        if shown is None:
            return Survey(tuple(files), variables, None, False, why_not)
        variables = tuple(
            replace(seen, left_out=_left_out(forecast, shown, reading, seen)) for seen in variables
        )
        quantity = _quantity(forecast, shown, reading, threshold_mps)
        if isinstance(shown, WindCubes):
            why_not = _why_not(shown, quantity, reading)
        return Survey(tuple(files), variables, quantity, why_not is None, why_not)


def _seen(forecast: Forecast, name: str) -> VariableSeen:
    variable, role = forecast.variables[name][0][1], forecast.roles[name]
    says = str(variable.attrs.get("standard_name", "unknown"))
    if says == "unknown":
        says = str(variable.attrs.get("long_name", ""))
    unit = str(variable.attrs.get("units", ""))
    try:
        cube = cube_of(name, forecast.pieces(name))
    except WeatherError as error:
        problem = str(error) if role else None
        return VariableSeen(name, role, says, unit, "", 0, 0, problem)
    levels = cube.levels.describe()
    return VariableSeen(name, role, says, unit, levels, cube.time_s.size, len(cube.members), None)


def _left_out(
    forecast: Forecast, shown: WindCubes | Cube, reading: Reading, seen: VariableSeen
) -> str | None:
    """Why a variable that could have been a part of what is shown is none; None where that is no question."""
    cubes = [cube for cube in shown[:4] if cube] if isinstance(shown, WindCubes) else [shown]
    names = list(dict.fromkeys(str(piece.values.name) for cube in cubes for piece in cube.pieces))
    role = forecast.roles[seen.name]
    if seen.name in names or seen.problem is not None:
        return None
    if isinstance(shown, Cube):
        return f"the speed shown is that of {shown.name}" if role in (Role.GUST, Role.SPEED) else None
    if role in HORIZONTAL:
        return f"the wind is {shown.first.name} with {shown.second.name}"
    if role is not Role.UP:
        return None
    if reading.variables is not None:
        return f"{' and '.join(reading.variables)} alone are asked for"
    rivals = [name for name, has in forecast.roles.items() if has is Role.UP and name != seen.name]
    if rivals:
        return f"{', '.join(rivals)} would do as well, and no upward wind is taken of several"
    return f"it does not lie on the axes of {shown.first.name}"


def _speed_alone(forecast: Forecast, reading: Reading) -> Cube | None:
    """The gust, or the wind's speed, where there is no more."""
    for role in (Role.GUST, Role.SPEED):
        for name, has in forecast.roles.items():
            try:
                if has is role:
                    return forecast.cube(name, reading.levels)
            except WeatherError:
                continue
    return None


def _why_not(wind: WindCubes, quantity: Quantity, reading: Reading) -> str | None:
    """Why the wind cannot be flown in, as far as can be known without a mission."""
    ground, window = wind.first.ground, window_of(wind.first.ground, reading)
    try:
        one = slice(0, 1)
        read_components(wind, window, members=wind.first.members[:1], times=one, wind_axes=reading.wind_axes)
        if ground.curved:
            regridding(window, None)
        else:
            evenly_spaced([], window.lat_deg, axis=-2, name="latitude")
            evenly_spaced([], window.lon_deg, axis=-1, name="longitude")
    except (WeatherError, PlannerError) as error:
        return str(error)
    fastest_mps = max(speed.highest_mps for speed in quantity.speeds)
    if fastest_mps > STRONGEST_MPS:
        return (
            f"it has a wind of {fastest_mps:.3g} m/s (limit {STRONGEST_MPS:.0f} m/s); if it marks missing "
            "values, "
            "declare it as _FillValue"
        )
    if quantity.missing:
        return f"{quantity.missing} values are missing: choose an area without them, in [grid]"
    return None


def _quantity(
    forecast: Forecast, shown: WindCubes | Cube, reading: Reading, threshold_mps: float
) -> Quantity:
    cube = shown.first if isinstance(shown, WindCubes) else shown
    window = window_of(cube.ground, reading)
    tally = Tally(cube.levels.values.size, threshold_mps)
    spans = Spans.at(cube.time_s) if isinstance(shown, WindCubes) else cube.spans
    windows_s = list(zip(spans.begin_s.tolist(), spans.end_s.tolist(), strict=True))
    for (begin_s, end_s), parts in zip(windows_s, _sheets(shown, window), strict=True):
        if spans.windowed:
            tally.add_window(begin_s, end_s, parts)
        else:
            tally.add(end_s, parts)
    lat_deg, lon_deg = window.lat_deg, window.lon_deg
    height_m = cube.levels.height_m
    name, kind = cube.name, "wind"
    if isinstance(shown, WindCubes):
        name = f"{cube.name}, {shown.second.name}"
    else:
        kind = str(forecast.roles[cube.name])
    return Quantity(
        name=name,
        kind=kind,
        area_deg=tuple(float(v) for v in (lat_deg.min(), lat_deg.max(), lon_deg.min(), lon_deg.max())),
        points=window.shape,
        spacing_km=_spacing_km(cube.ground, window),
        curved=cube.ground.curved,
        issued_s=cube.pieces[0].axes.issued_s,
        time_s=tuple(cube.time_s.tolist()),
        windows_s=tuple(windows_s) if spans.windowed else None,
        gaps_s=tuple(spans.gaps_s()),
        over_time=over_time(cube.first),
        levels=cube.levels.describe(),
        height_m=None if height_m is None else tuple(height_m.tolist()),
        members=cube.members,
        missing=tally.missing,
        values=tally.values,
        speeds=tally.speeds(cube.levels),
        threshold_mps=threshold_mps,
        stages=tuple(_known(stage, spans.gaps_s()) for stage in tally.finished()),
    )


def _known(stage: StageShare, gaps_s: Sequence[tuple[float, float]]) -> StageShare:
    """A stage whose shares are not known where a part of it lies in a gap."""
    begin_s, end_s = stage.begin_s + 1.0, stage.begin_s + STAGE_S - 1.0
    if any(gap_begin_s < end_s and begin_s < gap_end_s for gap_begin_s, gap_end_s in gaps_s):
        return replace(stage, over=(math.nan,) * len(stage.over))
    return stage


def _sheets(shown: WindCubes | Cube, window: Window) -> Iterator[list[Floats]]:
    """For each time, what a speed is made of: two components, or the speed; each (M, L, R, C) [m/s]."""
    cube = shown.first if isinstance(shown, WindCubes) else shown
    for index in range(cube.time_s.size):
        times = slice(index, index + 1)
        if isinstance(shown, WindCubes):
            bare = shown._replace(up=None, geopotential=None)
            found = read_components(bare, window, times=times, wind_axes="earth")
            yield [np.asarray(part[:, 0], dtype=np.float64) for part in found[:2]]
        else:
            scale = factor(cube.first, METRES_PER_SECOND, "speed")
            yield [scale * np.asarray(cube.read(window, times=times)[:, 0], dtype=np.float64)]


def _spacing_km(ground: Ground, window: Window) -> tuple[float, float]:
    if ground.curved:
        rows, columns = spacing_deg(window.lat_deg, window.lon_deg)
        return _KM_PER_DEG * rows, _KM_PER_DEG * columns
    narrow = math.cos(math.radians(float(window.lat_deg.mean())))
    steps = [
        float(np.diff(nodes).mean()) if nodes.size > 1 else 0.0 for nodes in (window.lat_deg, window.lon_deg)
    ]
    return _KM_PER_DEG * steps[0], _KM_PER_DEG * narrow * steps[1]
