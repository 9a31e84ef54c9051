"""Files that are on the disk, whole, when they have their name."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


@contextmanager
def durably(path: Path) -> Iterator[BinaryIO]:
    """A file that is written under another name, and takes the place of `path` when it is there to stay."""
    partial = path.with_suffix(f".partial{path.suffix}")
    with partial.open("wb") as file:
        yield file
    sync(partial)
    partial.replace(path)
    sync(path.parent)


def sync(path: Path) -> None:
    """Have what was written of a file, or the names in a folder, on the disk."""
    if path.is_dir() and os.name == "nt":
        return  # where folders cannot be opened
    descriptor = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
