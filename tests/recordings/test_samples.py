"""Samples as tables: the fields in their places, rounded no more than the schema says."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from recordings.samples import Samples, rounded
from recordings.schema import GUIDANCE_COLUMNS, STATE_COLUMNS


def test_tables_hold_every_field_in_its_place(workshop):
    flight = workshop.fly(workshop.header(workshop.corners), until_s=3.0)
    samples = Samples()
    for state, guidance in zip(flight.states, flight.guidance, strict=True):
        samples.add(state, guidance)
    assert samples.total == len(flight.states)
    state_table, guidance_table = samples.between(0, samples.total)
    steps = np.array([column.step for column in STATE_COLUMNS])
    assert (np.abs(state_table - np.array(flight.states)) <= steps / 2.0).all()
    flat = [
        (state.time_s, *sample[:-1], *sample.command)
        for state, sample in zip(flight.states, flight.guidance, strict=True)
    ]
    steps = np.array([column.step for column in GUIDANCE_COLUMNS])
    assert (np.abs(guidance_table - np.array(flat)) <= steps / 2.0).all()
    assert state_table[:, 0].tolist() == [state.time_s for state in flight.states]


def test_steps_are_finer_than_any_instrument():
    finest = {"m": 1e-3, "s": 1e-3, "mps": 1e-3, "rad": 4e-6, "radps": 4e-6, "kg": 1e-6}
    for column in (*STATE_COLUMNS, *GUIDANCE_COLUMNS):
        unit = column.name.rpartition("_")[2]
        assert column.step <= finest.get(unit, 1e-4), column.name


@given(st.floats(-1e6, 1e6))
def test_rounding_is_to_the_nearest_step_and_done_once(value):
    table = np.full((1, len(STATE_COLUMNS)), value)
    once = rounded(table, STATE_COLUMNS)
    assert np.array_equal(rounded(once, STATE_COLUMNS), once)
    assert once[0, 0] == value
    assert (np.abs(once - value) <= np.array([column.step for column in STATE_COLUMNS]) / 2.0).all()


def test_what_is_not_finite_stays_so():
    for value in (math.nan, math.inf, -math.inf):
        table = np.full((1, len(GUIDANCE_COLUMNS)), value)
        assert np.array_equal(rounded(table, GUIDANCE_COLUMNS), table, equal_nan=True)
