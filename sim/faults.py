"""Faults put into a flight on purpose: what it has to come through, or to end at in good order."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from aircraft.jsbsim_aircraft import JsbsimAircraft
from sim.scenario import Fault, FaultKind

Wind = Callable[[float, float, float, float], tuple[float, float, float]]
"""(time [s], latitude [rad], longitude [rad], altitude [m]) -> wind north, east, down [m/s, toward]."""


_OF_WIND = (FaultKind.WIND_STEP, FaultKind.WIND_NAN)
_SEEN_AHEAD_S = 1.0  # the wind is looked at a round of guidance ahead, which is a second at most


def disturbed(wind: Wind, faults: Sequence[Fault], departure_s: float) -> Wind:
    """The wind with the faults that lie in it; the wind itself where there are none.

    Args:
        wind: the truth, its time in seconds since 1970-01-01 UTC.
        faults: of the flight; those of the aircraft are passed over.
        departure_s: when the faults' times begin, on the wind's clock.
    """
    steps = [fault for fault in faults if fault.kind in _OF_WIND]
    if not steps:
        return wind

    def with_steps(
        time_s: float, lat_rad: float, lon_rad: float, altitude_m: float
    ) -> tuple[float, float, float]:
        north, east, down = wind(time_s, lat_rad, lon_rad, altitude_m)
        for fault in steps:
            since_s = time_s - departure_s - fault.time_s
            if since_s >= 0.0 and fault.kind is FaultKind.WIND_NAN:
                return math.nan, math.nan, math.nan
            share = min(max(since_s / fault.duration_s, 0.0), 1.0)
            north += share * fault.north_mps
            east += share * fault.east_mps
        return north, east, down

    return with_steps


def strike(fault: Fault, aircraft: JsbsimAircraft) -> str:
    """Bring about a fault of the aircraft; what that was, in words. One of the wind lies in `disturbed`."""
    if fault.kind is FaultKind.WIND_STEP:
        return f"fault: the wind changes by {math.hypot(fault.north_mps, fault.east_mps):g} m/s"
    if fault.kind is FaultKind.WIND_NAN:
        return "fault: the wind becomes not a number"
    if fault.kind is FaultKind.ENGINE_FAILURE:
        aircraft.stop_engine()
        return "fault: the engine is stopped"
    if fault.kind is FaultKind.FUEL_LOSS:
        aircraft.drain_fuel(fault.fuel_kg)
        return f"fault: the fuel is drained to {fault.fuel_kg:g} kg"
    aircraft.drain_fuel(math.nan)
    return "fault: the fuel's mass becomes not a number"


def missed(faults: Sequence[Fault], end_s: float) -> list[str]:
    """The faults that a flight was over before, in words; `end_s` since departure."""
    return [
        f"warning: the fault {fault.kind} of {fault.time_s:g} s did not strike; "
        f"the flight ended at {end_s:.0f} s"
        for fault in faults
        if fault.time_s > end_s + (_SEEN_AHEAD_S if fault.kind in _OF_WIND else 0.0)
    ]
