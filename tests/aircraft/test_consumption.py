"""Consumption measured by trim, against what the tank loses in level flight."""

import numpy as np
import pytest

from aircraft.consumption import measure_consumption
from aircraft.description import load_aircraft
from aircraft.errors import ModelError
from aircraft.jsbsim_aircraft import JsbsimAircraft, Turbulence


def test_it_is_what_the_tank_loses_in_level_flight():
    measured = measure_consumption(load_aircraft("aerosonde"), 1000.0)
    aircraft = JsbsimAircraft("aerosonde", turbulence=Turbulence("none", 0), seed=1)
    assert measured.airspeed_mps[0] == aircraft.envelope.airspeed_min_mps
    assert measured.airspeed_mps[-1] == aircraft.envelope.airspeed_max_mps
    for airspeed_mps in (24.0, 36.0):
        aircraft.start(
            lat_rad=0.5,
            lon_rad=0.0,
            altitude_m=1000.0,
            heading_rad=1.0,
            airspeed_mps=airspeed_mps,
            time_s=0.0,
        )
        left_kg = []
        for seconds in (20, 60):
            for _ in range(seconds * 60):
                aircraft.step()
            left_kg.append(aircraft.fuel_kg)
        flow_kgps = (left_kg[0] - left_kg[1]) / 60.0
        interpolated = np.interp(airspeed_mps, measured.airspeed_mps, measured.flow_kgps)
        assert flow_kgps == pytest.approx(interpolated, rel=0.02)


def test_it_rises_with_airspeed_and_changes_with_altitude():
    low, high = (
        measure_consumption(load_aircraft("aerosonde"), altitude_m) for altitude_m in (200.0, 1800.0)
    )
    assert (np.diff(low.flow_kgps) > 0.0).all()
    assert low.flow_kgps[-1] > high.flow_kgps[-1]


def test_an_altitude_out_of_reach_is_refused():
    with pytest.raises(
        ModelError, match=r"'aerosonde' cannot fly level at .* 12000 m; fly no higher than 2000 m"
    ):
        measure_consumption(load_aircraft("aerosonde"), 12000.0)
