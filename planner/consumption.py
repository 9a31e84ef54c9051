"""What an aircraft burns: its fuel flow in level flight, as measured at a handful of airspeeds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.errors import PlannerError
from planner.windfield import Floats


@dataclass(frozen=True, slots=True)
class FuelFlow:
    """Fuel flow at true airspeeds, linear in between, the outermost values kept beyond.

    `airspeed_mps`: rising. `flow_kgps`: as many, positive.

    Raises:
        PlannerError: if the two do not fit, the airspeeds do not rise, or a flow is not above 0.
    """

    airspeed_mps: tuple[float, ...]
    flow_kgps: tuple[float, ...]

    def __post_init__(self) -> None:
        speeds, flows = np.array(self.airspeed_mps), np.array(self.flow_kgps)
        if not speeds.size or speeds.shape != flows.shape or not (np.diff(speeds) > 0.0).all():
            raise PlannerError(
                f"{flows.size} fuel flows at the airspeeds {self.airspeed_mps}; give one for each, rising"
            )
        if not (np.isfinite(flows) & (flows > 0.0)).all():
            raise PlannerError(f"fuel flows {self.flow_kgps} kg/s; each has to be above 0")

    def at(self, airspeed_mps: float | Floats) -> Floats:
        """Fuel flow at true airspeeds [kg/s]."""
        return np.asarray(np.interp(airspeed_mps, self.airspeed_mps, self.flow_kgps))

    def thriftiest(self, slowest_mps: float, fastest_mps: float) -> float:
        """The airspeed of the least flow within bounds [m/s]: that which burns least while time passes."""
        inside = [speed for speed in self.airspeed_mps if slowest_mps < speed < fastest_mps]
        return min((slowest_mps, *inside, fastest_mps), key=lambda speed: float(self.at(speed)))
