"""Measured envelopes, kept in the user's cache; a missing or broken entry is measured anew."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec
import platformdirs

from aircraft.envelope import Envelope

FOLDER_VARIABLE = "GALEWAY_CACHE"
"""Environment variable that names another folder."""


def folder() -> Path:
    """Where envelopes are kept."""
    named = os.environ.get(FOLDER_VARIABLE)
    return (Path(named) if named else platformdirs.user_cache_path("galeway")) / "envelopes"


def recall(key: str) -> Envelope | None:
    """The envelope stored under a key, if there is a whole one."""
    try:
        return msgspec.json.decode(_path(key).read_bytes(), type=Envelope)
    except (OSError, msgspec.DecodeError):
        return None


def store(key: str, envelope: Envelope) -> None:
    """Keep an envelope; where nothing can be written, nothing is kept."""
    path = _path(key)
    partial = path.with_suffix(f".{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(msgspec.json.encode(envelope))
        partial.replace(path)
    except OSError:
        pass


def _path(key: str) -> Path:
    return folder() / f"{key}.json"
