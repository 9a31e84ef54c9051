"""A chunk of an MCAP file in the making: messages that are compressed and indexed together.

Records come many at a time, ready made; the mcap package's own writer takes every message singly (10
microseconds each, where the simulation of a tenth of a second takes 80). See https://mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk
from numpy.typing import NDArray

Integers = NDArray[np.uint64]

MESSAGE_HEAD = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
"""What comes before the payload of a message; `length` counts from behind itself."""

_HEAD_COUNTED = MESSAGE_HEAD.itemsize - 9
_HEAD = struct.Struct("<BQHIQQ")
_LEVEL = 2  # the next makes files of samples 3 % smaller and takes a quarter longer


class Packed(NamedTuple):
    """A chunk as it stands in a file. `indices`: by channel, its message index record."""

    start_time: int
    end_time: int
    record: bytes
    indices: dict[int, bytes]
    compressed_size: int
    uncompressed_size: int
    message_counts: dict[int, int]


def fill_heads(heads: NDArray[np.void], channel: int, payload_length: int, log_times: Integers) -> None:
    """Write the heads of messages of one topic, dtype `MESSAGE_HEAD`."""
    heads["opcode"] = Opcode.MESSAGE
    heads["length"] = _HEAD_COUNTED + payload_length
    heads["channel"] = channel
    heads["sequence"] = 0
    heads["log_time"] = heads["publish_time"] = log_times


class McapChunk:
    """Collects messages; deterministic, nothing in it depends on when or how fast it is filled."""

    def __init__(self) -> None:
        self._records = bytearray()
        self._indices: dict[int, list[Integers]] = {}

    def __bool__(self) -> bool:
        return bool(self._indices)

    @property
    def size(self) -> int:
        """Bytes that it holds, before they are compressed."""
        return len(self._records)

    def copy(self) -> McapChunk:
        """One with the same messages, to which others may be added."""
        other = McapChunk()
        other._records += self._records
        other._indices = {channel: [*parts] for channel, parts in self._indices.items()}
        return other

    def add_message(self, channel: int, log_time: int, payload: bytes) -> None:
        """Add one message."""
        chunk = self._records
        self._note(channel, np.array([(log_time, len(chunk))], np.uint64))
        chunk += _HEAD.pack(Opcode.MESSAGE, _HEAD_COUNTED + len(payload), channel, 0, log_time, log_time)
        chunk += payload

    def add_records(self, records: bytes, places: Mapping[int, tuple[Integers, Integers]]) -> None:
        """Add ready-made message records.

        Args:
            records: the bytes, heads as in `MESSAGE_HEAD`.
            places: of each channel its log times, rising, and where in `records` each record begins.
        """
        begin = np.uint64(len(self._records))
        for channel, (log_times, offsets) in places.items():
            self._note(channel, np.stack([log_times, offsets + begin], axis=1))
        self._records += records

    def _note(self, channel: int, entries: Integers) -> None:
        self._indices.setdefault(channel, []).append(entries)

    def packed(self) -> Packed:
        """The chunk compressed, with its indices; there has to be a message in it."""
        indices = {channel: np.concatenate(parts) for channel, parts in sorted(self._indices.items())}
        times = np.concatenate([entries[:, 0] for entries in indices.values()])
        content, start, end = bytes(self._records), int(times.min()), int(times.max())
        compressed = zstandard.compress(content, _LEVEL)
        builder = RecordBuilder()
        Chunk(
            compression="zstd",
            data=compressed,
            message_start_time=start,
            message_end_time=end,
            uncompressed_crc=zlib.crc32(content),
            uncompressed_size=len(content),
        ).write(builder)
        record: bytes = builder.end()  # type: ignore[no-untyped-call]
        return Packed(
            start,
            end,
            record,
            {channel: _index_record(channel, entries) for channel, entries in indices.items()},
            len(compressed),
            len(content),
            {channel: len(entries) for channel, entries in indices.items()},
        )


def _index_record(channel: int, entries: Integers) -> bytes:
    """Where a channel's messages lie in the chunk."""
    data = entries.astype("<u8").tobytes()
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + len(data), channel, len(data)) + data
