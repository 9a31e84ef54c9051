"""An MCAP file being written: the container, without a word about what is in it.

The mcap package's own `Writer` takes every message singly (10 microseconds each, where the simulation of a
tenth of a second takes 80); here records come many at a time, ready made. The records around them are the
mcap package's own. See https://mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping, Sequence
from typing import BinaryIO

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC
from numpy.typing import NDArray

from recordings.errors import RecordingError

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
_FOOTER_LENGTH = 8 + 8 + 4
_LEVEL = 2  # the next makes files of samples 3 % smaller and takes a quarter longer


def fill_heads(heads: NDArray[np.void], channel: int, payload_length: int, log_times: Integers) -> None:
    """Write the heads of messages of one topic, dtype `MESSAGE_HEAD`."""
    heads["opcode"] = Opcode.MESSAGE
    heads["length"] = _HEAD_COUNTED + payload_length
    heads["channel"] = channel
    heads["sequence"] = 0
    heads["log_time"] = heads["publish_time"] = log_times


class McapFile:
    """Writes records to a stream; deterministic, nothing in it depends on when or how fast it is written."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._position = 0
        self._crc = 0
        self._compressor = zstandard.ZstdCompressor(level=_LEVEL)
        self._chunk = bytearray()
        self._indices: dict[int, list[Integers]] = {}
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._chunk_indices: list[ChunkIndex] = []
        self._attachment_indices: list[AttachmentIndex] = []
        self._metadata_indices: list[MetadataIndex] = []
        self._message_counts: dict[int, int] = {}
        self._write(MCAP0_MAGIC)
        self._write_record(Header(profile="", library="galeway"))

    def add_schema(self, name: str, descriptor_set: bytes) -> int:
        """Declare a protobuf message type; returns its id."""
        schema = Schema(id=len(self._schemas) + 1, data=descriptor_set, encoding="protobuf", name=name)
        self._schemas.append(schema)
        self._write_record(schema)
        return schema.id

    def add_channel(self, topic: str, schema_id: int) -> int:
        """Declare a topic; returns its id."""
        channel = Channel(
            id=len(self._channels) + 1,
            topic=topic,
            message_encoding="protobuf",
            metadata={},
            schema_id=schema_id,
        )
        self._channels.append(channel)
        self._write_record(channel)
        return channel.id

    def add_metadata(self, name: str, content: Mapping[str, str]) -> None:
        """Write a metadata record, its keys in order."""
        offset = self._position
        length = self._write_record(Metadata(name=name, metadata=dict(sorted(content.items()))))
        self._metadata_indices.append(MetadataIndex(offset=offset, length=length, name=name))

    def add_attachment(self, log_time: int, name: str, media_type: str, content: bytes) -> None:
        """Write an attached file."""
        offset = self._position
        length = self._write_record(
            Attachment(create_time=0, log_time=log_time, name=name, media_type=media_type, data=content)
        )
        self._attachment_indices.append(
            AttachmentIndex(
                offset=offset,
                length=length,
                create_time=0,
                log_time=log_time,
                data_size=len(content),
                name=name,
                media_type=media_type,
            )
        )

    def add_message(self, channel: int, log_time: int, payload: bytes) -> None:
        """Add one message to the chunk in progress."""
        self.add_messages(channel, [log_time], [payload])

    def add_messages(self, channel: int, log_times: Sequence[int], payloads: Sequence[bytes]) -> None:
        """Add messages of one topic, in the order of their times, to the chunk in progress."""
        chunk, entries = self._chunk, []
        for log_time, payload in zip(log_times, payloads, strict=True):
            entries.append((log_time, len(chunk)))
            chunk += _HEAD.pack(Opcode.MESSAGE, _HEAD_COUNTED + len(payload), channel, 0, log_time, log_time)
            chunk += payload
        self._note(channel, np.array(entries, np.uint64))

    def add_records(self, records: bytes, places: Mapping[int, tuple[Integers, Integers]]) -> None:
        """Add ready-made message records to the chunk in progress.

        Args:
            records: the bytes, heads as in `MESSAGE_HEAD`.
            places: of each channel its log times, rising, and where in `records` each record begins.
        """
        begin = np.uint64(len(self._chunk))
        for channel, (log_times, offsets) in places.items():
            self._note(channel, np.stack([log_times, offsets + begin], axis=1))
        self._chunk += records

    def _note(self, channel: int, entries: Integers) -> None:
        self._indices.setdefault(channel, []).append(entries)
        self._message_counts[channel] = self._message_counts.get(channel, 0) + len(entries)

    def finish_chunk(self) -> None:
        """Compress the chunk in progress and hand it to the operating system."""
        if not self._indices:
            return
        indices = {channel: np.concatenate(parts) for channel, parts in sorted(self._indices.items())}
        times = np.concatenate([entries[:, 0] for entries in indices.values()])
        content, start, end = bytes(self._chunk), int(times.min()), int(times.max())
        compressed = self._compressor.compress(content)
        chunk = Chunk(
            compression="zstd",
            data=compressed,
            message_start_time=start,
            message_end_time=end,
            uncompressed_crc=zlib.crc32(content),
            uncompressed_size=len(content),
        )
        chunk_offset = self._position
        chunk_length = self._write_record(chunk)
        index_offset = self._position
        index_offsets = {channel: self._write_index(channel, entries) for channel, entries in indices.items()}
        self._chunk_indices.append(
            ChunkIndex(
                message_start_time=start,
                message_end_time=end,
                chunk_start_offset=chunk_offset,
                chunk_length=chunk_length,
                message_index_offsets=index_offsets,
                message_index_length=self._position - index_offset,
                compression="zstd",
                compressed_size=len(compressed),
                uncompressed_size=len(content),
            )
        )
        self._flush()
        self._chunk.clear()
        self._indices.clear()

    def _write_index(self, channel: int, entries: Integers) -> int:
        """Write where a channel's messages lie in the chunk; returns where that is written."""
        offset = self._position
        data = entries.astype("<u8").tobytes()
        self._write(struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + len(data), channel, len(data)) + data)
        return offset

    def finish(self) -> None:
        """Write the summary; the stream stays open."""
        self.finish_chunk()
        self._write_record(DataEnd(data_section_crc=self._crc))
        summary_start, offset_start, summary = self._summary()
        footer = struct.pack("<BQQQ", Opcode.FOOTER, _FOOTER_LENGTH, summary_start, offset_start)
        self._write(summary)
        self._write_record(
            Footer(
                summary_start=summary_start,
                summary_offset_start=offset_start,
                summary_crc=zlib.crc32(footer, zlib.crc32(summary)),
            )
        )
        self._write(MCAP0_MAGIC)
        self._flush()

    def _summary(self) -> tuple[int, int, bytes]:
        """Where the summary and, in it, its table of contents begin, and its bytes."""
        start, builder, contents = self._position, RecordBuilder(), []
        groups: tuple[tuple[Opcode, list[McapRecord]], ...] = (
            (Opcode.SCHEMA, [*self._schemas]),
            (Opcode.CHANNEL, [*self._channels]),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, [*self._chunk_indices]),
            (Opcode.ATTACHMENT_INDEX, [*self._attachment_indices]),
            (Opcode.METADATA_INDEX, [*self._metadata_indices]),
        )
        for opcode, records in groups:
            begin = builder.count
            for record in records:
                record.write(builder)
            if records:
                contents.append(
                    SummaryOffset(
                        group_opcode=opcode, group_start=start + begin, group_length=builder.count - begin
                    )
                )
        offset_start = start + builder.count
        for content in contents:
            content.write(builder)
        summary: bytes = builder.end()  # type: ignore[no-untyped-call]
        return start, offset_start, summary

    def _statistics(self) -> Statistics:
        chunks = self._chunk_indices
        return Statistics(
            attachment_count=len(self._attachment_indices),
            channel_count=len(self._channels),
            channel_message_counts=dict(sorted(self._message_counts.items())),
            chunk_count=len(chunks),
            message_count=sum(self._message_counts.values()),
            message_start_time=min((chunk.message_start_time for chunk in chunks), default=0),
            message_end_time=max((chunk.message_end_time for chunk in chunks), default=0),
            metadata_count=len(self._metadata_indices),
            schema_count=len(self._schemas),
        )

    def _write_record(self, record: McapRecord) -> int:
        """Write a record; returns its length."""
        builder = RecordBuilder()
        record.write(builder)
        data: bytes = builder.end()  # type: ignore[no-untyped-call]
        self._write(data)
        return len(data)

    def _flush(self) -> None:
        try:
            self._stream.flush()
        except OSError as error:
            raise self._stuck(error) from error

    def _stuck(self, error: OSError) -> RecordingError:
        return RecordingError(f"cannot go on writing {self._stream.name}: {error.strerror}; make room for it")

    def _write(self, data: bytes) -> None:
        try:
            self._stream.write(data)
        except OSError as error:
            raise self._stuck(error) from error
        self._position += len(data)
        self._crc = zlib.crc32(data, self._crc)
