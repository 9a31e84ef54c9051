"""What is left of a flight when its engine has stopped: the glide, from where it began."""

from __future__ import annotations

from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.state import FlightState
from planner.grid import geodesic_m
from recordings.recorder import Outcome

_FAILED_AFTER_S = 3.0
_ASKED_THROTTLE = 0.3  # closed, a windmilling engine may stop and start again as it likes


class Glide:
    """Notes when and where the engine stops, and tells what became of the flight after it.

    It has stopped when it has given nothing for three seconds with the throttle open.
    """

    def __init__(self, aircraft: JsbsimAircraft) -> None:
        self._aircraft = aircraft
        self._begin: FlightState | None = None
        self.cause: Outcome | None = None

    def watch(self, state: FlightState) -> list[str]:
        """What there is to tell at this moment: once that the engine has stopped, else nothing."""
        if self.cause is not None:
            return []
        if self._aircraft.engine_runs() or state.throttle < _ASKED_THROTTLE:
            self._begin = None
            return []
        if self._begin is None:
            self._begin = state
        if state.time_s - self._begin.time_s < _FAILED_AFTER_S:
            return []
        self.cause = Outcome.ENGINE_FAILED if state.fuel_kg > 0.0 else Outcome.FUEL_OUT
        why = "the tank is empty" if self.cause is Outcome.FUEL_OUT else "the engine has stopped"
        return [f"{why}: gliding from {state.altitude_m:.0f} m"]

    def story(self, state: FlightState) -> str:
        """How the glide ended, for the outcome."""
        assert self._begin is not None  # asked for after a cause only
        begin = self._begin
        far_m = geodesic_m(begin.lat_rad, begin.lon_rad, state.lat_rad, state.lon_rad)
        return (
            f"the engine stopped at {begin.time_s:.0f} s and {begin.altitude_m:.0f} m; glided "
            f"{far_m / 1000.0:.1f} km in {state.time_s - begin.time_s:.0f} s "
            f"and touched the ground at {state.airspeed_mps:.0f} m/s"
        )
