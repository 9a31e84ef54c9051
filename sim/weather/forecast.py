"""A forecast as its files hold it: which variables there are, and the cubes that they make."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from sim.errors import WeatherError
from sim.weather.cube import Cube, Piece, cube_of, piece_of
from sim.weather.levels import LevelKind
from sim.weather.opening import Opened, opened
from sim.weather.spans import bounds_names
from sim.weather.variables import Role, WindNames, find_upward, find_winds, introduced, role_of

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

LevelChoice = Literal["height", "pressure"]

_KINDS = {
    "height": (LevelKind.ABOVE_GROUND, LevelKind.ABOVE_SEA, LevelKind.NONE),
    "pressure": (LevelKind.PRESSURE,),
}


class WindCubes(NamedTuple):
    """A wind: two components, or speed and direction; what goes up, and how high the levels are, if known."""

    first: Cube
    second: Cube
    up: Cube | None
    geopotential: Cube | None
    roles: tuple[Role, Role]


@dataclass(frozen=True, eq=False)
class Forecast:
    """Opened files of one forecast.

    `opened`: their datasets. Everything else is found in them when it is asked for.
    """

    opened: tuple[Opened, ...]

    @cached_property
    def variables(self) -> dict[str, list[tuple[Opened, xr.DataArray]]]:
        """The variables by name, each with the datasets that have it."""
        found: dict[str, list[tuple[Opened, xr.DataArray]]] = {}
        for one in self.opened:
            bounds = bounds_names(one.dataset)
            for name in one.dataset.data_vars:
                if name in bounds:
                    continue
                found.setdefault(str(name), []).append((one, one.dataset[name]))
        return found

    @cached_property
    def roles(self) -> dict[str, Role | None]:
        """What each variable is taken for."""
        return {name: role_of(found[0][1]) for name, found in self.variables.items()}

    @property
    def seen(self) -> str:
        """The variables for messages."""
        return introduced(found[0][1] for found in self.variables.values())

    def pieces(self, name: str, levels: LevelChoice | None = None) -> list[Piece]:
        """A variable in each file, without levels that are not wanted or cannot be used.

        Raises:
            WeatherError: if its axes make no sense, or nothing is left.
        """
        pieces = [piece_of(one, variable) for one, variable in self.variables[name]]
        kinds = tuple(LevelKind) if levels is None else _KINDS[levels]
        usable = [p for p in pieces if p.levels.kind in kinds and p.levels.kind is not LevelKind.OTHER]
        if not usable:
            there = "; ".join(dict.fromkeys(piece.levels.describe() for piece in pieces))
            wanted = f"{levels} levels" if levels else "heights or pressures"
            raise WeatherError(f"{name} has {there}, not {wanted}; interpolate it to heights in metres")
        return usable

    def cube(self, name: str, levels: LevelChoice | None = None) -> Cube:
        """One variable over all files.

        Raises:
            WeatherError: if there is none of that name, or its pieces do not fit together.
        """
        if name not in self.variables:
            raise WeatherError(f"it lacks {name} and has {self.seen}; name one of its variables")
        return cube_of(name, self.pieces(name, levels))

    def wind(self, variables: tuple[str, str] | None = None, levels: LevelChoice | None = None) -> WindCubes:
        """The wind, by its two variables or the only one there is.

        Winds at several heights, such as u10 and u100, are one.

        Raises:
            WeatherError: if there is none or more than one, or its components do not fit together.
        """
        pairs = find_winds(self.roles, variables, self.seen)
        if len(pairs) > 1:
            pairs = self._choose(pairs, levels)
        first, second = (
            cube_of(" and ".join(names), [piece for name in names for piece in self.pieces(name, levels)])
            for names in zip(*pairs, strict=True)
        )
        if first.members != second.members:
            raise WeatherError(
                f"the wind {first.name} has {_members_text(first)}, and "
                f"{second.name} {_members_text(second)}; "
                "a component of one member does not go with that of another, so bring both of the same ones"
            )
        if not _same_axes(first, second):
            raise WeatherError(
                f"the winds {first.name} and {second.name} lie on different axes, {_axes_text(first)} and "
                f"{_axes_text(second)}; give them the same"
            )
        return WindCubes(
            first,
            second,
            self._beside(first, find_upward(self.roles) if variables is None else None),
            self._geopotential(first),
            self._roles(pairs[0], named=variables is not None),
        )

    def _roles(self, pair: WindNames, *, named: bool) -> tuple[Role, Role]:
        """What the two are; variables that the user has named and nobody knows are east and north."""
        first, second = self.roles[pair.first], self.roles[pair.second]
        if first is None or second is None or (named and Role.UP in (first, second)):
            return Role.EAST, Role.NORTH
        return first, second

    def _choose(self, pairs: list[WindNames], levels: LevelChoice | None) -> list[WindNames]:
        """Those of several winds that are one at several levels of one kind."""
        kinds: dict[WindNames, set[LevelKind]] = {}
        problem: WeatherError | None = None
        for pair in pairs:
            try:
                kinds[pair] = {piece.levels.kind for name in pair for piece in self.pieces(name, levels)}
            except WeatherError as error:  # such as model levels: another pair may do
                problem = problem or error
        if not kinds and problem is not None:
            raise problem
        together = set.union(*kinds.values()) if kinds else set()
        if len(together) == 1 and (len(kinds) == 1 or LevelKind.NONE not in together):
            return list(kinds)
        raise WeatherError(
            f"it has several winds ({self.seen}); name the two to read, eastward and northward, in "
            'weather.variables, or choose weather.levels = "height" or "pressure"'
        )

    def _beside(self, wind: Cube, name: str | None) -> Cube | None:
        """Another variable on the axes of the wind, or the same for all its members; None if elsewhere."""
        if name is None:
            return None
        try:
            cube = self.cube(name)
        except WeatherError:
            return None
        if len(cube.members) == 1:
            cube = replace(cube, members=wind.members, shared=True)
        return cube if _same_axes(wind, cube) else None

    def _geopotential(self, wind: Cube) -> Cube | None:
        """The geopotential on all of the wind's pressure levels."""
        if wind.levels.kind is not LevelKind.PRESSURE:
            return None
        names = [name for name, role in self.roles.items() if role is Role.GEOPOTENTIAL]
        found = [cube for cube in (self._beside(wind, name) for name in names) if cube is not None]
        return found[0] if found else None


