"""A small fixed-wing UAV made of triangles: pod, high wing, two booms, inverted V-tail, pusher propeller.

Axes: forward, left, up; the span is one, and the origin lies under the middle of the wing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Colour = tuple[int, int, int]

_WHITE, _GREY, _DARK = (236, 240, 246), (176, 184, 196), (96, 104, 118)
_PORT, _STARBOARD = (235, 70, 60), (60, 200, 110)

_POD = ((0.27, 0.012), (0.21, 0.036), (0.06, 0.05), (-0.08, 0.042), (-0.13, 0.022))
"""Stations of the pod, forward, and its radius there."""
_WING = ((-0.42, 0.045, 0.08), (0.0, 0.03, 0.1), (0.42, 0.045, 0.08))
"""Sections of the wing: right of the middle, height, chord."""
_WING_TIP = ((0.42, 0.045, 0.08), (0.5, 0.05, 0.07))
_BOOM = (0.06, -0.42)
"""Ends, forward."""
_PROPELLER = (-0.145, -0.155)
"""Faces of its disc, forward."""


class Mesh(NamedTuple):
    """Triangles, counterclockwise seen from outside. `corners`: shape (n, 3, 3). `colours`: (n, 3)."""

    corners: Floats
    colours: NDArray[np.uint8]

    @property
    def normals(self) -> Floats:
        """Outward and of length one, shape (n, 3)."""
        first, second, third = self.corners.transpose(1, 0, 2)
        across = np.cross(second - first, third - first)
        outward: Floats = across / np.linalg.norm(across, axis=1, keepdims=True)
        return outward


def aircraft_mesh() -> Mesh:
    """The whole aircraft, each part of it closed."""
    tail = [_section(0.12 * side, 0.035 + 0.095 * (side == 0), 0.07, back=0.39) for side in (-1, 0, 1)]
    parts = [
        (_loft([_ring(0.0, forward, -0.02, radius, 6) for forward, radius in _POD]), _WHITE),
        (_loft([_section(side, up, chord) for side, up, chord in _WING]), _GREY),
        (_loft([_section(-side, up, chord) for side, up, chord in _WING_TIP]), _PORT),
        (_loft([_section(side, up, chord) for side, up, chord in _WING_TIP]), _STARBOARD),
        (_loft([_ring(-0.12, forward, 0.03, 0.009, 4) for forward in _BOOM]), _GREY),
        (_loft([_ring(0.12, forward, 0.03, 0.009, 4) for forward in _BOOM]), _GREY),
        (_loft(tail), _WHITE),
        (_loft([_ring(0.0, forward, -0.02, 0.085, 8) for forward in _PROPELLER]), _DARK),
    ]
    colours = np.concatenate([np.tile(np.array(colour, np.uint8), (len(part), 1)) for part, colour in parts])
    return Mesh(np.concatenate([part for part, _ in parts]), colours)


def _ring(right: float, forward: float, up: float, radius: float, sides: int) -> Floats:
    """A regular polygon across the direction of flight."""
    angle_rad = 2.0 * math.pi * (np.arange(sides) + 0.5) / sides
    return np.column_stack(
        [np.full(sides, forward), -right - radius * np.cos(angle_rad), up + radius * np.sin(angle_rad)]
    )


def _section(right: float, up: float, chord: float, back: float = 0.0) -> Floats:
    """A diamond along the direction of flight: a wing's leading edge, top, trailing edge and bottom."""
    thickness, lead = 0.09 * chord, chord / 2.0 - back
    forward = np.array([lead, lead - 0.35 * chord, lead - chord, lead - 0.35 * chord])
    return np.column_stack(
        [forward, np.full(4, -right), up + np.array([0.0, thickness, 0.0, -thickness / 2.0])]
    )


def _loft(rings: Sequence[Floats]) -> Floats:
    """The closed surface through rings of as many points each, as triangles."""
    triangles = []
    for ring, following in pairwise(rings):
        for point, after, beyond, beside in zip(
            ring, np.roll(ring, -1, 0), np.roll(following, -1, 0), following, strict=True
        ):
            triangles += [(point, after, beyond), (point, beyond, beside)]
    first, last = rings[0], rings[-1]
    for i in range(1, len(first) - 1):
        triangles += [(first[0], first[i + 1], first[i]), (last[0], last[i], last[i + 1])]
    corners = np.array(triangles)
    return corners if _volume(corners) > 0.0 else corners[:, ::-1]


def _volume(corners: Floats) -> float:
    """Of what triangles enclose, positive if they are counterclockwise from outside."""
    first, second, third = corners.transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", first, np.cross(second, third)) / 6.0)
