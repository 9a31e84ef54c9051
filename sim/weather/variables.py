"""Which variable of a weather file is what: wind components, speed and direction, gust, geopotential."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from sim.errors import WeatherError
from sim.weather.units import GEOPOTENTIAL_METRES, METRES_PER_SECOND

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr


class Role(StrEnum):
    """What a variable is taken for."""

    EAST = "eastward wind"
    NORTH = "northward wind"
    GRID_X = "wind along the grid's x axis"
    GRID_Y = "wind along the grid's y axis"
    UP = "upward wind"
    SPEED = "wind speed"
    FROM = "direction the wind comes from"
    TOWARD = "direction the wind blows to"
    GUST = "gust speed"
    GEOPOTENTIAL = "geopotential or its height"


_STANDARD_NAMES = {
    "eastward_wind": Role.EAST,
    "northward_wind": Role.NORTH,
    "x_wind": Role.GRID_X,
    "y_wind": Role.GRID_Y,
    "grid_eastward_wind": Role.GRID_X,
    "grid_northward_wind": Role.GRID_Y,
    "upward_air_velocity": Role.UP,
    "wind_speed": Role.SPEED,
    "wind_from_direction": Role.FROM,
    "wind_to_direction": Role.TOWARD,
    "wind_speed_of_gust": Role.GUST,
    "geopotential": Role.GEOPOTENTIAL,
    "geopotential_height": Role.GEOPOTENTIAL,
}
_PLACE = r"_?(\d+)?(m|_?maboveground|m_above_ground|_height_above_ground)?"
_NAMES = {
    Role.EAST: rf"(\d+)?(m_)?u|u{_PLACE}|u(a|as|grd{_PLACE}|wnd|_?wind)|wind_u|\d+m_u_component_of_wind|"
    rf"u[-_]component_of_wind{_PLACE}|eastward_wind",
    Role.UP: r"w|wa",
    Role.SPEED: r"(\d+)?(si|ws|wind_?speed|sfcwind)_?(\d+)?m?",
    Role.FROM: r"(\d+)?(wdir|wd|wind_?(from_)?dir(ection)?)_?(\d+)?m?",
    Role.GUST: r"i?(\d+)?(fg|gust|i10fg|wind_?gust|fx|wsgmax)(\d+)?(m|_\d+)?|vmax_10m|wind_speed_of_gust|"
    r"sfcgust|instantaneous_10m_wind_gust|10m_wind_gust(_since_previous_post_processing)?",
    Role.GEOPOTENTIAL: r"z|gh|zg|hgt|geopotential(_height)?",
}
_NORTH = rf"(\d+)?(m_)?v|v{_PLACE}|v(a|as|grd{_PLACE}|wnd|_?wind)|wind_v|\d+m_v_component_of_wind|" + (
    rf"v[-_]component_of_wind{_PLACE}|northward_wind"
)
_PATTERNS = {
    role: re.compile(pattern, re.IGNORECASE) for role, pattern in (*_NAMES.items(), (Role.NORTH, _NORTH))
}
_UNITS_OF_NAMES = {Role.UP: METRES_PER_SECOND, Role.GEOPOTENTIAL: GEOPOTENTIAL_METRES}
"""Names so short that only a unit tells: w may be a speed or a change of pressure."""

_PAIRS = (
    (Role.EAST, Role.NORTH),
    (Role.GRID_X, Role.GRID_Y),
    (Role.SPEED, Role.FROM),
    (Role.SPEED, Role.TOWARD),
)

HORIZONTAL = frozenset(role for pair in _PAIRS for role in pair)
"""Roles of which two make a wind."""


class WindNames(NamedTuple):
    """Two variables that make a wind: components, or a speed and a direction."""

    first: str
    second: str


def role_of(variable: xr.DataArray) -> Role | None:
    """What a variable is, by its CF standard name, else by its GRIB or usual name; None if none of ours."""
    standard_name = str(variable.attrs.get("standard_name", ""))
    if standard_name in _STANDARD_NAMES:
        return _along_grid(_STANDARD_NAMES[standard_name], variable)
    if standard_name and standard_name != "unknown":
        return None
    names = (str(variable.name), str(variable.attrs.get("GRIB_shortName", "")))
    for role, pattern in _PATTERNS.items():
        if any(pattern.fullmatch(name) for name in names):
            fitting = _UNITS_OF_NAMES.get(role)
            fits = fitting is None or variable.attrs.get("units") in fitting
            return _along_grid(role, variable) if fits else None
    return None


def _along_grid(role: Role, variable: xr.DataArray) -> Role:
    """The role, or where GRIB says that components are along the grid, that of such a component."""
    turned = {Role.EAST: Role.GRID_X, Role.NORTH: Role.GRID_Y}
    return turned.get(role, role) if variable.attrs.get("GRIB_uvRelativeToGrid") == 1 else role


def find_winds(
    roles: Mapping[str, Role | None], wanted: tuple[str, str] | None, seen: str
) -> list[WindNames]:
    """The pairs of variables that make a wind; several where a file has one for each of several heights.

    Args:
        roles: of each variable, by name.
        wanted: the two to take, if the user has said so.
        seen: the variables for messages.

    Raises:
        WeatherError: if there is no pair, or a wanted one is missing.
    """
    if wanted is not None:
        missing = [name for name in wanted if name not in roles]
        if missing:
            raise WeatherError(
                f"it lacks the winds {' and '.join(wanted)} and has {seen}; name two of its variables in "
                "weather.variables, eastward and northward"
            )
        return [WindNames(*wanted)]
    pairs = [pair for first, second in _PAIRS for pair in _paired(_with(roles, first), _with(roles, second))]
    components = [pair for pair in pairs if roles[pair.first] is not Role.SPEED]
    if components or pairs:
        return components or pairs
    raise WeatherError(_why_no_wind(roles, seen))


def _why_no_wind(roles: Mapping[str, Role | None], seen: str) -> str:
    speeds = _with(roles, Role.GUST) + _with(roles, Role.SPEED)
    if speeds:
        return (
            f"it has the speed of the wind ({', '.join(speeds)}) and not its direction, so it can say where "
            "flying is dangerous but not how the air moves; bring a file with wind components, or speed and "
            "wind_from_direction, to fly in"
        )
    return (
        f"it lacks an east and a north wind and has {seen}; name the two variables to read in "
        "weather.variables, or give them the CF standard names eastward_wind and northward_wind"
    )


def find_upward(roles: Mapping[str, Role | None]) -> str | None:
    """The upward wind, if there is one and no more."""
    upward = _with(roles, Role.UP)
    return upward[0] if len(upward) == 1 else None


def introduced(variables: Iterable[xr.DataArray]) -> str:
    """Variables for messages: names, and what they say of themselves."""
    known = {
        str(values.name): values.attrs.get("standard_name", values.attrs.get("long_name", "unnamed"))
        for values in variables
    }
    return ", ".join(f"{name} ({text})" for name, text in known.items()) or "no variables at all"


def _with(roles: Mapping[str, Role | None], role: Role) -> list[str]:
    return [name for name, has in roles.items() if has is role]


def _paired(firsts: list[str], seconds: list[str]) -> list[WindNames]:
    """Variables of two roles that belong together by what is left of their names without the component."""
    if len(firsts) == len(seconds) == 1:
        return [WindNames(firsts[0], seconds[0])]
    partners = {_stem(name): name for name in seconds}
    return [WindNames(name, partners[_stem(name)]) for name in firsts if _stem(name) in partners]


def _stem(name: str) -> str:
    plain = re.sub(
        r"eastward|northward|si|ws|wdir|wd|(speed|from_direction|direction|dir)",
        "",
        name,
        flags=re.IGNORECASE,
    )
    return re.sub(r"(?<![a-z])[uvxy](?=[^a-z]|$|grd|as?$|wnd|wind)", "", plain, flags=re.IGNORECASE).lower()
