"""The wind that the aircraft is given, against a reading of the field at every step of the simulation."""

import math

import numpy as np
import pytest

from aircraft.jsbsim_aircraft import JsbsimAircraft, Turbulence
from aircraft.properties import Property
from planner.errors import OutsideFieldError
from planner.grid import Grid
from planner.windfield import WindField
from sim.wind_ahead import WIND_RAMP_S, WindAhead

RATE_HZ, STEPS = 60.0, 12
START_LAT_RAD, START_LON_RAD = math.radians(28.0), math.radians(-84.0)
GRID = Grid.covering(
    START_LAT_RAD - 0.01,
    START_LAT_RAD + 0.01,
    START_LON_RAD - 0.01,
    START_LON_RAD + 0.01,
    rows=36,
    columns=36,
)
WINDS = Property.WIND_NORTH, Property.WIND_EAST, Property.WIND_DOWN


class Watched(JsbsimAircraft):
    """Notes at every step how far the wind set is from the field's, there and then."""

    def watch(self, field, clock):
        self.probe, self.clock, self.off_mps, self.winds = field.probe(), clock, [], []

    def step(self, count=1):
        for _ in range(count):
            set_mps = np.array([self.get(member) for member in WINDS])
            time_s = self.clock(self.state().time_s)
            self.off_mps.append(np.abs(set_mps - self.probe(time_s, *self.position())).max())
            self.winds.append(set_mps)
            super().step()


def flown(field, duration_s, lead_in_s=30.0):
    aircraft = Watched("aerosonde", turbulence=Turbulence("none"), seed=1, rate_hz=RATE_HZ)
    aircraft.start(
        lat_rad=START_LAT_RAD,
        lon_rad=START_LON_RAD,
        altitude_m=1000.0,
        heading_rad=0.7,
        airspeed_mps=28.0,
        time_s=-lead_in_s,
    )
    aircraft.watch(field, lambda time_s: max(time_s, 0.0))
    wind = WindAhead(field.probe(), 0.0, lead_in_s)
    for _ in range(round((lead_in_s + duration_s) * RATE_HZ / STEPS)):
        wind.look(aircraft, aircraft.state(), STEPS, STEPS / RATE_HZ)
        wind.fly(aircraft, STEPS // 2)
        wind.fly(aircraft, STEPS // 2)
    return aircraft


def steep_field():
    """Wind that grows by 30 m/s in 10 km, with a bend at every cell's edge, and by 6 m/s in ten minutes."""
    north, east = np.meshgrid(GRID.lat_rad - START_LAT_RAD, GRID.lon_rad - START_LON_RAD, indexing="ij")
    grown_mps = 30.0 * 6.37e6 / 1e4 * (0.7 * north + 0.7 * east) + 3.0 * np.sin(4e3 * north)
    sheets = np.stack([grown_mps, grown_mps + 6.0])
    return WindField(GRID, np.array([0.0, 600.0]), sheets, -0.5 * sheets)


def test_it_is_that_of_the_field_at_every_step_where_wind_is_steep():
    aircraft = flown(steep_field(), 120.0)
    ramped = round(WIND_RAMP_S * RATE_HZ)
    assert np.ptp(np.array(aircraft.winds)[ramped:, 0]) > 5.0
    assert max(aircraft.off_mps[ramped:]) < 0.02


def test_it_is_brought_in_during_the_ramp():
    still = np.full((1, *GRID.shape), 10.0)
    aircraft = flown(WindField(GRID, np.array([0.0]), still, still, hold=True), 1.0)
    north_mps = np.array(aircraft.winds)[:, 0]
    times_s = (np.arange(len(north_mps)) + 0.5) / RATE_HZ
    np.testing.assert_allclose(north_mps, 10.0 * np.minimum(times_s / WIND_RAMP_S, 1.0), atol=0.01)


def test_a_wind_that_jumps_is_not_smoothed():
    sheets = np.array([0.0, 0.0, 20.0, 20.0])[:, np.newaxis, np.newaxis] * np.ones(GRID.shape)
    aircraft = flown(WindField(GRID, np.array([0.0, 10.0, 11.0, 60.0]), sheets, 0.0 * sheets), 14.0)
    north_mps = np.array(aircraft.winds)[:, 0]
    times_s = (np.arange(len(north_mps)) + 0.5) / RATE_HZ - 30.0
    np.testing.assert_allclose(north_mps, np.clip(20.0 * (times_s - 10.0), 0.0, 20.0), atol=0.01)


def test_a_round_that_leads_out_of_the_field_is_not_flown():
    sheets = np.ones((2, *GRID.shape))
    field = WindField(GRID, np.array([0.0, 5.0]), sheets, sheets)
    with pytest.raises(OutsideFieldError, match="time"):
        flown(field, 6.0)
