"""The wind that the aircraft flies through, laid from one round of guidance to the next."""

from __future__ import annotations

import math

from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.state import FlightState
from sim.faults import Wind

WIND_RAMP_S = 20.0
"""The wind is brought in over so long, in the lead-in: the aircraft is trimmed in still air."""

HELD_MPS = 0.02
"""A change of wind in one round below which the round is flown in its middle, without steps in between."""

_EARTH_RADIUS_M = 6.37e6  # some 0.5 % wrong at most: a centimetre or two in the three metres of a round


class WindAhead:
    """Puts the truth's wind on the aircraft while it flies.

    The field is read once a round, where the aircraft will be at the round's end, and from one reading to the
    next wind runs linearly. In a round of 0.1 s the aircraft flies 3 m, over which wind on a grid is linear
    but for a cell's edge; so this is within 0.02 m/s of a reading at every step also where wind grows by
    30 m/s in 10 km, and it costs a fifth (`tests/sim/test_wind_ahead.py`). A wind that jumps is
    not smoothed either: it rises within the rounds in which the field says so.
    """

    def __init__(self, truth: Wind, departure_s: float, lead_in_s: float) -> None:
        self._probe = truth
        self._departure_s = departure_s
        self._lead_in_s = lead_in_s
        self._last = 0.0, 0.0, 0.0

    def fly(self, aircraft: JsbsimAircraft, state: FlightState, steps: int, duration_s: float) -> None:
        """Fly one round.

        Args:
            aircraft: flown on by `steps`.
            state: of the aircraft now.
            steps: of the simulation.
            duration_s: of those.

        Raises:
            OutsideFieldError: if the round leads out of the field; it is not flown then.
        """
        end_s = state.time_s + duration_s
        lat_rad, altitude_m = state.lat_rad, state.altitude_m
        per_m = duration_s / (_EARTH_RADIUS_M + altitude_m)
        north, east, down = self._probe(
            self._departure_s + (end_s if end_s > 0.0 else 0.0),
            lat_rad + state.north_mps * per_m,
            state.lon_rad + state.east_mps * per_m / math.cos(lat_rad),
            altitude_m - state.down_mps * duration_s,
        )
        share = (end_s + self._lead_in_s) / WIND_RAMP_S
        if share < 1.0:
            north, east, down = share * north, share * east, share * down
        last_north, last_east, last_down = self._last
        self._last = north, east, down
        more_north, more_east, more_down = north - last_north, east - last_east, down - last_down
        if abs(more_north) + abs(more_east) + abs(more_down) < HELD_MPS:
            aircraft.set_wind(north - 0.5 * more_north, east - 0.5 * more_east, down - 0.5 * more_down)
            aircraft.step(steps)
            return
        for step in range(steps):
            part = (step + 0.5) / steps
            aircraft.set_wind(
                last_north + part * more_north, last_east + part * more_east, last_down + part * more_down
            )
            aircraft.step()
