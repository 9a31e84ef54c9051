"""The container by the book: https://mcap.dev/spec, read record by record."""

import struct
import zlib
from itertools import pairwise

import pytest
from mcap.reader import make_reader
from mcap.records import Chunk, Message, MessageIndex
from mcap.stream_reader import StreamReader, get_chunk_data_stream


@pytest.fixture(scope="module")
def path(kept):
    return kept.file(kept.fly(kept.header(kept.straight)))


def test_every_message_is_where_its_index_says(path):
    with path.open("rb") as stream:
        records = list(StreamReader(stream, emit_chunks=True, validate_crcs=True).records)
    content, indexed, counted = b"", 0, 0
    for record in records:
        if isinstance(record, Chunk):
            source, size = get_chunk_data_stream(record, validate_crc=True)
            content = source.read(size)
        elif isinstance(record, MessageIndex):
            for log_time, offset in record.records:
                opcode, _, channel, _, found = struct.unpack_from("<BQHIQ", content, offset)
                assert (opcode, channel, found) == (5, record.channel_id, log_time)
                indexed += 1
    with path.open("rb") as stream:
        counted = sum(isinstance(record, Message) for record in StreamReader(stream).records)
    assert indexed == counted > 8000


def test_message_indices_are_where_the_summary_says(path):
    content = path.read_bytes()
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    for chunk in summary.chunk_indexes:
        assert content[chunk.chunk_start_offset] == 6
        end = chunk.chunk_start_offset + chunk.chunk_length
        assert sorted(chunk.message_index_offsets.values())[0] == end
        for channel, offset in chunk.message_index_offsets.items():
            assert struct.unpack_from("<BQH", content, offset)[::2] == (7, channel)


def test_the_checksum_of_the_summary(path):
    content = path.read_bytes()
    footer = len(content) - 8 - 20 - 9
    opcode, length, start, offset_start, checksum = struct.unpack_from("<BQQQI", content, footer)
    assert (opcode, length) == (2, 20)
    assert start < offset_start < footer
    assert checksum == zlib.crc32(content[start : footer + 9 + 16])


def test_the_table_of_contents_of_the_summary(path):
    content = path.read_bytes()
    footer = len(content) - 8 - 20 - 9
    offset = struct.unpack_from("<Q", content, footer + 17)[0]
    groups = []
    while offset < footer:
        opcode, length, group, start, size = struct.unpack_from("<BQBQQ", content, offset)
        assert (opcode, length) == (14, 17)
        assert content[start] == group
        groups.append((start, size))
        offset += 26
    assert all(start + size == after for (start, size), (after, _) in pairwise(groups))
    assert len(groups) == 6
