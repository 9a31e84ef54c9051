"""Faults put into a flight on purpose: what it has to come through, or to end at in good order."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from aircraft.jsbsim_aircraft import JsbsimAircraft
from sim.scenario import Fault, FaultKind

Wind = Callable[[float, float, float, float], tuple[float, float, float]]
"""(time [s], latitude [rad], longitude [rad], altitude [m]) -> wind north, east, down [m/s, toward]."""


def disturbed(wind: Wind, faults: Sequence[Fault], departure_s: float) -> Wind:
    """The wind with the faults that lie in it; the wind itself where there are none.

    Args:
        wind: the truth, its time in seconds since 1970-01-01 UTC.
        faults: of the flight; those of the aircraft are passed over.
        departure_s: when the faults' times begin, on the wind's clock.
    """
    steps = [fault for fault in faults if fault.kind in (FaultKind.WIND_STEP, FaultKind.WIND_NAN)]
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


class AircraftFaults:
    """The faults of the aircraft itself, each brought about once, when its time has come."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        mine = (FaultKind.ENGINE_FAILURE, FaultKind.FUEL_LOSS, FaultKind.STATE_NAN)
        waiting = [fault for fault in faults if fault.kind in mine]
        self._waiting = sorted(waiting, key=lambda fault: fault.time_s, reverse=True)

    def strike(self, aircraft: JsbsimAircraft, time_s: float) -> list[str]:
        """Bring about what is due; what that was, in words.

        Args:
            aircraft: whose engine or tanks fail.
            time_s: since departure.
        """
        struck = []
        while self._waiting and self._waiting[-1].time_s <= time_s:
            fault = self._waiting.pop()
            if fault.kind is FaultKind.ENGINE_FAILURE:
                aircraft.stop_engine()
                struck.append("fault: the engine is stopped")
            elif fault.kind is FaultKind.FUEL_LOSS:
                aircraft.drain_fuel(fault.fuel_kg)
                struck.append(f"fault: the fuel is drained to {fault.fuel_kg:g} kg")
            else:
                aircraft.drain_fuel(math.nan)
                struck.append("fault: the fuel's mass becomes not a number")
        return struck
