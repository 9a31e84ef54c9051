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

    The field is read once a round of guidance, where the aircraft will be at the round's end, and from one
    reading to the next wind runs linearly. In a round of 0.2 s the aircraft flies 6 m, over which wind on a
    grid is linear but for a cell's edge; so this is within 0.02 m/s of a reading at every step also where
    wind grows by 30 m/s in 10 km, and it costs a tenth (`tests/sim/test_wind_ahead.py`). A wind that jumps
    is not smoothed either: it rises within the rounds in which the field says so.
    """

    def __init__(self, truth: Wind, departure_s: float, lead_in_s: float) -> None:
        self._probe = truth
        self._departure_s = departure_s
        self._lead_in_s = lead_in_s
        self._end = 0.0, 0.0, 0.0  # of the round
        self._next: tuple[float, float, float] | None = None  # of its next step; None where it is held
        self._more = 0.0, 0.0, 0.0  # from step to step

    def look(self, aircraft: JsbsimAircraft, state: FlightState, steps: int, duration_s: float) -> None:
        """Read the wind for a round.

        Args:
            aircraft: to be flown on by `fly`, in parts or at once.
            state: of the aircraft now.
            steps: of the simulation in the round.
            duration_s: of those.

        Raises:
            OutsideFieldError: if the round leads out of the field.
        """
        time_s, lat_rad, lon_rad, altitude_m, north_mps, east_mps, down_mps = state[:7]
        end_s = time_s + duration_s
        per_m = duration_s / (_EARTH_RADIUS_M + altitude_m)
        north, east, down = self._probe(
            self._departure_s + (end_s if end_s > 0.0 else 0.0),
            lat_rad + north_mps * per_m,
            lon_rad + east_mps * per_m / math.cos(lat_rad),
            altitude_m - down_mps * duration_s,
        )
        share = (end_s + self._lead_in_s) / WIND_RAMP_S
        if share < 1.0:
            north, east, down = share * north, share * east, share * down
        last_north, last_east, last_down = self._end
        self._end = north, east, down
        more_north, more_east, more_down = north - last_north, east - last_east, down - last_down
        if abs(more_north) + abs(more_east) + abs(more_down) < HELD_MPS:
            self._next = None
            aircraft.set_wind(north - 0.5 * more_north, east - 0.5 * more_east, down - 0.5 * more_down)
            return
        self._more = more_north / steps, more_east / steps, more_down / steps
        half = 0.5 / steps  # a step has the wind of its middle
        self._next = (
            last_north + half * more_north,
            last_east + half * more_east,
            last_down + half * more_down,
        )

    def fly(self, aircraft: JsbsimAircraft, steps: int) -> None:
        """Fly on by so many steps of the round."""
        if self._next is None:
            aircraft.step(steps)
            return
        north, east, down = self._next
        more_north, more_east, more_down = self._more
        for _ in range(steps):
            aircraft.set_wind(north, east, down)
            aircraft.step()
            north, east, down = north + more_north, east + more_east, down + more_down
        self._next = north, east, down
