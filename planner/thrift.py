"""The airspeeds that burn least along given legs: slow before a wait, and each leg's own best without one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner.consumption import FuelFlow
from planner.legs import Country, are_safe, fly, lay_legs
from planner.waits import with_flyable_waits
from planner.way import Leg
from planner.windfield import Floats

_TRIED = 12  # airspeeds for each leg


def with_thrifty_speeds(
    country: Country,
    legs: Sequence[Leg],
    flow: FuelFlow,
    *,
    slowest_mps: float,
    fastest_mps: float,
    wait_min_s: float,
) -> list[Leg] | None:
    """The same lines at airspeeds that burn less.

    Who has to wait for hazard to lift comes to that place as late as possible, at the airspeed of the least
    flow. After the last wait each leg is flown at that airspeed by which it burns least: faster against the
    wind than with it.

    Args:
        country: what the legs are flown through.
        legs: in the order flown, with flyable waits.
        flow: the aircraft's consumption.
        slowest_mps: least true airspeed.
        fastest_mps: greatest.
        wait_min_s: of a loiter.

    Returns:
        Legs that are safe at their new times; None if there are no such.
    """
    unhurried = with_flyable_waits(
        country,
        legs,
        slowest_mps=flow.thriftiest(slowest_mps, fastest_mps),
        wait_min_s=wait_min_s,
        unhurried=True,
    )
    if unhurried is None:
        return None
    waited = [at for at in range(1, len(legs)) if legs[at].leave_s > legs[at - 1].arrive_s]
    free = waited[-1] if waited else 0
    flown = unhurried[:free]
    now_s = unhurried[free].leave_s if unhurried else 0.0
    for leg in unhurried[free:]:
        best = _thriftiest(country, leg, now_s, flow, np.linspace(slowest_mps, fastest_mps, _TRIED))
        if best is None:
            return unhurried
        flown.append(best)
        now_s = best.arrive_s
    return flown


def _thriftiest(
    country: Country, leg: Leg, leave_s: float, flow: FuelFlow, airspeeds_mps: Floats
) -> Leg | None:
    """The leg at another time, at the airspeed that burns least of those at which it is safe."""
    speeds_mps = np.append(airspeeds_mps, leg.airspeed_mps)
    ends = (np.full(speeds_mps.size, index) for index in leg.end)
    legs = lay_legs(country.chart, leg.start, *ends)
    time_s = fly(country, legs, leave_s, speeds_mps[:, np.newaxis])
    burned_kg = flow.at(speeds_mps) * (time_s[:, -1] - leave_s)
    burned_kg[~are_safe(country, legs, time_s)] = np.inf
    best = int(burned_kg.argmin())
    if not np.isfinite(burned_kg[best]):
        return None
    return Leg(leg.start, leg.end, leave_s, float(time_s[best, -1]), float(speeds_mps[best]))
