"""What a model can be asked to fly: limits measured by trimming it, which planner and guidance keep to."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from aircraft.errors import ModelError

_STEP = 1.08  # of airspeed, on the way out to a limit
_STEPS_MAX = 24  # airspeeds of 1/6 to 6 times cruise
_TOLERANCE_MPS = 0.05
_ROUND_MPS = 0.1
_LOW_FUEL = 0.01  # an empty tank stops the engine


@dataclass(frozen=True, slots=True)
class Envelope:
    """Limits in still air between sea level and `ceiling_m`, at any state of fuel.

    Airspeeds are true airspeeds. The maximum airspeed and the climb at cruise leave some power in hand
    for turbulence, the descent at cruise as much to be taken off, the minimum airspeed some lift; a level
    turn at `bank_max_rad` is possible at all of them.
    """

    airspeed_min_mps: float
    airspeed_max_mps: float
    cruise_mps: float
    climb_max_mps: float
    descent_max_mps: float
    bank_max_rad: float
    ceiling_m: float


@dataclass(frozen=True, slots=True)
class Margins:
    """What is chosen, not measured.

    Attributes:
        cruise_mps: an airspeed well within the envelope; the sweep begins there.
        ceiling_m: greatest altitude.
        bank_max_rad: steepest turn.
        throttle_max: the rest is kept in hand.
        angle_of_attack_max_rad: the rest to the stall is kept in hand.
    """

    cruise_mps: float
    ceiling_m: float
    bank_max_rad: float
    throttle_max: float
    angle_of_attack_max_rad: float


class Condition(NamedTuple):
    """A steady flight to trim for: level or climbing, straight or in a coordinated turn."""

    airspeed_mps: float
    altitude_m: float
    fuel_share: float = 1.0
    bank_rad: float = 0.0
    climb_mps: float = 0.0

    def __str__(self) -> str:
        bank = f", {math.degrees(self.bank_rad):.0f}° of bank" if self.bank_rad else ""
        climb = f", {self.climb_mps:.1f} m/s of climb" if self.climb_mps else ""
        return (
            f"{self.airspeed_mps:.1f} m/s, {self.altitude_m:.0f} m, "
            f"{'full' if self.fuel_share == 1.0 else 'empty'} tank{bank}{climb}"
        )


class Trimmed(NamedTuple):
    """What a steady flight takes."""

    angle_of_attack_rad: float
    throttle: float
    fuel_flow_kgps: float


Trim = Callable[[Condition], Trimmed | None]
"""Trims a model; None if it cannot fly so."""


def measure_envelope(trim: Trim, margins: Margins, model: str) -> Envelope:
    """Sweep the trims of a model and find how far they hold with the margins.

    At every combination of sea level and ceiling, full and empty tank, straight flight and a turn at the
    greatest bank, the range of airspeeds that hold is taken to be one interval with cruise in it; its ends
    are found by bisection, and the envelope is what all combinations have in common, rounded inward to
    0.1 m/s. Climb and descent are the greatest at cruise.

    Raises:
        ModelError: if cruise itself does not hold, with the reason.
    """
    corners = list(_corners(margins))
    for corner in corners:
        if reason := shortfall(trim, margins, corner):
            raise ModelError(
                f"the model {model!r} cannot fly its cruise with the margins asked for ({corner}): {reason}; "
                "change cruise_mps, or lower ceiling_m, bank_max_deg or the margins in hand"
            )
    slowest = _farthest(trim, margins, corners, "airspeed_mps", lambda value: value / _STEP)
    fastest = _farthest(trim, margins, corners, "airspeed_mps", lambda value: value * _STEP)
    straight = [corner for corner in corners if not corner.bank_rad]
    climb = _farthest(trim, margins, straight, "climb_mps", lambda value: value + 1.0)
    descent = -_farthest(trim, margins, straight, "climb_mps", lambda value: value - 1.0)
    return Envelope(
        airspeed_min_mps=round(math.ceil(slowest / _ROUND_MPS) * _ROUND_MPS, 1),
        airspeed_max_mps=round(math.floor(fastest / _ROUND_MPS) * _ROUND_MPS, 1),
        cruise_mps=margins.cruise_mps,
        climb_max_mps=round(math.floor(climb / _ROUND_MPS) * _ROUND_MPS, 1),
        descent_max_mps=round(math.floor(descent / _ROUND_MPS) * _ROUND_MPS, 1),
        bank_max_rad=margins.bank_max_rad,
        ceiling_m=margins.ceiling_m,
    )


def shortfall(trim: Trim, margins: Margins, condition: Condition) -> str:
    """Why a condition is outside the envelope; empty if it is inside."""
    trimmed = trim(condition)
    if trimmed is None:
        return "it does not trim"
    if trimmed.throttle > margins.throttle_max:
        return f"throttle {trimmed.throttle:.2f} of {margins.throttle_max:.2f}"
    if condition.climb_mps < 0.0 and trimmed.throttle < 1.0 - margins.throttle_max:
        return f"throttle {trimmed.throttle:.2f}, of which {1.0 - margins.throttle_max:.2f} is kept in hand"
    if trimmed.angle_of_attack_rad > margins.angle_of_attack_max_rad:
        return (
            f"angle of attack {math.degrees(trimmed.angle_of_attack_rad):.1f}° of "
            f"{math.degrees(margins.angle_of_attack_max_rad):.1f}°"
        )
    return ""


def _corners(margins: Margins) -> Iterator[Condition]:
    """The combinations at cruise; first the one that mostly decides."""
    for bank_rad in (margins.bank_max_rad, 0.0):
        for altitude_m in (margins.ceiling_m, 0.0):
            for fuel_share in (1.0, _LOW_FUEL):
                yield Condition(margins.cruise_mps, altitude_m, fuel_share, bank_rad)


def _farthest(
    trim: Trim, margins: Margins, corners: list[Condition], name: str, onward: Callable[[float], float]
) -> float:
    """How far a value can go from that of the corners, all of which hold, until one does not.

    A corner that holds at the others' limit costs one trim.
    """

    def holds(corner: Condition, value: float) -> bool:
        return not shortfall(trim, margins, corner._replace(**{name: value}))

    first, *others = corners
    begin: float = getattr(first, name)
    inside, outside = begin, onward(begin)
    for _ in range(_STEPS_MAX):
        if not holds(first, outside):
            break
        inside, outside = outside, onward(outside)
    limit = _bisect(lambda value: holds(first, value), inside, outside)
    for corner in others:
        if not holds(corner, limit):
            limit = _bisect(lambda value, corner=corner: holds(corner, value), begin, limit)  # type: ignore[misc]
    return limit


def _bisect(holds: Callable[[float], bool], inside: float, outside: float) -> float:
    """The last value found inside, within `_TOLERANCE_MPS` of one outside."""
    while abs(outside - inside) > _TOLERANCE_MPS:
        middle = 0.5 * (inside + outside)
        if holds(middle):
            inside = middle
        else:
            outside = middle
    return inside
