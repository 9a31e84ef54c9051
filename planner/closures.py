"""Cells that are hazardous for another reason than the mean wind, joined with those of the wind."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planner.errors import BadFieldError
from planner.grid import Grid
from planner.ground import Cell
from planner.hazards import Bools
from planner.levels import stacked
from planner.survival import Survival, probability_from_forecast
from planner.windfield import FieldArray, Floats


@dataclass(frozen=True, slots=True, eq=False)
class MemberHazard:
    """Hazard of an ensemble's members, a bit a cell: fifty members of a day over a large grid are much.

    `bits`: packed along the last axis, shape [member, stage, north, bytes].
    """

    bits: NDArray[np.uint8]

    @classmethod
    def packed(cls, members: Iterable[Bools]) -> MemberHazard:
        """Of members [stage, north, east], one after the other."""
        return cls(np.stack([np.packbits(member, axis=-1) for member in members]))

    def survivors(self, visited: Iterable[tuple[int, Cell]]) -> int:
        """In how many members no (stage, cell) of a route is hazardous."""
        stages, cells = zip(*visited, strict=True)
        rows, columns = np.array(cells, dtype=np.intp).T
        held = self.bits[:, np.array(stages, dtype=np.intp), rows, columns // 8]
        met = (held >> (7 - columns % 8).astype(np.uint8)) & 1
        return int((~met.any(axis=1)).sum())

    def counted(self, chance: Survival, visited: Iterable[tuple[int, Cell]]) -> Survival:
        """A route's chance to survive, with the members that it survives in."""
        return replace(chance, members_survived=self.survivors(visited), members=len(self.bits))


@dataclass(frozen=True, slots=True, eq=False)
class Closures:
    """What a scenario calls hazardous besides wind over the threshold; a cell is so if any reason says so.

    Attributes:
        closed: hazardous for certain, shape [stage, north, east].
        chance: the probability that a cell is hazardous, of the same shape; None where none is known.
        members: hazard of an ensemble's members, in which routes are counted; None without one.

    Raises:
        BadFieldError: if shapes disagree, or a probability is not a number in [0, 1].
    """

    closed: Bools
    chance: Floats | None = None
    members: MemberHazard | None = None

    def __post_init__(self) -> None:
        if self.closed.ndim != 3 or self.closed.dtype != np.bool_:
            raise BadFieldError(
                f"closures of shape {self.closed.shape} and type {self.closed.dtype}; "
                "give booleans [stage, north, east]"
            )
        self.closed.setflags(write=False)
        if self.chance is None:
            return
        if self.chance.shape != self.closed.shape:
            raise BadFieldError(
                f"a chance of hazard of shape {self.chance.shape} does not fit closures of "
                f"{self.closed.shape}; bring both to one grid and one clock"
            )
        if not ((self.chance >= 0.0) & (self.chance <= 1.0)).all():
            raise BadFieldError("a chance of hazard is not a number between 0 and 1; clip or fill the field")
        self.chance.setflags(write=False)


def closures_at_levels(closures: Sequence[Closures]) -> Closures:
    """What is closed at each of some levels, the lowest first, in tall sheets (see `planner.levels`)."""
    chances = [one.chance for one in closures if one.chance is not None]
    members = [one.members.bits for one in closures if one.members is not None]
    return Closures(
        stacked(np.stack([one.closed for one in closures], axis=1), True),
        stacked(np.stack(chances, axis=1), 1.0) if chances else None,
        MemberHazard(stacked(np.stack(members, axis=2), 255)) if members else None,
    )


def joined(hazard: Bools, closures: Closures | None) -> Bools:
    """The hazard of the wind and of all else, shape [stage, north, east].

    Raises:
        BadFieldError: if the closures are of another grid or clock.
    """
    if closures is None:
        return hazard
    if closures.closed.shape != hazard.shape:
        raise BadFieldError(
            f"closures of shape {closures.closed.shape} do not fit hazard of {hazard.shape}; "
            "make them on the planner's grid, a sheet for each stage"
        )
    return hazard | closures.closed


def chance_of_hazard(
    speed_mps: FieldArray, *, threshold_mps: float, error_mps: float, closures: Closures | None
) -> Floats | None:
    """The probability that a cell is hazardous, shape [stage, north, east]; None if nothing is known of it.

    Where the forecast's error and an ensemble both tell of it, the larger of the two is taken: they are two
    estimates of one thing, and not two dangers.

    Args:
        speed_mps: forecast wind speed, shape [stage, north, east].
        threshold_mps: wind speed above which a cell is hazardous [m/s].
        error_mps: standard deviation of the forecast's error [m/s], 0 if it is taken as right.
        closures: what else there is.
    """
    known = None if closures is None else closures.chance
    if not error_mps:
        return known
    by_error = probability_from_forecast(
        speed_mps.astype(np.float64), threshold_mps=threshold_mps, error_mps=error_mps
    )
    return by_error if known is None else np.maximum(by_error, known)


def room_cells(grid: Grid, corridor_m: float) -> tuple[Floats, Floats]:
    """How far the room of a cell reaches from its centre, in cells north and east, by row: shape (rows,).

    To the edge of the cell, or as far as the corridor if that is wider. With strict occupancy the whole
    corridor around every move then lies in the rooms of its two cells (of a leg of any course: in those of
    the cells around it), so that what touches none of them does not touch the corridor.
    """
    return (
        np.maximum(0.5, corridor_m / grid.north_cell_m),
        np.maximum(0.5, corridor_m / grid.east_cell_m),
    )


def widened(cells: Bools, grid: Grid, corridor_m: float) -> Bools:
    """Cells whose room touches one that is hazardous as a whole, shape [stage, north, east].

    The same cells, unless the corridor is wider than half a cell.

    Args:
        cells: hazardous to their edges, shape [stage, north, east].
        grid: theirs.
        corridor_m: half width of the room that the aircraft needs [m], less than one cell and a half.
    """
    north, east = (reach > 0.5 for reach in room_cells(grid, corridor_m))
    wide = cells.copy()
    wide[:, 1:] |= cells[:, :-1] & north[1:, np.newaxis]
    wide[:, :-1] |= cells[:, 1:] & north[:-1, np.newaxis]
    beside = wide.copy()
    wide[:, :, 1:] |= beside[:, :, :-1] & east[:, np.newaxis]
    wide[:, :, :-1] |= beside[:, :, 1:] & east[:, np.newaxis]
    return wide
