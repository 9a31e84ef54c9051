"""What guidance sees, and what its commands become."""

import math

import pytest

from aircraft.instruments import GpsInstruments, PerfectInstruments
from aircraft.sensors import SensorClass, Sensors
from aircraft.state import ESTIMATED_FIELDS, Command

COMMAND = Command(0.2, 27.0, 1000.0, 0.5)


def gps(seed=1):
    return GpsInstruments(Sensors(SensorClass(), seed))


def test_perfect_instruments_pass_everything_through(circling):
    perfect = PerfectInstruments()
    for state in circling(1.0):
        assert perfect.see(state) is state
        assert perfect.shift(COMMAND, state, state) is COMMAND


def test_gps_shows_something_else_of_what_sensors_measure_and_nothing_else(circling):
    instruments = gps()
    states = circling(5.0, wind=(5.0, 5.0))
    seen = [instruments.see(state) for state in states]
    assert seen[0] is states[0]
    differing = {
        name
        for name, true, shown in zip(states[-1]._fields, states[-1], seen[-1], strict=True)
        if true != shown
    }
    assert differing == set(ESTIMATED_FIELDS)


def test_a_shifted_command_is_reached_where_what_is_seen_is_the_command(circling):
    instruments = gps()
    for state in circling(5.0, climb_mps=1.0):
        seen = instruments.see(state)
    shifted = instruments.shift(COMMAND, state, seen)
    assert shifted != COMMAND
    # the inner loops bring the truth to the shifted command; what is then seen is off by the same error
    for name in ("roll_rad", "airspeed_mps", "altitude_m"):
        error = getattr(seen, name) - getattr(state, name)
        assert getattr(shifted, name) + error == pytest.approx(getattr(COMMAND, name))
    climb_error_mps = state.down_mps - seen.down_mps
    assert shifted.climb_mps + climb_error_mps == pytest.approx(COMMAND.climb_mps)


def test_the_seed_decides_what_is_seen(circling):
    states = circling(5.0)

    def seen(seed):
        instruments = gps(seed)
        return [instruments.see(state) for state in states]

    assert seen(3) == seen(3)
    assert seen(3) != seen(4)
    assert all(math.isfinite(value) for state in seen(3) for value in state)
