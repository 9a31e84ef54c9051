"""What galeway measured of an aircraft, as text."""

from __future__ import annotations

import math
from collections.abc import Iterator

from aircraft.description import AircraftFolder, as_written
from aircraft.envelope import Condition, Envelope
from aircraft.own_models import envelope_of
from aircraft.trim_stand import TrimStand

_COLUMNS = 7  # airspeeds of the table, from the slowest to the fastest


def aircraft_sheet(aircraft: AircraftFolder) -> str:
    """Envelope, what level flight takes at each airspeed, and gains.

    Raises:
        ModelError: if the model cannot be loaded or flown; a user's own is tried in a child process first.
    """
    envelope = envelope_of(aircraft)
    stand = TrimStand(aircraft)
    lines = [
        f"{aircraft.name}: {aircraft.description.description or aircraft.path}",
        "",
        *_envelope_lines(aircraft, envelope, stand),
        "",
        *_level_flight_lines(envelope, stand),
        "",
        "gains of guidance",
        *(f"  {key:24s} {value:6.3g}" for key, value in as_written(aircraft.gains).items()),
    ]
    return "\n".join(lines)


def _envelope_lines(aircraft: AircraftFolder, envelope: Envelope, stand: TrimStand) -> Iterator[str]:
    limits = aircraft.description.limits
    yield "envelope: what trims at sea level and ceiling, with full and empty tank, straight and at the bank"
    yield f"  airspeed   {envelope.airspeed_min_mps:.1f} to {envelope.airspeed_max_mps:.1f} m/s true"
    yield f"  cruise     {envelope.cruise_mps:.1f} m/s, climbing up to {envelope.climb_max_mps:.1f} m/s"
    yield f"  descent    up to {envelope.descent_max_mps:.1f} m/s"
    yield f"  bank       {limits.bank_max_deg:.0f}°"
    yield f"  ceiling    {envelope.ceiling_m:.0f} m"
    yield (
        f"  in hand    {limits.throttle_in_hand:.0%} of throttle, {limits.angle_of_attack_in_hand_deg:.1f}° "
        f"to the stall at {math.degrees(stand.stall_rad):.1f}°"
    )


def _level_flight_lines(envelope: Envelope, stand: TrimStand) -> Iterator[str]:
    altitude_m, fuel_kg = 0.5 * envelope.ceiling_m, stand.fuel_kg
    yield f"level flight in still air at {altitude_m:.0f} m, with a full tank of {fuel_kg:.1f} kg"
    yield "  airspeed  throttle  angle of attack  fuel flow  endurance   range"
    yield "       m/s         %                °       kg/h          h      km"
    low_mps, high_mps = envelope.airspeed_min_mps, envelope.airspeed_max_mps
    airspeeds = {low_mps + (high_mps - low_mps) * i / (_COLUMNS - 1) for i in range(_COLUMNS)}
    for airspeed_mps in sorted(airspeeds | {envelope.cruise_mps}):
        trimmed = stand(Condition(airspeed_mps, altitude_m))
        if trimmed is None:
            yield f"  {airspeed_mps:8.1f}  does not trim"
            continue
        flow_kgph = 3600.0 * trimmed.fuel_flow_kgps
        endurance_h = fuel_kg / flow_kgph if flow_kgph else math.inf
        yield (
            f"  {airspeed_mps:8.1f}  {100.0 * trimmed.throttle:8.0f}  "
            f"{math.degrees(trimmed.angle_of_attack_rad):15.1f}  {flow_kgph:9.3g}  {endurance_h:9.1f}  "
            f"{3.6 * airspeed_mps * endurance_h:6.0f}"
        )