@contextmanager
def open_forecast(paths: Sequence[Path]) -> Iterator[Forecast]:
    """Open the files of one forecast.

    Raises:
        WeatherError: if one cannot be opened; and with the files' names, what is raised inside.
    """
    with opened(paths) as datasets:
        try:
            yield Forecast(tuple(datasets))
        except WeatherError as error:
            names = ", ".join(dict.fromkeys(str(one.path) for one in datasets[:3]))
            more = f" and {len(paths) - 3} more" if len(paths) > 3 else ""
            raise WeatherError(f"the weather file {names}{more} cannot be used: {error}") from error


def _same_axes(one: Cube, other: Cube) -> bool:
    return (
        one.members == other.members
        and np.array_equal(one.time_s, other.time_s)
        and one.levels.kind is other.levels.kind
        and np.array_equal(one.levels.values, other.levels.values)
        and one.ground.same_as(other.ground)
    )


def _members_text(cube: Cube) -> str:
    numbers = cube.members
    if len(numbers) == 1:
        return "one member"
    return f"{len(numbers)} members, {numbers[0]} to {numbers[-1]}"


def _axes_text(cube: Cube) -> str:
    return (
        f"{len(cube.members)} members, {cube.time_s.size} times, {cube.levels.describe()}, "
        f"{cube.ground.describe()}"
    )
