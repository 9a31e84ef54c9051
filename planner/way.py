"""A way: the nodes that a search finds, and the straight legs that are flown."""

from __future__ import annotations

from dataclasses import dataclass

Cell = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Node:
    """A cell on the way, when it is reached and left, and the run of safe stages around [s since departure].

    The last one is not left: its `leave_s` is infinite.
    """

    cell: Cell
    arrive_s: float
    leave_s: float
    safe_from_s: float
    safe_until_s: float


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight leg, when it is left and ended [s since departure], and the true airspeed on it."""

    start: Cell
    end: Cell
    leave_s: float
    arrive_s: float
    airspeed_mps: float
