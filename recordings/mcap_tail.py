"""What a recording in the making holds beyond its last finished chunk, in a file beside it.

Chunks end where a minute of simulated time does, so that the same flight gives the same bytes; but a flight
may be paced by a clock, and then a minute is long to lose. So about twice a second on the wall what waits is
written here, as the chunk that it would be now, and moved into place whole: whenever the process is killed,
either the finished chunk or this one is there. It holds while the recording ends where it did. In a flight
faster than 120 times real time chunks are finished before, and none is written.
"""

from __future__ import annotations

import struct
import time
from pathlib import Path

from recordings.errors import RecordingError
from recordings.mcap_chunk import McapChunk

EVERY_S = 0.5
"""Wall time between tails."""

_MAGIC = b"\x89GWTAIL\n"
_POSITION = struct.Struct("<Q")


def tail_path(recording: Path) -> Path:
    """Where the tail of a recording in the making lies."""
    return recording.with_suffix(".tail")


class Tail:
    """Keeps the tail of one recording."""

    def __init__(self, recording: Path) -> None:
        self._path = tail_path(recording)
        self._due_s = time.monotonic() + EVERY_S

    @property
    def is_due(self) -> bool:
        """Whether what waits has to be kept now."""
        return time.monotonic() >= self._due_s

    def put_off(self) -> None:
        """Nothing waits: a chunk was finished."""
        self._due_s = time.monotonic() + EVERY_S

    def keep(self, position: int, chunk: McapChunk) -> None:
        """Put a chunk in place of what was kept; in the recording it comes at `position`.

        Raises:
            RecordingError: if it cannot be written.
        """
        if chunk:
            new = self._path.with_suffix(".tail-new")
            try:
                new.write_bytes(_MAGIC + _POSITION.pack(position) + chunk.packed().record)
                new.replace(self._path)
            except OSError as error:
                raise RecordingError(
                    f"cannot go on writing {self._path}: {error.strerror}; make room for it"
                ) from error
        self.put_off()

    def drop(self) -> None:
        """Take it away: everything is in the recording."""
        self._path.unlink(missing_ok=True)


def read_tail(recording: Path, position: int) -> bytes:
    """The chunk record that continues a recording intact to `position`; empty if there is none."""
    try:
        content = tail_path(recording).read_bytes()
    except OSError:
        return b""
    head = _MAGIC + _POSITION.pack(position)
    return content[len(head) :] if content.startswith(head) else b""
