"""Messages copied from a template are what protobuf makes of the same numbers."""

import numpy as np
import pytest

from recordings.message_template import MessageTemplate, mark
from recordings.messages import new
from recordings.protobuf_types import message_type
from recordings.schema import MAP_FRAME, TRANSFORM

NUMBERS = [
    (1.5, -2.25, 1e-300),
    (0.0, -0.0, 5e6),  # protobuf itself leaves out zeros
    (np.inf, -np.inf, np.pi),
    (mark(1), mark(2), mark(0)),
]
TIMES = [0, 1_664_409_600 * 10**9, 1_664_409_600_123_456_789, (2**34 + 5) * 10**9 + 999_999_999]


def transform(numbers):
    x, y, z = numbers
    return new(TRANSFORM, parent_frame_id=MAP_FRAME, translation={"x": x, "y": y, "z": z})


def test_numbers_and_times_are_read_back_as_they_were_given():
    template = MessageTemplate(transform(map(mark, range(3))), 3)
    messages = np.zeros((len(NUMBERS), template.size), np.uint8)
    template.fill(messages, np.array(TIMES, np.uint64), np.array(NUMBERS))
    for content, numbers, log_time in zip(messages, NUMBERS, TIMES, strict=True):
        expected = transform(numbers)
        expected.timestamp.seconds, expected.timestamp.nanos = divmod(log_time, 10**9)
        assert message_type(TRANSFORM.message).FromString(content.tobytes()) == expected


def test_a_message_without_one_of_its_marks_is_refused():
    with pytest.raises(ValueError, match="0 times"):
        MessageTemplate(transform(map(mark, range(3))), 4)
