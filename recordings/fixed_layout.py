"""Protobuf messages of fixed length, a thousand at a time.

A message whose fields are all written, in order, as double, float or one-byte integer, always has the same
fields in the same places. So a column of numbers is copied to or from all messages of a chunk at once, with
no object for each. The bytes are ordinary protobuf, for any reader.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from recordings.errors import RecordingError
from recordings.schema import Column, Kind

Floats = NDArray[np.float64]
Rows = NDArray[np.void]

_WIRE_TYPE = {Kind.SMALL: 0, Kind.DOUBLE: 1, Kind.FLOAT: 5}
_NUMPY_TYPE = {Kind.SMALL: "u1", Kind.DOUBLE: "<f8", Kind.FLOAT: "<f4"}
_SMALL_LIMIT = 127
_BLOCK = 4096  # messages read at once, so that they stay in the cache


class FixedLayout:
    """Where the fields of one message type lie in its bytes."""

    def __init__(self, columns: Sequence[Column]) -> None:
        self.columns = tuple(columns)

    @cached_property
    def message(self) -> np.dtype[np.void]:
        """The bytes of a message, tags and values in turn."""
        fields: list[Any] = []
        for number, column in enumerate(self.columns, 1):
            fields.append((_tag_name(column), "u1" if number < 16 else "<u2"))
            fields.append((column.name, _NUMPY_TYPE[column.kind]))
        return np.dtype(fields)

    @cached_property
    def values(self) -> np.dtype[np.void]:
        """The values alone, one after the other."""
        return np.dtype([(column.name, _NUMPY_TYPE[column.kind]) for column in self.columns])

    @cached_property
    def tags(self) -> dict[str, int]:
        """The bytes of each tag as a little-endian number: field number and wire type, a varint."""
        return {
            _tag_name(column): _varint(number << 3 | _WIRE_TYPE[column.kind])
            for number, column in enumerate(self.columns, 1)
        }

    def rows(self, table: Floats) -> Rows:
        """Numbers, shape (n, columns), as `values`; what is too large for a float becomes infinite."""
        rows = np.empty(len(table), self.values)
        with np.errstate(over="ignore", invalid="ignore"):
            for index, column in enumerate(self.columns):
                if column.kind == Kind.SMALL:
                    _check_small(column.name, table[:, index])
                rows[column.name] = table[:, index]
        return rows

    def fill(self, messages: Rows, table: Floats) -> None:
        """Write numbers into messages.

        Args:
            messages: of dtype `message`, shape (n,).
            table: shape (n, columns). What is too large for a float becomes infinite, as protobuf has it.

        Raises:
            RecordingError: if a small integer is none.
        """
        for name, tag in self.tags.items():
            messages[name] = tag
        with np.errstate(over="ignore", invalid="ignore"):
            for index, column in enumerate(self.columns):
                values = table[:, index]
                if column.kind == Kind.SMALL:
                    _check_small(column.name, values)
                messages[column.name] = values

    def parse(self, payloads: Sequence[bytes]) -> Rows | None:
        """The values of messages, dtype `values`, shape (n,); None if any is encoded in another way."""
        size = self.message.itemsize
        if any(len(payload) != size for payload in payloads):
            return None
        rows = np.empty(len(payloads), self.values)
        for begin in range(0, len(payloads), _BLOCK):
            messages = np.frombuffer(b"".join(payloads[begin : begin + _BLOCK]), self.message)
            if not self._is_usual(messages):
                return None
            for column in self.columns:
                rows[column.name][begin : begin + _BLOCK] = messages[column.name]
        return rows

    def _is_usual(self, messages: Rows) -> bool:
        """Whether fields are where they are expected, one behind the other."""
        smalls = [column.name for column in self.columns if column.kind == Kind.SMALL]
        return all(np.all(messages[name] == tag) for name, tag in self.tags.items()) and all(
            np.all(messages[name] <= _SMALL_LIMIT) for name in smalls
        )


def _tag_name(column: Column) -> str:
    return f"tag of {column.name}"


def _varint(number: int) -> int:
    return number if number < 128 else (number & 127 | 128) | number >> 7 << 8


def _check_small(name: str, values: Floats) -> None:
    wrong = ~((values >= 0) & (values <= _SMALL_LIMIT) & (values == np.floor(values)))
    if np.any(wrong):
        raise RecordingError(
            f"{name} {values[wrong][0]} cannot be recorded; give a whole number from 0 to {_SMALL_LIMIT}"
        )
