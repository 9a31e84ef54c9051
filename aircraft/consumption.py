"""What an aircraft burns in level flight, measured on its model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.turbulence import Turbulence

_AIRSPEEDS = 8


@dataclass(frozen=True, slots=True)
class Consumption:
    """Fuel flow in level flight with full tanks, at rising true airspeeds over the whole envelope."""

    airspeed_mps: tuple[float, ...]
    flow_kgps: tuple[float, ...]


def measure_consumption(model: str, altitude_m: float) -> Consumption:
    """Trim a model for level flight at a handful of airspeeds and read what the engine burns.

    Raises:
        ModelError: if there is no such model, or it cannot be trimmed at this altitude.
    """
    aircraft = JsbsimAircraft(model, turbulence=Turbulence("none", 0), seed=0)
    envelope = aircraft.envelope
    airspeeds_mps = np.linspace(envelope.airspeed_min_mps, envelope.airspeed_max_mps, _AIRSPEEDS).tolist()
    flows_kgps = [aircraft.level_fuel_flow_kgps(speed_mps, altitude_m) for speed_mps in airspeeds_mps]
    return Consumption(tuple(airspeeds_mps), tuple(flows_kgps))
