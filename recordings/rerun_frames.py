"""The tables in a Rerun file, one after the other, to its end or to where it is damaged.

Rerun's own reader takes a file as a whole or not at all, and where bits are flipped it may end the whole
process; so the frames are walked through here, and what is in them is read by Arrow.

A file is a header of 12 bytes, frames and a footer; a frame is kind and length, little-endian, and a message
of rerun.log_msg.v1alpha1, of which an `ArrowMsg` holds a table as an Arrow stream packed by LZ4. So it is in
files of Rerun 0.41, and the tests compare with its reader.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Iterator
from functools import cache
from typing import Any

import pyarrow as pa
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError

MAGIC = b"RRF2"

_HEADER_BYTES = 12
_FRAME = struct.Struct("<QQ")
_END, _ARROW, _LAST_KIND = 0, 2, 3
_LARGEST_RATIO = 255  # what LZ4 makes of one byte
_PLAIN, _LZ4 = 1, 2
_ARROW_FIELDS = (("compression", 2, "INT32"), ("uncompressed_size", 3, "UINT64"), ("payload", 5, "BYTES"))


class DamagedError(Exception):
    """Why no more can be read of a file."""


def tables(content: mmap.mmap) -> Iterator[pa.RecordBatch]:
    """The tables of a file; the entity is in their schema's metadata.

    Raises:
        DamagedError: at the end of what is whole, unless it is the end of the file.
    """
    begin, size = _HEADER_BYTES, len(content)
    while begin + _FRAME.size <= size:
        kind, length = _FRAME.unpack_from(content, begin)
        start = begin + _FRAME.size
        if kind > _LAST_KIND:
            raise DamagedError(f"the file is damaged (a frame of kind {kind})")
        if length > size - start:
            break
        if kind == _END:
            return
        if kind == _ARROW:
            yield _table(content[start : start + length])
        begin = start + length
    raise DamagedError("the file is cut off")


def _table(frame: bytes) -> pa.RecordBatch:
    try:
        message = _arrow_message().FromString(frame)
        payload = pa.py_buffer(message.payload)
        if message.compression == _LZ4:
            payload = _unpacked(payload, message.uncompressed_size)
        elif message.compression != _PLAIN:
            raise DamagedError(f"the file is damaged (a frame of compression {message.compression})")
        with pa.ipc.open_stream(payload) as stream:
            table = stream.read_next_batch()
        table.validate(full=True)
    except (DecodeError, pa.ArrowException, OSError, ValueError, StopIteration) as error:
        raise DamagedError(f"the file is damaged ({_first_line(error)})") from error
    return table


def _unpacked(payload: pa.Buffer, size: int) -> pa.Buffer:
    if size > payload.size * _LARGEST_RATIO:
        raise DamagedError("the file is damaged (a frame says that it holds more than it can)")
    return pa.Codec("lz4_raw").decompress(payload, decompressed_size=size)


def _first_line(error: BaseException) -> str:
    return str(error).partition("\n")[0] or type(error).__name__


@cache
def _arrow_message() -> Any:
    """The type of `ArrowMsg`, as far as it is read here."""
    file = descriptor_pb2.FileDescriptorProto(
        name="galeway/arrow_msg.proto", package="galeway.rerun", syntax="proto3"
    )
    message = file.message_type.add(name="ArrowMsg")
    for name, number, kind in _ARROW_FIELDS:
        message.field.add(name=name, number=number, type=f"TYPE_{kind}", label="LABEL_OPTIONAL")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("galeway.rerun.ArrowMsg"))
