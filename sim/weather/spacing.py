"""Rows or columns that are nearly evenly spaced, as on Mercator and Gaussian grids, made even."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.errors import WeatherError

Floats = NDArray[np.float64]
FieldArray = NDArray[np.float32] | NDArray[np.float64]

_REGULAR = 1e-3  # nodes this share of a step off even spacing are taken for even
_MOST_STRETCH = 1.25  # steps may differ by this factor


def is_even(nodes: Floats) -> bool:
    """Whether nodes are evenly spaced as they are."""
    even = np.linspace(nodes[0], nodes[-1], nodes.size)
    return nodes.size > 1 and bool(np.abs(nodes - even).max() <= _REGULAR * np.diff(nodes).max())


def evenly_spaced(
    parts: list[FieldArray], nodes: Floats, *, axis: int, name: str
) -> tuple[list[FieldArray], Floats]:
    """Values on as many evenly spaced nodes, by linear interpolation where they are not even already.

    Args:
        parts: arrays whose `axis` runs along the nodes.
        nodes: rising [deg].
        axis: counted from the end, negative.
        name: of the nodes, for messages.

    Raises:
        WeatherError: if there are less than two, or steps differ by more than a quarter.
    """
    steps = np.diff(nodes)
    if nodes.size < 2 or not steps.min() * _MOST_STRETCH >= steps.max() > 0.0:
        detail = f"steps from {steps.min():.5g} to {steps.max():.5g} deg" if steps.size else "one value"
        raise WeatherError(
            f"its {name} has {detail}, but a grid needs two values or more and steps that differ by less "
            "than a "
            "quarter; regrid it to a regular latitude-longitude grid"
        )
    even = np.linspace(nodes[0], nodes[-1], nodes.size)
    if is_even(nodes):
        return parts, even
    place = np.interp(even, nodes, np.arange(nodes.size, dtype=np.float64))
    first = np.minimum(place.astype(np.intp), nodes.size - 2)
    weight = (place - first).reshape([-1] + [1] * (-axis - 1))

    def moved(values: FieldArray) -> FieldArray:
        low, high = (np.take(values, first + step, axis=axis) for step in (0, 1))
        mixed: FieldArray = ((1.0 - weight) * low + weight * high).astype(values.dtype)
        return mixed

    return [moved(part) for part in parts], even
