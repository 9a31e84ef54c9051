"""One quantity of a forecast over all its files: members, times, levels, and the ground.

A file, or a parameter of a GRIB file, holds some members, times and levels of a quantity. A `Cube` lays such
pieces beside each other along those three axes and reads from them what is asked for, and no more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.errors import WeatherError
from sim.weather.axes import Axes, find_axes
from sim.weather.ground import Ground, Window, find_ground
from sim.weather.levels import LevelKind, Levels, height_named, levels_of
from sim.weather.opening import Opened, broken_named
from sim.weather.spans import Spans, joined, spans_of
from sim.weather.times import refuse_falling, utc
from sim.weather.units import has_unit

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

Floats = NDArray[np.float64]
FieldArray = NDArray[np.float32] | NDArray[np.float64]

_SAME_TIME_S = 0.5


@dataclass(frozen=True, eq=False)
class Piece:
    """A variable of one file, unread, with its axes understood."""

    path: Path
    values: xr.DataArray
    axes: Axes
    spans: Spans
    levels: Levels
    ground: Ground

    def read(
        self, members: Sequence[int], times: Sequence[int], levels: Sequence[int], window: Window
    ) -> FieldArray:
        """Some of the values, by index along each axis; shape (M, T, L, rows, columns), NaN where missing."""
        axes = self.axes
        ground = dict(zip(axes.ground, self.ground.places(window), strict=True))
        wanted: dict[str, Any] = dict(ground)
        for name, places in ((axes.member, members), (axes.time, times), (axes.level, levels)):
            if name is not None and name in self.values.dims:
                wanted[name] = _run(places)
        kept = [name for name in (axes.member, axes.time, axes.level) if name in self.values.dims]
        rest = {str(name): 0 for name in self.values.dims if name not in (*kept, *axes.ground)}
        with broken_named(self.path):
            values = self.values.isel(wanted | rest).transpose(*kept, *axes.ground).values
        if values.dtype != np.float32:
            values = np.asarray(values, dtype=np.float64)
        return values.reshape(len(members), len(times), len(levels), *values.shape[-2:])


def piece_of(opened: Opened, variable: xr.DataArray) -> Piece:
    """A variable of an opened file with its axes.

    Raises:
        WeatherError: if they make no sense.
    """
    with broken_named(opened.path):
        axes = find_axes(variable)
        vertical = None if axes.level is None else variable[axes.level]
        levels = levels_of(vertical, variable, height_named(variable))
        if axes.time is not None:
            refuse_falling(axes.time_s, axes.time)
        spans = spans_of(opened.dataset, variable, axes.time_s)
        return Piece(opened.path, variable, axes, spans, levels, find_ground(variable, axes))


@dataclass(frozen=True, eq=False)
class Cube:
    """A quantity, put together from its pieces.

    Attributes:
        name: of the variable, or variables, in the files.
        pieces: at least one, all on one ground.
        members: numbers of the ensemble's members, rising.
        time_s: rising, shape (T,) [s since 1970-01-01 UTC].
        spans: when the values of these times hold.
        levels: from the lowest to the highest.
        ground: where the columns and rows lie.
        shared: whether its pieces are without members, and hold for each of these.
    """

    name: str
    pieces: tuple[Piece, ...]
    members: tuple[int, ...]
    time_s: Floats
    spans: Spans
    levels: Levels
    ground: Ground
    shared: bool = False

    @property
    def first(self) -> xr.DataArray:
        """The variable of the first piece, for its unit and names."""
        return self.pieces[0].values

    def read(
        self,
        window: Window,
        *,
        members: Sequence[int] | None = None,
        times: slice = slice(None),
        levels: slice = slice(None),
    ) -> FieldArray:
        """The values of a part of the ground, shape (M, T, L, rows, columns); NaN where files have gaps.

        Args:
            window: rows and columns.
            members: their numbers; all by default.
            times: which of `time_s`; all by default.
            levels: which of `levels`; all by default.

        Raises:
            WeatherError: if a file breaks off, or has nothing for one of the members, times and levels.
        """
        wanted = self.members if members is None else tuple(members)
        if self.shared:
            own = replace(self, members=self.pieces[0].axes.members, shared=False)
            one = own.read(window, times=times, levels=levels)
            same: FieldArray = np.broadcast_to(one, (len(wanted), *one.shape[1:]))  # type: ignore[assignment]
            return same
        time_s, level_values = self.time_s[times], self.levels.values[levels]
        shape = (len(wanted), time_s.size, level_values.size, *window.shape)
        dtype = np.result_type(*(piece.values.dtype for piece in self.pieces))
        result = np.empty(shape, dtype=np.float32 if dtype == np.float32 else np.float64)
        filled = np.zeros(shape[:3], dtype=bool)
        for piece in self.pieces:
            ours, theirs = _common(np.array(wanted), np.array(piece.axes.members), 0.5)
            our_times, their_times = _common(time_s, piece.axes.time_s, _SAME_TIME_S)
            our_levels, their_levels = _common(level_values, piece.levels.values, 1e-3)
            if len(theirs) and len(their_times) and len(their_levels):
                place = np.ix_(ours, our_times, our_levels)
                result[place] = piece.read(theirs, their_times, their_levels, window)
                filled[place] = True
        self._refuse_holes(filled, wanted, time_s, level_values)
        return result

    def _refuse_holes(
        self, filled: NDArray[np.bool_], members: Sequence[int], time_s: Floats, levels: Floats
    ) -> None:
        if filled.all():
            return
        member, time, level = np.unravel_index(int(np.argmin(filled)), filled.shape)
        at = Levels(self.levels.kind, levels[level : level + 1])
        raise WeatherError(
            f"{self.name} has nothing for {np.count_nonzero(~filled)} of {filled.size} combinations of "
            f"member, time and level, the first at member {members[int(member)]}, {utc(time_s[time])}, "
            f"{at.describe()}; bring the missing files or messages, or leave out those that go further than "
            "the others"
        )


def cube_of(name: str, pieces: Sequence[Piece]) -> Cube:
    """Lay pieces beside each other.

    Raises:
        WeatherError: if they lie on different grounds, are of different forecasts, have different units or
            kinds of levels, or two hold the same member, time and level.
    """
    first = pieces[0]
    for piece in pieces[1:]:
        if not first.ground.same_as(piece.ground):
            raise WeatherError(
                f"{name} lies on {first.ground.describe()} in {first.path.name}, but on "
                f"{piece.ground.describe()} in {piece.path.name}; give files of one grid"
            )
        if (
            None not in (first.axes.issued_s, piece.axes.issued_s)
            and first.axes.issued_s != piece.axes.issued_s
        ):
            raise WeatherError(
                f"{first.path.name} is of the forecast of {utc(first.axes.issued_s or 0.0)}, "
                f"{piece.path.name} of "
                f"that of {utc(piece.axes.issued_s or 0.0)}; give the files of one forecast"
            )
        units = [one.values.attrs.get("units") for one in (first, piece)]
        if units[0] != units[1]:
            raise WeatherError(
                f"{name} has {has_unit(units[0])} in {first.path.name}, but {has_unit(units[1])} in "
                f"{piece.path.name}; convert one of them"
            )
        if first.levels.kind is not piece.levels.kind:
            raise WeatherError(
                f"{name} is found twice: at {first.levels.describe()} and at {piece.levels.describe()}; "
                "choose with "
                'weather.levels = "height" or "pressure", or name the variables in weather.variables'
            )
    members = sorted({member for piece in pieces for member in piece.axes.members})
    time_s = _merged(np.concatenate([piece.axes.time_s for piece in pieces]), _SAME_TIME_S)
    values = _merged(np.concatenate([piece.levels.values for piece in pieces]), 1e-3)
    falls = first.levels.kind is LevelKind.PRESSURE
    cube = Cube(
        name,
        tuple(pieces),
        tuple(members),
        time_s,
        _spans(name, pieces, time_s),
        Levels(first.levels.kind, values[::-1].copy() if falls else values),
        first.ground,
    )
    _refuse_doubles(cube)
    return cube


def _spans(name: str, pieces: Sequence[Piece], time_s: Floats) -> Spans:
    """When values hold, of which all pieces must say the same."""
    spans = np.full((2, time_s.size), np.nan)
    for piece in pieces:
        ours, theirs = _common(time_s, piece.axes.time_s, _SAME_TIME_S)
        own = np.stack((piece.spans.begin_s, piece.spans.end_s))[:, theirs]
        differ = np.abs(spans[:, ours] - own) > _SAME_TIME_S
        if differ.any():
            at_s = time_s[ours[int(np.argmax(differ.any(axis=0)))]]
            raise WeatherError(
                f"{name} has windows of different lengths at {utc(float(at_s))}; keep those of one length"
            )
        spans[:, ours] = own
    return joined(Spans(*spans), name)


def _refuse_doubles(cube: Cube) -> None:
    owner = np.full((len(cube.members), cube.time_s.size, cube.levels.values.size), -1)
    for number, piece in enumerate(cube.pieces):
        place = np.ix_(
            _common(np.array(cube.members), np.array(piece.axes.members), 0.5)[0],
            _common(cube.time_s, piece.axes.time_s, _SAME_TIME_S)[0],
            _common(cube.levels.values, piece.levels.values, 1e-3)[0],
        )
        taken = owner[place] >= 0
        if taken.any():
            other = cube.pieces[int(owner[place][taken][0])]
            _, time, _ = np.argwhere(taken)[0]
            raise WeatherError(
                f"{cube.name} is found twice, as {other.values.name} in {other.path.name} and as "
                f"{piece.values.name} in {piece.path.name}, at "
                f"{utc(float(cube.time_s[place[1].ravel()[time]]))}, "
                f"{cube.levels.describe()}; name the variables in weather.variables, or leave out one of "
                "the files"
            )
        owner[place] = number


def _common(ours: NDArray[Any], theirs: NDArray[Any], tolerance: float) -> tuple[list[int], list[int]]:
    """Where the same values are in two rows of them."""
    same = np.abs(np.subtract.outer(ours.astype(np.float64), theirs.astype(np.float64))) <= tolerance
    mine, others = np.nonzero(same)
    return mine.tolist(), others.tolist()


def _merged(values: Floats, tolerance: float) -> Floats:
    """Rising, without those that are the same."""
    rising = np.sort(values)
    return rising[np.concatenate(([True], np.diff(rising) > tolerance))]


def _run(places: Sequence[int]) -> slice | list[int]:
    """A slice, which files read faster, where the places follow each other."""
    if len(places) and list(places) == list(range(places[0], places[0] + len(places))):
        return slice(places[0], places[0] + len(places))
    return list(places)
