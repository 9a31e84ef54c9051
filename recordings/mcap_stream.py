"""Takes an MCAP file apart, from its beginning to its end or to where it is damaged.

The mcap package's `StreamReader` makes objects of every message and index entry, several microseconds each;
here records are walked through, and only those in use are made objects, by the mcap package.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Metadata, Schema, Statistics
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

from recordings.errors import BadRecordingError

_RECORD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
_DAMAGE = (
    McapError,
    struct.error,
    zstandard.ZstdError,
    ValueError,  # checksums, and text that is not UTF-8
    OverflowError,
    MemoryError,
)


@dataclass(frozen=True, slots=True)
class McapContent:
    """What was found: payloads and type by topic, in the order written. `damage` says what ended it early."""

    messages: dict[str, list[bytes]]
    types: dict[str, str]
    metadata: dict[str, dict[str, str]]
    attachments: dict[str, bytes]
    damage: str


def take_apart(path: Path) -> McapContent:
    """Read all that is intact before the first damage; checksums and counts are checked.

    Raises:
        BadRecordingError: if the file cannot be read or is not MCAP.
    """
    try:
        with path.open("rb") as file:
            if file.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
                raise BadRecordingError(f"{path} is not an MCAP file; give the recording of a flight, *.mcap")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                return _Collector().collect(content)
    except OSError as error:
        raise BadRecordingError(f"cannot read the recording {path}: {error.strerror}") from error


@dataclass(slots=True)
class _Collector:
    """What was found so far. `takers`: by channel, the list of its topic's payloads."""

    messages: dict[str, list[bytes]] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    schemas: dict[int, str] = field(default_factory=lambda: {0: ""})
    takers: dict[int, list[bytes]] = field(default_factory=dict)
    ended: bool = False

    def collect(self, content: mmap.mmap) -> McapContent:
        """Walk through the whole file."""
        damage = ""
        try:
            self._walk(content, len(MCAP0_MAGIC))
            if not self.ended:
                damage = "the file is cut off"
        except _DAMAGE as error:
            damage = f"the file is cut off or damaged ({str(error) or type(error).__name__})"
        return McapContent(self.messages, self.types, self.metadata, self.attachments, damage)

    def _walk(self, content: bytes | mmap.mmap, begin: int) -> None:
        """Take the records of a file or of a chunk, one behind the other."""
        size = len(content)
        takers, message_start = self.takers, _MESSAGE.size
        while begin < size and not self.ended:
            opcode, length = _RECORD.unpack_from(content, begin)
            start = begin + _RECORD.size
            end = start + length
            if end > size:
                raise McapError(f"it ends {end - size} bytes too early")
            if opcode == Opcode.MESSAGE:
                channel, _, _, _ = _MESSAGE.unpack_from(content, start)
                if channel not in takers:
                    raise McapError(f"a message of an unknown topic, number {channel}")
                takers[channel].append(content[start + message_start : end])
            elif opcode == Opcode.FOOTER:
                self.ended = content[end:] == MCAP0_MAGIC
            elif opcode == Opcode.DATA_END:
                _compare_checksum(content, begin, DataEnd.read(_stream(content[start:end])))
            elif opcode in _TAKEN:
                self._take(opcode, _stream(content[start:end]))
            begin = end

    def _take(self, opcode: int, stream: ReadDataStream) -> None:
        """Take a record that is not a message."""
        if opcode == Opcode.CHUNK:
            chunk_stream, size = get_chunk_data_stream(Chunk.read(stream), validate_crc=True)
            self._walk(chunk_stream.read(size), 0)
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            self.schemas[schema.id] = schema.name
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            if channel.schema_id not in self.schemas:
                raise McapError(f"topic {channel.topic} has an unknown type")
            self.types[channel.topic] = self.schemas[channel.schema_id]
            self.takers[channel.id] = self.messages.setdefault(channel.topic, [])
        elif opcode == Opcode.METADATA:
            metadata = Metadata.read(stream)
            self.metadata[metadata.name] = metadata.metadata
        elif opcode == Opcode.ATTACHMENT:
            attachment = Attachment.read(stream)
            self.attachments[attachment.name] = attachment.data
        else:
            self._compare_counts(Statistics.read(stream))

    def _compare_counts(self, statistics: Statistics) -> None:
        """Compare what was found with what the writer counted."""
        for channel, count in statistics.channel_message_counts.items():
            found = len(self.takers.get(channel, ()))
            if found != count:
                raise McapError(f"{found} messages of topic number {channel}, where {count} were written")


_TAKEN = {
    Opcode.CHUNK,
    Opcode.SCHEMA,
    Opcode.CHANNEL,
    Opcode.METADATA,
    Opcode.ATTACHMENT,
    Opcode.STATISTICS,
}


def _stream(content: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(content))


def _compare_checksum(content: bytes | mmap.mmap, end: int, record: DataEnd) -> None:
    """Everything before the summary against the checksum behind it, if there is one."""
    if record.data_section_crc and zlib.crc32(memoryview(content)[:end]) != record.data_section_crc:
        raise McapError("its checksum is wrong")
