"""Tries a model in a process of its own: `python -m aircraft.model_trial FOLDER`.

Prints its envelope as JSON, or ends with code 2 and the reason why it cannot be flown, or as JSBSim ends it.
"""

from __future__ import annotations

import sys

import msgspec

from aircraft.description import AircraftFolder, load_aircraft
from aircraft.envelope import Envelope
from aircraft.errors import ModelError
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.trim_stand import TrimStand
from aircraft.turbulence import Turbulence

_HOLD_S = 30.0
_ALTITUDE_TOLERANCE_M = 10.0
_AIRSPEED_TOLERANCE_MPS = 2.0


def main() -> None:
    """Try the model in the folder that the command line names."""
    try:
        aircraft = load_aircraft(sys.argv[1])
        envelope = TrimStand(aircraft).envelope()
        check_autopilot(aircraft, envelope)
    except ModelError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
    print(msgspec.json.encode(envelope).decode())


def check_autopilot(aircraft: AircraftFolder, envelope: Envelope) -> None:
    """Fly half a minute level in still air at cruise.

    Raises:
        ModelError: if the autopilot does not hold altitude and airspeed.
    """
    altitude_m = 0.5 * envelope.ceiling_m
    flown = JsbsimAircraft(aircraft, turbulence=Turbulence(), seed=1, envelope=envelope)
    flown.start(
        lat_rad=0.0,
        lon_rad=0.0,
        altitude_m=altitude_m,
        heading_rad=0.0,
        airspeed_mps=envelope.cruise_mps,
        time_s=0.0,
    )
    for _ in range(round(_HOLD_S * flown.rate_hz)):
        flown.step()
    state = flown.state()
    off_m, off_mps = state.altitude_m - altitude_m, state.airspeed_mps - envelope.cruise_mps
    if not (abs(off_m) < _ALTITUDE_TOLERANCE_M and abs(off_mps) < _AIRSPEED_TOLERANCE_MPS):
        raise ModelError(
            f"the autopilot of {aircraft.name!r} does not hold level flight in still air at "
            f"{envelope.cruise_mps:g} m/s and {altitude_m:.0f} m: after {_HOLD_S:.0f} s it is off by "
            f"{off_mps:+.1f} m/s and {off_m:+.1f} m, limits {_AIRSPEED_TOLERANCE_MPS:.0f} m/s and "
            f"{_ALTITUDE_TOLERANCE_M:.0f} m; "
            "check the signs of its outputs"
        )


if __name__ == "__main__":
    main()
