"""What an aircraft burns in level flight, measured on its model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aircraft.description import AircraftFolder
from aircraft.envelope import Condition
from aircraft.errors import ModelError
from aircraft.own_models import envelope_of
from aircraft.trim_stand import TrimStand

_AIRSPEEDS = 8


@dataclass(frozen=True, slots=True)
class Consumption:
    """Fuel flow in level flight with full tanks, at rising true airspeeds over the whole envelope."""

    airspeed_mps: tuple[float, ...]
    flow_kgps: tuple[float, ...]


def measure_consumption(aircraft: AircraftFolder, altitude_m: float) -> Consumption:
    """Trim a model for level flight at a handful of airspeeds and read what its engines burn.

    Raises:
        ModelError: if it cannot be trimmed at this altitude.
    """
    envelope, stand = envelope_of(aircraft), TrimStand(aircraft)
    airspeeds_mps = np.linspace(envelope.airspeed_min_mps, envelope.airspeed_max_mps, _AIRSPEEDS).tolist()
    flows_kgps = []
    for airspeed_mps in airspeeds_mps:
        trimmed = stand(Condition(airspeed_mps, altitude_m))
        if trimmed is None:
            raise ModelError(
                f"{aircraft.name!r} cannot fly level at {airspeed_mps:.1f} m/s and {altitude_m:.0f} m; "
                f"fly no higher than {envelope.ceiling_m:.0f} m"
            )
        flows_kgps.append(trimmed.fuel_flow_kgps)
    return Consumption(tuple(airspeeds_mps), tuple(flows_kgps))
