"""Gridded wind over time, and the wind at a point of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.axis import EVERYWHERE, Axis
from planner.errors import BadFieldError
from planner.grid import Grid
from planner.tiled import is_tiled
from planner.windprobe import WindProbe

Floats = NDArray[np.float64]
FieldArray = NDArray[np.float32] | NDArray[np.float64]

_ROUNDING_S = 1e-3  # a clock that adds up steps may end this much beyond the last time
_ROUNDING_M = 1e-6


class Wind(NamedTuple):
    """Velocity of the air: where it moves to, not where it comes from."""

    north_mps: float
    east_mps: float
    down_mps: float = 0.0

    @property
    def speed_mps(self) -> float:
        """Horizontal speed [m/s]."""
        return math.hypot(self.north_mps, self.east_mps)


@dataclass(frozen=True, eq=False)
class WindField:
    """Wind on a grid at a series of times, and at a series of heights if it has any.

    Between the nodes wind is linear in time and height and bilinear in space, so it never leaves the range
    of its neighbours. The area is that of the cells: in the half cell beyond the outermost centres the
    outermost value holds, and so do all outermost values outside the field, if `hold` is set.

    The arrays become the field's own and are made read-only. What is too large for memory comes as
    `TiledArray`, of which the ways to ask read no more than they need.

    Attributes:
        grid: the cell centres.
        time_s: rising, shape (T,) [s since 1970-01-01 UTC].
        north_mps: toward north, float32 or float64, shape (T, R, C), or (T, H, R, C) with heights.
        east_mps: toward east, likewise.
        height_m: rising, above the ellipsoid, for which sea level is taken, shape (H,); None for wind that is
            the same at every height.
        down_mps: downward, of the same shape; None for none.
        hold: answer queries outside time, height and area with the outermost value instead of raising.

    Raises:
        BadFieldError: if shapes disagree, an axis does not rise, or a value is not finite.
    """

    grid: Grid
    time_s: Floats
    north_mps: FieldArray
    east_mps: FieldArray
    height_m: Floats | None = None
    down_mps: FieldArray | None = None
    hold: bool = False

    def __post_init__(self) -> None:
        self._own("time_s", np.asarray(self.time_s, dtype=np.float64))
        if self.height_m is not None:
            self._own("height_m", np.asarray(self.height_m, dtype=np.float64))
        axes = self.axes  # checks that times and heights rise
        shape = tuple(len(axis.nodes) for axis in axes)
        for name in ("north_mps", "east_mps", "down_mps"):
            values = getattr(self, name)
            if values is None and name == "down_mps":
                continue
            tiled = is_tiled(values)
            if not tiled:
                values = np.asarray(values)
                if values.dtype != np.float32:
                    values = np.asarray(values, dtype=np.float64)
            if values.shape != shape:
                raise BadFieldError(
                    f"{name} has shape {values.shape}, but its axes ({', '.join(a.name for a in axes)}) have "
                    f"lengths {shape}; lay the array out in that order"
                )
            if not tiled:  # whoever reads those has to see to it
                _refuse_non_finite(name, values, axes)
                self._own(name, values)

    def _own(self, name: str, values: NDArray[Any]) -> None:
        values.setflags(write=False)
        object.__setattr__(self, name, values)

    @cached_property
    def axes(self) -> tuple[Axis, ...]:
        """Time, height if there are any, latitude and longitude: the order of the arrays' axes."""
        grid, everywhere = self.grid, EVERYWHERE if self.hold else 0.0
        remedy = "stay inside, load more weather, or set hold to keep the outermost value"
        time = Axis("time", self.time_s, everywhere or _ROUNDING_S, _utc, remedy)
        lat = Axis("latitude", grid.lat_rad, everywhere or grid.north_step_rad / 2.0, _degrees, remedy)
        lon = Axis("longitude", grid.lon_rad, everywhere or grid.east_step_rad / 2.0, _degrees, remedy)
        if self.height_m is None:
            return time, lat, lon
        return time, Axis("altitude", self.height_m, everywhere or _ROUNDING_M, _metres, remedy), lat, lon

    def at(self, time_s: float, lat_rad: float, lon_rad: float, altitude_m: float = 0.0) -> Wind:
        """The wind at one point [m/s]; `altitude_m` does not matter to a field without heights.

        Raises:
            OutsideFieldError: outside time, height or area, unless the field has `hold`.
        """
        return Wind(*self._own_probe(time_s, lat_rad, lon_rad, altitude_m))

    @cached_property
    def _own_probe(self) -> WindProbe:
        return self.probe()

    def at_many(
        self, time_s: ArrayLike, lat_rad: ArrayLike, lon_rad: ArrayLike, altitude_m: ArrayLike = 0.0
    ) -> tuple[Floats, Floats, Floats]:
        """The wind (north, east, down) [m/s] at many points, of the shape the arguments broadcast to.

        Raises:
            OutsideFieldError: if any is outside time, height or area, unless the field has `hold`.
        """
        query = [np.asarray(values, dtype=np.float64) for values in (time_s, altitude_m, lat_rad, lon_rad)]
        query[3] = self.grid.unwrapped(query[3])
        if self.height_m is None:
            query[0] = np.broadcast_to(query[0], np.broadcast_shapes(query[0].shape, query.pop(1).shape))
        ends = [
            axis.spread(values) for axis, values in zip(self.axes, np.broadcast_arrays(*query), strict=True)
        ]
        corners = list(product((0, 1), repeat=len(ends)))
        weights = [
            math.prod(end[2] if bit else 1.0 - end[2] for bit, end in zip(corner, ends, strict=True))
            for corner in corners
        ]
        places = [tuple(end[bit] for bit, end in zip(corner, ends, strict=True)) for corner in corners]

        def interpolated(values: FieldArray | None) -> Floats:
            if values is None:
                return np.zeros(ends[0][0].shape)
            terms = (weight * values[place] for weight, place in zip(weights, places, strict=True))
            return np.asarray(sum(terms), dtype=np.float64)

        return interpolated(self.north_mps), interpolated(self.east_mps), interpolated(self.down_mps)

    def at_altitude(self, altitude_m: float) -> WindField:
        """The field without heights that holds at one altitude [m]; itself if it has no heights.

        Raises:
            OutsideFieldError: above or below the heights, unless the field has `hold`.
        """
        if self.height_m is None:
            return self
        span = self.axes[1].span(altitude_m)
        weight = (altitude_m - span.low) * span.inverse

        def layer(values: FieldArray) -> FieldArray:
            return (1.0 - weight) * values[:, span.first] + weight * values[:, span.second]

        down_mps = None if self.down_mps is None else layer(self.down_mps)
        return replace(
            self,
            north_mps=layer(self.north_mps),
            east_mps=layer(self.east_mps),
            height_m=None,
            down_mps=down_mps,
        )

    def level(self, altitude_m: float, grid: Grid) -> WindField:
        """The wind at one altitude on another grid: `at_altitude` and `resampled` in one, sheet by sheet.

        Raises:
            OutsideFieldError: as these do.
        """
        if self.height_m is None:
            return self.resampled(grid)
        times = range(len(self.time_s))
        sheets = [self._at_time(time).at_altitude(altitude_m).resampled(grid) for time in times]
        down = None if self.down_mps is None else [sheet.down_mps for sheet in sheets]
        return replace(
            self,
            grid=grid,
            height_m=None,
            north_mps=np.concatenate([sheet.north_mps for sheet in sheets]),
            east_mps=np.concatenate([sheet.east_mps for sheet in sheets]),
            down_mps=None if down is None else np.concatenate([part for part in down if part is not None]),
        )

    def _at_time(self, time: int) -> WindField:
        """The field of one of its times, read."""
        down_mps = None if self.down_mps is None else self.down_mps[time : time + 1]
        one = slice(time, time + 1)
        return replace(
            self,
            time_s=self.time_s[one],
            north_mps=self.north_mps[one],
            east_mps=self.east_mps[one],
            down_mps=down_mps,
        )

    def sheet(self, time_s: float) -> tuple[FieldArray, FieldArray]:
        """The wind (north, east) of every cell at one time, shapes ([height,] north, east) [m/s, toward].

        Raises:
            OutsideFieldError: if the field does not hold that time, unless it has `hold`.
        """
        span = self.axes[0].span(time_s)
        weight = (time_s - span.low) * span.inverse
        north, east = (
            (1.0 - weight) * values[span.first] + weight * values[span.second]
            for values in (self.north_mps, self.east_mps)
        )
        return north, east

    def resampled(self, grid: Grid) -> WindField:
        """The same wind on another grid, bilinear in space.

        Raises:
            OutsideFieldError: if the grid reaches outside the area, unless the field has `hold`.
        """
        south, north, north_weight = self.axes[-2].spread(grid.lat_rad)
        west, east, east_weight = self.axes[-1].spread(self.grid.unwrapped(grid.lon_rad))
        north_weight = north_weight[:, np.newaxis]

        def moved(values: FieldArray) -> FieldArray:
            result = np.empty((*values.shape[:-2], *grid.shape), dtype=values.dtype)
            for place in np.ndindex(values.shape[:-2]):  # sheet by sheet: float64 in between, little memory
                sheet = values[place].astype(np.float64)
                rows = (1.0 - north_weight) * sheet[south] + north_weight * sheet[north]
                result[place] = (1.0 - east_weight) * rows[:, west] + east_weight * rows[:, east]
            return result

        down_mps = None if self.down_mps is None else moved(self.down_mps)
        return replace(
            self,
            grid=grid,
            north_mps=moved(self.north_mps),
            east_mps=moved(self.east_mps),
            down_mps=down_mps,
        )

    def probe(self) -> WindProbe:
        """A fast reader for one aircraft that moves through the field."""
        return WindProbe(self)


def _refuse_non_finite(name: str, values: FieldArray, axes: tuple[Axis, ...]) -> None:
    finite = np.isfinite(values)
    if finite.all():
        return
    first = np.unravel_index(int(np.argmin(finite)), values.shape)
    place = ", ".join(
        f"{axis.name} {axis.describe(float(axis.nodes[index]))}"
        for axis, index in zip(axes, first, strict=True)
    )
    raise BadFieldError(
        f"{name} has {values.size - np.count_nonzero(finite)} values of {values.size} that are not finite, "
        f"the first ({values[first]}) at {place}; fill the gaps or cut the area so that it has none"
    )


def _utc(time_s: float) -> str:
    try:
        return datetime.fromtimestamp(time_s, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    except (ValueError, OverflowError, OSError):
        return f"{time_s} s"


def _degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.4f} deg"


def _metres(length_m: float) -> str:
    return f"{length_m:.1f} m"
