"""Waits that can be flown: aircraft wait in whole loiter laps, so a short wait is flown as slower legs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner.legs import Country, are_safe, fly, lay_legs
from planner.way import Leg

_CLOSE_S = 0.01
_HALVINGS = 40


def with_flyable_waits(
    country: Country,
    legs: Sequence[Leg],
    *,
    slowest_mps: float,
    wait_min_s: float,
    unhurried: bool = False,
) -> list[Leg] | None:
    """Legs whose waits, between the end of one and the start of the next, are none or long enough.

    A wait that is too short is spread over the legs since the wait before, as far as the slowest airspeed
    allows; else it is made as long as it has to be, and what follows is later.

    Args:
        country: what the legs are flown through.
        legs: in the order flown, the first from the country's begin on.
        slowest_mps: least true airspeed.
        wait_min_s: of a loiter.
        unhurried: whether long waits are spread over the legs before them too, as far as that goes.

    Returns:
        Legs along the same lines, safe at their new times; None if there are no such.
    """
    flown: list[Leg] = []
    planned_s = now_s = country.begin_s
    since_wait = 0
    for leg in legs:
        if leg.leave_s > max(now_s, planned_s):
            slower = None
            if unhurried or leg.leave_s - now_s < wait_min_s:
                slower = arriving_at(country, flown[since_wait:], leg.leave_s, slowest_mps)
            if slower:
                flown[since_wait:] = slower
                now_s = slower[-1].arrive_s
            else:
                if unhurried:
                    slower = _before(country, flown[since_wait:], leg.leave_s - wait_min_s, slowest_mps)
                    flown[since_wait:] = slower or flown[since_wait:]
                    now_s = flown[-1].arrive_s if flown else now_s
                leave_s = max(leg.leave_s, now_s + wait_min_s)
                if not _can_wait(country, leg, now_s, leave_s):
                    return None
                now_s = leave_s
                since_wait = len(flown)
        again, safe = _flown(country, leg, now_s, leg.airspeed_mps)
        if not safe:
            return None
        flown.append(again)
        planned_s, now_s = leg.arrive_s, again.arrive_s
    return flown


def _flown(country: Country, leg: Leg, leave_s: float, airspeed_mps: float) -> tuple[Leg, bool]:
    """The leg at another time and airspeed, and whether it is safe then."""
    legs = lay_legs(country.chart, leg.start, *(np.array([index]) for index in leg.end))
    time_s = fly(country, legs, leave_s, airspeed_mps)
    again = Leg(leg.start, leg.end, leave_s, float(time_s[0, -1]), airspeed_mps)
    return again, bool(are_safe(country, legs, time_s)[0])


def _chain(country: Country, legs: Sequence[Leg], airspeed_mps: float) -> tuple[list[Leg], bool]:
    """Legs without waits between them, all at one airspeed, from the time at which the first was left."""
    flown: list[Leg] = []
    all_safe = True
    for leg in legs:
        again, safe = _flown(country, leg, flown[-1].arrive_s if flown else leg.leave_s, airspeed_mps)
        flown.append(again)
        all_safe &= safe
    return flown, all_safe


def arriving_at(
    country: Country, legs: Sequence[Leg], arrive_s: float, slowest_mps: float
) -> list[Leg] | None:
    """Legs slowed down so that they end at a time (or within `_CLOSE_S` after it), if they can be."""
    if not legs:
        return None
    low_mps, high_mps = slowest_mps, legs[0].airspeed_mps
    slow, safe = _chain(country, legs, low_mps)
    if not slow[-1].arrive_s >= arrive_s:
        return None
    for _ in range(_HALVINGS):
        if slow[-1].arrive_s <= arrive_s + _CLOSE_S:
            break
        middle_mps = 0.5 * (low_mps + high_mps)
        tried, tried_safe = _chain(country, legs, middle_mps)
        if tried[-1].arrive_s >= arrive_s:
            low_mps, slow, safe = middle_mps, tried, tried_safe
        else:
            high_mps = middle_mps
    return slow if safe else None


def _before(country: Country, legs: Sequence[Leg], until_s: float, slowest_mps: float) -> list[Leg] | None:
    """Legs flown as slowly as possible so that they end before a time, if that is later than they do."""
    if not legs or legs[-1].arrive_s >= until_s:
        return None
    slow, safe = _chain(country, legs, slowest_mps)
    if slow[-1].arrive_s > until_s:
        return arriving_at(country, legs, until_s, slowest_mps)
    return slow if safe and slow[-1].arrive_s > legs[-1].arrive_s else None


def _can_wait(country: Country, leg: Leg, from_s: float, until_s: float) -> bool:
    """Whether a leg's start stays safe."""
    intervals = country.intervals
    first, last = (int(time_s // country.stage_s) for time_s in (from_s, until_s))
    if last >= len(intervals.run_end):
        return False
    return bool(intervals.run_end[first, intervals.place_of(*leg.start)] > last)
