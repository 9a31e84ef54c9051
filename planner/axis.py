"""One axis of gridded data: between which two nodes a value lies, and how far along."""

from __future__ import annotations

import sys
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.errors import BadFieldError, OutsideFieldError

Floats = NDArray[np.float64]

_new_tuple = tuple.__new__  # makes a named tuple of a tuple in a third of the time of its constructor

EVERYWHERE = sys.float_info.max / 4.0
"""A margin that no value exceeds, yet finite, so that differences stay numbers."""


class Span(NamedTuple):
    """A stretch of an axis in which interpolation uses the same two nodes.

    The second node's weight at a value v in [`low`, `high`] is (v - `low`) * `inverse`. Beyond an end both
    nodes are the outermost one and `inverse` is zero: the outermost value holds.
    """

    first: int
    second: int
    low: float
    high: float
    inverse: float


@dataclass(frozen=True, eq=False)
class Axis:
    """Rising nodes, and how far beyond the first and the last one a value may lie.

    `name`: of the axis, for messages. `nodes`: float64, shape (n,). `margin`: in the unit of the nodes.
    `describe`: a value in words. `remedy`: what to do about a value that lies outside.
    """

    name: str
    nodes: Floats
    margin: float
    describe: Callable[[float], str]
    remedy: str

    def __post_init__(self) -> None:
        if self.nodes.ndim != 1 or self.nodes.size == 0:
            raise BadFieldError(
                f"{self.name} needs a row of values, not an array of shape {self.nodes.shape}"
            )
        rising = np.diff(self.nodes) > 0.0
        if not (np.isfinite(self.nodes).all() and rising.all()):
            place = (
                int(np.argmin(rising)) + 1 if not rising.all() else int(np.argmin(np.isfinite(self.nodes)))
            )
            raise BadFieldError(
                f"{self.name} must be finite and rise from value to value, but number {place} "
                f"({float(self.nodes[place])!r}) does not; sort the data and drop doubled values"
            )

    @cached_property
    def _values(self) -> list[float]:
        return [float(node) for node in self.nodes]

    @cached_property
    def limits(self) -> tuple[float, float]:
        """The lowest and the highest value that may be asked for."""
        return self._values[0] - self.margin, self._values[-1] + self.margin

    def span(self, value: float) -> Span:
        """The span around a value.

        Raises:
            OutsideFieldError: if the value lies outside the limits, or is not a number.
        """
        nodes, last = self._values, len(self._values) - 1
        lowest, highest = self.limits
        if not lowest <= value <= highest:
            raise self._outside(value)
        if value < nodes[0]:
            return Span(0, 0, lowest, nodes[0], 0.0)
        if last == 0 or value > nodes[last]:
            return Span(last, last, nodes[last], highest, 0.0)
        return self.after(min(bisect_right(nodes, value) - 1, last - 1))

    def after(self, first: int) -> Span:
        """The span from a node to the next one."""
        nodes = self._values
        low, high = nodes[first], nodes[first + 1]
        return _new_tuple(Span, (first, first + 1, low, high, 1.0 / (high - low)))

    def spread(self, values: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats]:
        """First node, second node and weight of the second, for many values; each of the values' shape.

        Raises:
            OutsideFieldError: if any value lies outside the limits, or is not a number.
        """
        lowest, highest = self.limits
        inside = (values >= lowest) & (values <= highest)
        if not inside.all():
            raise self._outside(float(values.ravel()[np.argmin(inside)]))
        last = len(self.nodes) - 1
        place = np.interp(values, self.nodes, np.arange(last + 1.0))
        first = np.minimum(place.astype(np.intp), max(last - 1, 0))
        return first, np.minimum(first + 1, last), place - first

    def _outside(self, value: float) -> OutsideFieldError:
        return OutsideFieldError(
            f"wind was asked for at {self.name} {self.describe(value)}, but the field covers "
            f"{self.describe(self._values[0])} to {self.describe(self._values[-1])}; {self.remedy}"
        )
