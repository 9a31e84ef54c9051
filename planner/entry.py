"""From any place into the cells around it: straight passages to the centres that a search begins in."""

from __future__ import annotations

import math
from typing import NamedTuple

from planner.legs import Country, are_safe, fly
from planner.passage import Spot, lay_passage
from planner.way import Cell

_REACH = 1  # rows and columns beyond those around the place that a passage may lead to
_SHORTEST = 0.5  # of a cell: a corner takes up to half of a leg


class Entry(NamedTuple):
    """When a cell to begin a search in is reached, and how long the passage there is."""

    time_s: float
    length_m: float


def entries(
    country: Country, spot: Spot, shape: tuple[int, int], begin_s: float, airspeed_mps: float
) -> dict[Cell, Entry]:
    """The cells to which a safe passage leads, or the one in whose centre the place is.

    Args:
        country: what passages are flown through.
        spot: the place.
        shape: rows and columns of the grid.
        begin_s: when it is left, since departure.
        airspeed_mps: true airspeed.
    """
    if all(index == round(index) for index in spot):
        return {(round(spot[0]), round(spot[1])): Entry(begin_s, 0.0)}
    rows, columns = (
        range(max(math.floor(index) - _REACH, 0), min(math.ceil(index) + _REACH, size - 1) + 1)
        for index, size in zip(spot, shape, strict=True)
    )
    found = {}
    for cell in ((row, column) for row in rows for column in columns):
        if math.dist(cell, spot) < _SHORTEST:
            continue
        passage = lay_passage(country.chart, spot, cell)
        time_s = fly(country, passage, begin_s, airspeed_mps)
        if are_safe(country, passage, time_s)[0]:
            found[cell] = Entry(float(time_s[0, -1]), float(passage.length_m.sum()))
    return found
