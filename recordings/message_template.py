"""Protobuf messages that differ in some numbers only, many at a time.

One message is serialised by protobuf, with marks in place of the numbers; in copies of its bytes the numbers
are put where the marks are. So messages of any type cost what copying them costs. The bytes are ordinary
protobuf, for any reader.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from recordings.messages import serialised

_MARK = struct.Struct("<4sI")
_VARINT_BYTES = 5  # as many as seconds of today take; of smaller numbers the last ones hold nothing
_SECONDS, _NANOSECONDS = 0x6B8B4567, 0x327B23C6
"""Marks of a `google.protobuf.Timestamp`."""


def mark(number: int) -> float:
    """What stands for a number of type double in the message that a template is made of."""
    value: float = struct.unpack("<d", _MARK.pack(b"galw", 0x3FF00000 + number))[0]
    return value


class MessageTemplate:
    """A message with a `timestamp` and, in it, `mark(0)` to `mark(numbers - 1)`, each once."""

    def __init__(self, message: Any, numbers: int) -> None:
        message.timestamp.seconds, message.timestamp.nanos = _SECONDS, _NANOSECONDS
        content = serialised(message)
        self._bytes = np.frombuffer(content, np.uint8)
        self._doubles = [_place(content, struct.pack("<d", mark(number))) for number in range(numbers)]
        self._times = [_place(content, bytes(_varint(value))) for value in (_SECONDS, _NANOSECONDS)]

    @property
    def size(self) -> int:
        """Bytes of each message."""
        return len(self._bytes)

    def fill(
        self, messages: NDArray[np.uint8], log_times: NDArray[np.uint64], numbers: NDArray[np.float64]
    ) -> None:
        """Write messages.

        Args:
            messages: their bytes, shape (n, size).
            log_times: Unix nanoseconds, shape (n,).
            numbers: what stands for the marks, shape (n, marks).
        """
        messages[:] = self._bytes
        for place, column in zip(self._doubles, numbers.T, strict=True):
            messages[:, place : place + 8] = column.astype("<f8")[:, np.newaxis].view(np.uint8)
        for place, values in zip(self._times, np.divmod(log_times, np.uint64(10**9)), strict=True):
            messages[:, place : place + _VARINT_BYTES] = _varint(values)


def _place(content: bytes, marked: bytes) -> int:
    if content.count(marked) != 1:
        raise ValueError(f"the mark {marked!r} stands {content.count(marked)} times in the message, not once")
    return content.index(marked)


def _varint(values: Any) -> NDArray[np.uint8]:
    """Whole numbers below 2 ** 35 as varints that are all of one length, shape (..., 5)."""
    shifts = np.arange(_VARINT_BYTES, dtype=np.uint64) * np.uint64(7)
    parts = np.asarray(values, np.uint64)[..., np.newaxis] >> shifts & np.uint64(127)
    parts[..., :-1] |= np.uint64(128)
    return parts.astype(np.uint8)
