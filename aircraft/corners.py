"""How a path goes round a corner with bounded curvature: a fillet, or a bulb through the waypoint.

Curvature jumps where an arc begins; it does not grow at a constant rate. Guidance knows of it by the time
that the bank takes ahead (`aircraft.guidance`). What the jump leaves is a third of a metre of the largest
error in smooth air, and nothing of its 95th percentile, or of either in turbulence (docs/benchmarks.md).
Clothoids would take longer tangents and cut corners further for that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

BULB_FROM_RAD = math.radians(120.0)
"""Sharper turns than this are flown as bulbs: a fillet's tangents would grow without limit."""

_STRAIGHT_RAD = 1e-8


@dataclass(frozen=True, slots=True)
class Corner:
    """A turn, symmetric about the point where it passes the waypoint.

    `arcs`: (curvature, length) of the first half, in the order flown; the second half is its mirror image.
    `tangent_m`: where it begins before the waypoint and ends behind it, along the legs.
    `cut_m`: how far from the waypoint it passes. `radius_m`: of its arcs. `right`: the sense of its last
    half and of a loiter there. One unit of length throughout.
    """

    arcs: tuple[tuple[float, float], ...]
    tangent_m: float
    cut_m: float
    radius_m: float
    right: bool


def fillet(turn_rad: float, radius_m: float, tangent_max_m: float) -> Corner:
    """The circle tangent to both legs, which cuts the corner by r (1/cos(turn/2) - 1).

    Args:
        turn_rad: change of course, right positive.
        radius_m: wanted; smaller where the tangents would be longer than `tangent_max_m`.
        tangent_max_m: how much of the legs may be used.
    """
    half_rad = abs(turn_rad) / 2.0
    if half_rad < _STRAIGHT_RAD:
        return Corner((), 0.0, 0.0, radius_m, right=True)
    tangent = math.tan(half_rad)
    radius_m = min(radius_m, tangent_max_m / tangent)
    curvature = math.copysign(1.0 / radius_m, turn_rad)
    cut_m = radius_m * (1.0 / math.cos(half_rad) - 1.0)
    return Corner(((curvature, radius_m * half_rad),), radius_m * tangent, cut_m, radius_m, turn_rad > 0.0)


def bulb(turn_rad: float, radius_m: float, tangent_max_m: float) -> Corner:
    """A circle through the waypoint, reached and left by arcs of the opposite turn.

    The circle's centre lies on the bisector of the legs, c = cos(turn/2) radii beside each; so an opposite
    circle of the same radius touches the leg and the circle after turning phi, cos(phi) = (1 + c)/2. Without
    a change of course that is the circle tangent to the leg at the waypoint, to the right; for a reversal
    it is the shortest curve back onto the same line, 60, 300 and 60 degrees (Dubins 1957).

    Args:
        turn_rad: change of course, right positive.
        radius_m: wanted; smaller where the tangents would be longer than `tangent_max_m`.
        tangent_max_m: how much of the legs may be used.
    """
    half_rad = abs(turn_rad) / 2.0
    cosine = math.cos(half_rad)
    tangent = math.sin(half_rad) + math.sqrt((3.0 + cosine) * (1.0 - cosine))
    if tangent * radius_m > tangent_max_m:
        radius_m = tangent_max_m / tangent
    right = turn_rad > -_STRAIGHT_RAD
    curvature = 1.0 / radius_m if right else -1.0 / radius_m
    away_rad = math.acos((1.0 + cosine) / 2.0)
    arcs = ((-curvature, radius_m * away_rad), (curvature, radius_m * (away_rad + half_rad)))
    return Corner(arcs, tangent * radius_m, 0.0, radius_m, right)


def corner(turn_rad: float, radius_m: float, tangent_max_m: float) -> Corner:
    """A fillet, or for sharp turns a bulb; see there."""
    shape = fillet if abs(turn_rad) <= BULB_FROM_RAD else bulb
    return shape(turn_rad, radius_m, tangent_max_m)
