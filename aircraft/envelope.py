"""What each model can be asked to fly: the limits that planner and guidance keep to."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Envelope:
    """Limits in still air between sea level and `ceiling_m`, at any state of fuel.

    Airspeeds are true airspeeds. The maximum airspeed and the climb at cruise leave some power in hand
    for turbulence, the minimum airspeed some lift; a level turn at `bank_max_rad` is possible at all of
    them.
    """

    airspeed_min_mps: float
    airspeed_max_mps: float
    cruise_mps: float
    climb_max_mps: float
    bank_max_rad: float
    ceiling_m: float


ENVELOPES: dict[str, Envelope] = {
    "aerosonde": Envelope(
        airspeed_min_mps=20.0,
        airspeed_max_mps=41.0,
        cruise_mps=27.0,
        climb_max_mps=3.0,
        bank_max_rad=math.radians(35.0),
        ceiling_m=2000.0,
    ),
}
"""The models that come with galeway, by name."""
