"""Hazard and flyability, stage by stage, from a wind field: what the search may enter and how it may move."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from planner.errors import BadFieldError
from planner.grid import Grid
from planner.windfield import FieldArray, WindField

Bools = NDArray[np.bool_]


class Move(IntEnum):
    """What can be done in one step; the codes are those kept as parents by the search."""

    STAY = 0
    NORTH = 1
    SOUTH = 2
    EAST = 3
    WEST = 4


OFFSETS: dict[Move, tuple[int, int]] = {
    Move.STAY: (0, 0),
    Move.NORTH: (1, 0),
    Move.SOUTH: (-1, 0),
    Move.EAST: (0, 1),
    Move.WEST: (0, -1),
}
"""Rows northward and columns eastward of each move."""


@dataclass(frozen=True, slots=True)
class StageClock:
    """Times of the planner: `stage_count` stages of `steps_per_stage` steps of `step_s` seconds."""

    departure_s: float
    stage_count: int = 18
    steps_per_stage: int = 30
    step_s: float = 120.0

    def __post_init__(self) -> None:
        if self.stage_count < 1 or self.steps_per_stage < 1 or not self.step_s > 0.0:
            raise BadFieldError(
                f"{self.stage_count} stages of {self.steps_per_stage} steps of {self.step_s} s: "
                "each must be positive"
            )

    @property
    def stage_s(self) -> float:
        """Length of a stage [s]."""
        return self.steps_per_stage * self.step_s

    @property
    def step_count(self) -> int:
        """Steps in the horizon; the last one is `step_count - 1`."""
        return self.stage_count * self.steps_per_stage

    def stage_of_step(self, step: int) -> int:
        """The stage that contains a step."""
        return step // self.steps_per_stage

    def stage_at(self, time_s: float) -> int:
        """The stage that contains a time since departure [s], the first or last one outside the horizon."""
        return min(max(int(time_s // self.stage_s), 0), self.stage_count - 1)

    def span_s(self, stage: int) -> tuple[float, float]:
        """Beginning and end of a stage, seconds since 1970."""
        begin_s = self.departure_s + stage * self.stage_s
        return begin_s, begin_s + self.stage_s


def sheets(wind: WindField, clock: StageClock, stage: int) -> Iterator[tuple[FieldArray, FieldArray]]:
    """The wind (north, east) [north, east] at every time that decides a stage.

    These are its two ends and each time of the field between them. Wind is linear in time between them and
    speed is a convex function of wind, so nowhere in the stage is a cell's speed above the largest of these.
    """
    begin_s, end_s = clock.span_s(stage)
    inside = wind.time_s[(wind.time_s > begin_s) & (wind.time_s < end_s)]
    for time_s in (begin_s, *inside.tolist(), end_s):
        yield wind.sheet(time_s)


def hazard_stages(wind: WindField, clock: StageClock, *, threshold_mps: float, corridor_m: float) -> Bools:
    """Cells near which the wind exceeds the threshold at any time of a stage.

    Args:
        wind: two-dimensional field on the planner's grid, toward [m/s].
        clock: the stages.
        threshold_mps: wind speed above which a cell is hazardous [m/s].
        corridor_m: half width of the room that the aircraft needs [m], less than one cell.

    Returns:
        Hazard matrices, shape [stage, north, east].
    """
    return strongest_mps(wind, clock, corridor_m=corridor_m) > threshold_mps


def strongest_mps(wind: WindField, clock: StageClock, *, corridor_m: float) -> FieldArray:
    """The largest wind speed in each cell's room at any time of each stage [m/s], [stage, north, east].

    A cell's room is the square reaching `corridor_m` from its centre to each side; with strict occupancy the
    whole corridor of that half width around every move is then no windier than its two cells. (Wind is
    bilinear between cell centres, so on the quarter squares between a centre and its room's corners it is a
    blend of nine values, and speed, being convex, is largest at one of the nine.)

    Args:
        wind: two-dimensional field on the planner's grid, toward [m/s].
        clock: the stages.
        corridor_m: half width of the room that the aircraft needs [m], less than one cell.
    """
    return np.stack(
        [
            np.maximum.reduce(
                [
                    largest_in_room(north, east, wind.grid, corridor_m=corridor_m)
                    for north, east in sheets(wind, clock, stage)
                ]
            )
            for stage in range(clock.stage_count)
        ]
    )


def largest_in_room(north: FieldArray, east: FieldArray, grid: Grid, *, corridor_m: float) -> FieldArray:
    """The largest wind speed in each cell's room in one sheet of wind [m/s], shape [north, east].

    Args:
        north: component toward north [m/s], shape [north, east].
        east: component toward east.
        grid: theirs.
        corridor_m: see `strongest_mps`.

    Raises:
        BadFieldError: if the corridor does not fit the cells.
    """
    smallest_cell_m = float(min(grid.north_cell_m.min(), grid.east_cell_m.min()))
    if not 0.0 <= corridor_m < smallest_cell_m:
        raise BadFieldError(
            f"a corridor of {corridor_m:.0f} m does not fit cells of {smallest_cell_m:.0f} m; "
            "choose 0 to one cell"
        )
    north_share = corridor_m / float(grid.north_cell_m.min())
    east_share = corridor_m / float(grid.east_cell_m.min())
    largest = np.zeros_like(north)
    for row_offset in (0, 1, -1):
        for column_offset in (0, 1, -1):
            shifted = [
                _blend(_blend(part, row_offset, north_share, 0), column_offset, east_share, 1)
                for part in (north, east)
            ]
            np.maximum(largest, np.hypot(*shifted), out=largest)
    return largest


def _blend(values: FieldArray, offset: int, share: float, axis: int) -> FieldArray:
    """Values at a share of a cell toward the neighbour, the outermost cells kept as they are."""
    if offset == 0 or share == 0.0:
        return values
    return values + np.float32(share) * (neighbour(values, offset, axis) - values)


def neighbour(values: FieldArray, offset: int, axis: int) -> FieldArray:
    """The value one cell on in an axis; the outermost cell repeats."""
    index = np.clip(np.arange(values.shape[axis]) + offset, 0, values.shape[axis] - 1)
    return values.take(index, axis=axis)


def flyable_moves(
    wind: WindField, clock: StageClock, *, airspeed_min_mps: float, airspeed_max_mps: float
) -> Bools:
    """Moves that the aircraft can make in one step in each stage's wind.

    The wind triangle gives the true airspeed that the move asks for, |ground velocity - wind|; it must lie
    within the envelope at both cells and at every time that decides the stage. Staying, a loiter, is always
    flyable where it is safe.

    Returns:
        Shape [stage, move, north, east], by the cell that the move leaves; moves off the grid are False.
    """
    grid = wind.grid
    flyable = np.zeros((clock.stage_count, len(Move), *grid.shape), dtype=np.bool_)
    flyable[:, Move.STAY] = True
    ground_north, ground_east = (
        (cell_m / clock.step_s).astype(np.float32)[:, None]
        for cell_m in (grid.north_cell_m, grid.east_cell_m)
    )
    ground_south = np.roll(ground_north, 1, axis=0)
    still = np.zeros_like(ground_east)
    ground = {
        Move.NORTH: (ground_north, still),
        Move.SOUTH: (-ground_south, still),
        Move.EAST: (still, ground_east),
        Move.WEST: (still, -ground_east),
    }
    for stage in range(clock.stage_count):
        winds = list(sheets(wind, clock, stage))
        for move, (north_mps, east_mps) in ground.items():
            within = np.ones(grid.shape, dtype=np.bool_)
            rows, columns = OFFSETS[move]
            for north, east in winds:
                here = np.hypot(north_mps - north, east_mps - east)
                axis, offset = (0, rows) if rows else (1, columns)
                there = np.hypot(
                    north_mps - neighbour(north, offset, axis), east_mps - neighbour(east, offset, axis)
                )
                within &= np.minimum(here, there) >= airspeed_min_mps
                within &= np.maximum(here, there) <= airspeed_max_mps
            flyable[stage, move] = within
        flyable[stage, Move.NORTH, -1] = flyable[stage, Move.SOUTH, 0] = False
        flyable[stage, Move.EAST, :, -1] = flyable[stage, Move.WEST, :, 0] = False
    return flyable


def clearance_cells(hazard: Bools, cap_cells: float) -> NDArray[np.float64]:
    """Distance from each cell to the nearest hazardous one of its stage, in cells, at most the cap.

    Args:
        hazard: shape [stage, north, east].
        cap_cells: what a cell far from any hazard counts as; without hazard the distance is infinite.

    Returns:
        Shape [stage, north, east], 0 in hazardous cells.
    """
    clearance = np.full(hazard.shape, float(cap_cells))
    for stage, cells in enumerate(hazard):
        if cells.any():
            np.minimum(ndimage.distance_transform_edt(~cells), cap_cells, out=clearance[stage])
    return clearance


def clearance_m(grid: Grid, hazard: Bools) -> NDArray[np.float64]:
    """True distance from each cell's centre to that of the nearest hazardous one [m].

    Args:
        grid: the grid.
        hazard: one stage, shape [north, east].

    Returns:
        Shape [north, east], 0 in hazardous cells, infinite where there is no hazard at all.
    """
    if not hazard.any():
        return np.full(hazard.shape, np.inf)
    middle = grid.rows // 2
    rows, columns = ndimage.distance_transform_edt(
        ~hazard,
        sampling=(float(grid.north_cell_m[middle]), float(grid.east_cell_m[middle])),
        return_distances=False,
        return_indices=True,
    )
    own_rows, own_columns = np.indices(grid.shape)
    north_m = (rows - own_rows) * grid.north_cell_m[(rows + own_rows) // 2]
    east_m = (columns - own_columns) * grid.east_cell_m[(rows + own_rows) // 2]
    return np.asarray(np.hypot(north_m, east_m), dtype=np.float64)
