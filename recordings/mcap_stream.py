"""Takes an MCAP file apart, from its beginning to its end or to where it is damaged.

The mcap package's `StreamReader` makes objects of every message and index entry, several microseconds each;
here records are walked through, and only those in use are made objects, by the mcap package.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from contextlib import suppress
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Footer, Metadata, Schema, Statistics
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

from recordings.content import Content
from recordings.errors import BadRecordingError
from recordings.mcap_tail import read_tail
from recordings.schema import STATE
from recordings.unreadable import unreadable

_RECORD = struct.Struct("<BQ")
_LARGEST_CHUNK = 1 << 28  # of other writers; those of galeway are of a quarter of a megabyte
_FOOTER_CHECKED = 16  # where the summary and, in it, the table of contents begin
HEAD = struct.Struct("<HIQQ")
"""What stands before the payload of a message: channel, sequence, log time, publish time."""

_DAMAGE = (
    McapError,
    struct.error,
    zstandard.ZstdError,
    ValueError,  # checksums, and text that is not UTF-8
    OverflowError,
    MemoryError,
)


def take_apart(path: Path) -> Content:
    """Read all that is intact, behind chunks that are damaged, too; checksums and counts are checked.

    Raises:
        BadRecordingError: if the file cannot be read or is not MCAP.
    """
    found = collect(path)
    return Content(
        found.messages,
        found.types,
        found.metadata,
        found.attachments,
        found.damage,
        samples_before_damage=found.samples_before_damage,
    )


def collect(path: Path, *, heads: bool = False) -> Collector:
    """The same, with all that another file of the same content needs; and what was kept beside the file.

    Args:
        path: the file.
        heads: whether messages are kept with what stands before their payloads, `HEAD`.

    Raises:
        BadRecordingError: as above.
    """
    collector = Collector(0 if heads else HEAD.size)
    try:
        with path.open("rb") as file:
            if file.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
                raise BadRecordingError(f"{path} is not an MCAP file; give the recording of a flight, *.mcap")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                collector.collect(content)
    except OSError as error:
        raise unreadable(path, error) from error
    if not collector.ended:
        collector.add(read_tail(path, collector.intact))
    return collector


@dataclass(slots=True)
class Collector:
    """What was found so far, by topic.

    `skipped`: bytes left out at the beginning of each message. `damage`: what ended it or is lost of it,
    empty if nothing. `intact`: where in the file the last record ends that is whole. `takers`: by channel,
    the list of its topic's messages. `lost`: what is wrong with chunks that were left out;
    `samples_before_damage`: how many messages of /state came before the first of them, None if there is none.
    `proven`: a checksum of all messages says that they are as they were written.
    """

    skipped: int
    messages: dict[str, list[bytes]] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)
    channels: dict[str, Channel] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=lambda: {0: Schema(0, b"", "", "")})
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    attached: dict[str, Attachment] = field(default_factory=dict)
    takers: dict[int, list[bytes]] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)
    samples_before_damage: int | None = None
    data_ended: bool = False
    proven: bool = False
    ended: bool = False
    intact: int = 0
    damage: str = ""

    def collect(self, content: mmap.mmap) -> None:
        """Walk through the whole file."""
        try:
            self._walk(content, len(MCAP0_MAGIC), whole=True)
            if not self.ended:
                self.damage = "the file is cut off"
        except _DAMAGE as error:
            self.damage = f"the file is cut off or damaged ({_said(error)})"
        self.damage = "; ".join(filter(None, (*self.lost, self.damage)))

    def add(self, records: bytes) -> None:
        """Take records from elsewhere; of those that are damaged nothing."""
        with suppress(*_DAMAGE):
            self._walk(records, 0, whole=True)

    def _walk(self, content: bytes | mmap.mmap, begin: int, *, whole: bool) -> None:
        """Take the records of a file, the `whole` of it, or of a chunk, one behind the other."""
        size = len(content)
        takers, skipped = self.takers, self.skipped
        while begin < size and not self.ended:
            opcode, length = _RECORD.unpack_from(content, begin)
            start = begin + _RECORD.size
            end = start + length
            if end > size:
                raise McapError(f"it has {size} bytes, and the record at byte {begin} goes on beyond them")
            if opcode == Opcode.MESSAGE:
                channel, _, _, _ = HEAD.unpack_from(content, start)
                if channel not in takers:
                    raise McapError(f"a message of an unknown topic, number {channel}")
                takers[channel].append(content[start + skipped : end])
            elif not whole and opcode in _OUTER:
                raise McapError(f"a chunk with a record of kind {opcode} in it")
            elif opcode == Opcode.FOOTER:
                if not self.data_ended:
                    raise McapError("the end of its data is not marked")
                _compare_summary(content, begin, Footer.read(_stream(content[start:end])))
                self.ended = content[end:] == MCAP0_MAGIC
            elif opcode == Opcode.DATA_END:
                self.data_ended = True
                if not self.lost:
                    self.proven = _checked(content, begin, DataEnd.read(_stream(content[start:end])))
            elif opcode == Opcode.CHUNK:
                self._take_chunk(content, begin, end)
            elif opcode in _TAKEN:
                self._take(opcode, _stream(content[start:end]))
            begin = end
            if whole:
                self.intact = end

    def _take_chunk(self, content: bytes | mmap.mmap, begin: int, end: int) -> None:
        """Take the records of a chunk; one that is damaged is left out if the file goes on behind it."""
        try:
            records = _decompressed(Chunk.read(_stream(content[begin + _RECORD.size : end])))
        except _DAMAGE as error:
            if not _record_at(content, end):
                raise
            self.lost.append(f"the chunk at byte {begin} is damaged ({_said(error)})")
            if self.samples_before_damage is None:
                self.samples_before_damage = len(self.messages.get(STATE.name, ()))
        else:
            self._walk(records, 0, whole=False)

    def _take(self, opcode: int, stream: ReadDataStream) -> None:
        """Take a record that is neither a message nor a chunk."""
        if opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            self.schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            if channel.schema_id not in self.schemas:
                raise McapError(f"topic {channel.topic} has an unknown type")
            self.types[channel.topic] = self.schemas[channel.schema_id].name
            self.channels[channel.topic] = channel
            self.takers[channel.id] = self.messages.setdefault(channel.topic, [])
        elif opcode == Opcode.METADATA:
            metadata = Metadata.read(stream)
            self.metadata[metadata.name] = metadata.metadata
        elif opcode == Opcode.ATTACHMENT:
            attachment = Attachment.read(stream)
            self.attachments[attachment.name] = attachment.data
            self.attached[attachment.name] = attachment
        elif not self.lost:
            self._compare_counts(Statistics.read(stream))

    def _compare_counts(self, statistics: Statistics) -> None:
        """Compare what was found with what the writer counted."""
        for channel, count in statistics.channel_message_counts.items():
            found = len(self.takers.get(channel, ()))
            if found != count:
                raise McapError(f"{found} messages of topic number {channel}, where {count} were written")


_TAKEN = {
    Opcode.SCHEMA,
    Opcode.CHANNEL,
    Opcode.METADATA,
    Opcode.ATTACHMENT,
    Opcode.STATISTICS,
}

_OUTER = {Opcode.CHUNK, Opcode.FOOTER, Opcode.DATA_END}
"""Records that stand in no chunk."""


def _decompressed(chunk: Chunk) -> bytes:
    """The records of a chunk, of no more memory than it says, and that within reason."""
    size = chunk.uncompressed_size
    if chunk.compression == "zstd":
        size = max(size, zstandard.frame_content_size(chunk.data))
    if size > _LARGEST_CHUNK:
        raise McapError(f"a chunk of {size} bytes, where at most {_LARGEST_CHUNK} are read")
    stream, length = get_chunk_data_stream(chunk, validate_crc=True)
    content: bytes = stream.read(length)
    return content


def _stream(content: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(content))


def _checked(content: bytes | mmap.mmap, end: int, record: DataEnd) -> bool:
    """Everything before the summary against the checksum behind it; whether there is one."""
    if record.data_section_crc and zlib.crc32(memoryview(content)[:end]) != record.data_section_crc:
        raise McapError("its checksum is wrong")
    return record.data_section_crc != 0


def _compare_summary(content: bytes | mmap.mmap, footer_at: int, footer: Footer) -> None:
    """The summary and where the footer says it is against the footer's checksum, if there is one."""
    begin = footer.summary_start or footer_at
    checked = memoryview(content)[begin : footer_at + _RECORD.size + _FOOTER_CHECKED]
    if footer.summary_crc and (begin > footer_at or zlib.crc32(checked) != footer.summary_crc):
        raise McapError("the checksum of its summary is wrong")


def _record_at(content: bytes | mmap.mmap, begin: int) -> bool:
    """Whether a record of a known kind begins there and ends within the file."""
    if begin + _RECORD.size > len(content):
        return False
    opcode, length = _RECORD.unpack_from(content, begin)
    known: bool = Opcode.HEADER <= opcode <= Opcode.DATA_END
    return known and begin + _RECORD.size + length <= len(content)


def _said(error: Exception) -> str:
    return str(error) or type(error).__name__
