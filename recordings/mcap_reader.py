"""Reads a recording back from MCAP, also one that was cut off."""

from __future__ import annotations

from pathlib import Path

from recordings.decoding import decode
from recordings.mcap_stream import take_apart
from recordings.recording import Recording


def read(path: Path) -> Recording:
    """Read all of a recording that is intact.

    Raises:
        BadRecordingError: see `mcap_stream.take_apart` and `decoding.decode`.
    """
    return decode(take_apart(path), path)
