"""A model on a stand: trimmed again and again to find out what its steady flights take."""

from __future__ import annotations

import math

from aircraft.description import AircraftFolder
from aircraft.envelope import Condition, Envelope, Margins, Trimmed, measure_envelope
from aircraft.errors import ModelError
from aircraft.jsbsim_model import JsbsimModel
from aircraft.properties import Property

_RATE_HZ = 60.0  # of no consequence: nothing is flown
_GROUND_M = -1000.0  # deep below, or wheels and ground effect would be trimmed at sea level


class TrimStand:
    """Trims one aircraft; each trim begins from the same controls, so that their order does not matter."""

    def __init__(self, aircraft: AircraftFolder) -> None:
        """Load the model.

        Raises:
            ModelError: if it cannot be loaded, or does not say where it stalls.
        """
        self._aircraft = aircraft
        self._model = JsbsimModel(aircraft, _RATE_HZ)
        self.stall_rad = self._model.get(Property.STALL)
        if self.stall_rad <= 0.0:
            raise ModelError(
                f"the model {aircraft.name!r} does not say at which angle of attack it stalls; "
                "give its <aerodynamics> an <alphalimits>"
            )

    def __call__(self, condition: Condition) -> Trimmed | None:
        """What a steady flight takes; None if the model cannot be trimmed for it."""
        model = self._model
        for member, value in (
            (Property.START_HEIGHT, condition.altitude_m),
            (Property.START_TERRAIN, _GROUND_M),
            (Property.START_AIRSPEED, condition.airspeed_mps),
            (Property.START_CLIMB_ANGLE, math.asin(min(condition.climb_mps / condition.airspeed_mps, 1.0))),
            (Property.AILERON_STICK, 0.0),
            (Property.ELEVATOR_STICK, 0.0),
            (Property.RUDDER_STICK, 0.0),
            (Property.THROTTLE_STICK, 0.5),
            (Property.PITCH_TRIM, 0.0),
        ):
            model.set(member, value)
        model.set_fuel_share(condition.fuel_share)
        if not model.trim(bank_rad=condition.bank_rad):
            self._model = JsbsimModel(self._aircraft, _RATE_HZ)
            return None
        trimmed = Trimmed(
            model.get(Property.ANGLE_OF_ATTACK), model.get(Property.THROTTLE), model.fuel_flow_kgps()
        )
        return trimmed if all(map(math.isfinite, trimmed)) else None

    @property
    def fuel_kg(self) -> float:
        """What the tanks hold at the start of a flight."""
        return self._model.fuel_kg

    @property
    def margins(self) -> Margins:
        """What the aircraft's description keeps in hand."""
        return self._aircraft.margins(self.stall_rad)

    def envelope(self) -> Envelope:
        """Measured anew: takes a second or a few."""
        return measure_envelope(self, self.margins, self._aircraft.name)
