"""Messages of fixed length against protobuf itself."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recordings.errors import RecordingError
from recordings.fixed_layout import FixedLayout
from recordings.protobuf_types import message_type
from recordings.schema import GUIDANCE_COLUMNS, STATE_COLUMNS, Kind

STATE, GUIDANCE = FixedLayout(STATE_COLUMNS), FixedLayout(GUIDANCE_COLUMNS)


def numbers(kind):
    if kind == Kind.SMALL:
        return st.integers(0, 127)
    return st.floats(allow_nan=False, width=64 if kind == Kind.DOUBLE else 32)


def rows(layout):
    return st.lists(st.tuples(*(numbers(column.kind) for column in layout.columns)), min_size=1, max_size=3)


def filled(layout, table):
    messages = np.empty(len(table), layout.message)
    layout.fill(messages, np.array(table, np.float64))
    return [message.tobytes() for message in messages]


@pytest.mark.parametrize(("layout", "name"), [(STATE, "galeway.State"), (GUIDANCE, "galeway.Guidance")])
def test_protobuf_reads_what_was_filled_and_parse_reads_it_back(layout, name):
    @given(table=rows(layout))
    def check(table):
        payloads = filled(layout, table)
        for values, payload in zip(table, payloads, strict=True):
            message = message_type(name).FromString(payload)
            assert tuple(getattr(message, column.name) for column in layout.columns) == values
        assert [tuple(row) for row in layout.parse(payloads).tolist()] == table

    check()


def test_nan_and_infinity_are_kept():
    (payload,) = filled(GUIDANCE, [[math.nan, math.inf, -math.inf, 0, 0, 0, 0, 0, 0, 0]])
    message = message_type("galeway.Guidance").FromString(payload)
    assert math.isnan(message.time_s)
    assert (message.path_m, message.cross_track_m) == (math.inf, -math.inf)


def test_what_is_too_large_for_a_float_becomes_infinite():
    (payload,) = filled(GUIDANCE, [[0, 0, 1e39, -1e39, 0, 0, 0, 0, 0, 0]])
    message = message_type("galeway.Guidance").FromString(payload)
    assert (message.cross_track_m, message.altitude_error_m) == (math.inf, -math.inf)


@pytest.mark.parametrize("phase", [-1, 128, 0.5, math.nan])
def test_a_phase_that_does_not_fit_a_byte_is_refused(phase):
    with pytest.raises(RecordingError, match="phase"):
        filled(GUIDANCE, [[0, 0, 0, 0, 0, phase, 0, 0, 0, 0]])


def other_encodings():
    kind = message_type("galeway.Guidance")
    yield "zeros left out", kind(time_s=1.0, phase=3).SerializeToString()
    (payload,) = filled(GUIDANCE, [range(10)])
    yield "two fields swapped", payload[9:18] + payload[:9] + payload[18:]
    large = kind(**{c.name: 1 for c in GUIDANCE_COLUMNS})
    large.phase = 300
    yield "a longer integer", large.SerializeToString()
    yield "cut", payload[:-1]


@pytest.mark.parametrize(("what", "payload"), list(other_encodings()), ids=lambda value: str(value)[:20])
def test_other_encodings_are_left_to_protobuf(what, payload):
    (usual,) = filled(GUIDANCE, [range(10)])
    assert GUIDANCE.parse([usual, payload]) is None


def test_no_messages_are_no_rows():
    assert len(STATE.parse([])) == 0
