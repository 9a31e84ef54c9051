"""An MCAP file being written: the container, without a word about what is in it.

Messages come in chunks, see `mcap_chunk`; the records around them are the mcap package's own. See
https://mcap.dev/spec.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import BinaryIO

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
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

from recordings.errors import RecordingError
from recordings.mcap_chunk import McapChunk

_FOOTER_LENGTH = 8 + 8 + 4


class McapFile:
    """Writes records to a stream; deterministic, nothing in it depends on when or how fast it is written."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._position = 0
        self._crc = 0
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

    def add_channel(self, topic: str, schema_id: int, metadata: Mapping[str, str]) -> int:
        """Declare a topic; returns its id."""
        channel = Channel(
            id=len(self._channels) + 1,
            topic=topic,
            message_encoding="protobuf",
            metadata=dict(sorted(metadata.items())),
            schema_id=schema_id,
        )
        self._channels.append(channel)
        self._write_record(channel)
        return channel.id

    @property
    def position(self) -> int:
        """Bytes that were written."""
        return self._position

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

    def add_chunk(self, chunk: McapChunk) -> None:
        """Write a chunk, if there is a message in it, and hand it to the operating system."""
        if not chunk:
            return
        packed, chunk_offset = chunk.packed(), self._position
        self._write(packed.record)
        index_offset, index_offsets = self._position, {}
        for channel, index in packed.indices.items():
            index_offsets[channel] = self._position
            self._write(index)
        self._chunk_indices.append(
            ChunkIndex(
                message_start_time=packed.start_time,
                message_end_time=packed.end_time,
                chunk_start_offset=chunk_offset,
                chunk_length=len(packed.record),
                message_index_offsets=index_offsets,
                message_index_length=self._position - index_offset,
                compression="zstd",
                compressed_size=packed.compressed_size,
                uncompressed_size=packed.uncompressed_size,
            )
        )
        for channel, count in packed.message_counts.items():
            self._message_counts[channel] = self._message_counts.get(channel, 0) + count
        self._flush()

    def finish(self) -> None:
        """Write the summary; the stream stays open."""
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
