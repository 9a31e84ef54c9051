"""What every machine of a cluster has to have in common with the one that leads the campaign."""

from __future__ import annotations

import hashlib
import math
import os
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from sim.provenance import source_sha256, versions

_MOST_FILES = 100
_SAMPLE_BYTES = 1 << 20

Mark = tuple[int, str]
"""A file's size, and a digest of its two ends."""


@dataclass(frozen=True, slots=True)
class Premises:
    """Versions, the files that are read, and a folder that is written to.

    It travels with every chunk, and workers look at it when they begin: so of `files` there are a hundred at
    most, and of each its size and a digest of its two ends. A folder that has the same name but is not shared
    is found out by a file in it that is among them.
    """

    versions: tuple[tuple[str, str], ...]
    files: tuple[tuple[Path, Mark], ...] = ()
    folder: Path | None = None

    @classmethod
    def here(cls, reads: Iterable[Path] = (), writes: Path | None = None) -> Premises:
        """As they are on this machine.

        Raises:
            OSError: if a file cannot be read.
        """
        paths = sorted({path.absolute() for path in reads})
        every = max(math.ceil(len(paths) / _MOST_FILES), 1)
        files = tuple((path, _mark(path)) for path in paths[::every])
        return cls(tuple(_versions().items()), files, None if writes is None else writes.absolute())

    @property
    def of_versions(self) -> Premises:
        """The part that has nothing to do with files."""
        return Premises(self.versions)

    def complaints(self) -> tuple[str, ...]:
        """What is otherwise on the machine that this is called on."""
        return (*_other_versions(dict(self.versions)), *self._other_files(), *self._unwritable())

    def _other_files(self) -> Iterable[str]:
        for path, mark in self.files:
            try:
                found = _mark(path)
            except OSError as error:
                yield f"it cannot read {path} ({error.strerror})"
                continue
            if found != mark:
                yield f"its {path} is another file ({found[0]} bytes, here {mark[0]})"

    def _unwritable(self) -> Iterable[str]:
        if self.folder is None:
            return
        try:
            with tempfile.TemporaryFile(dir=self.folder):
                pass
        except OSError as error:
            yield f"it cannot write to {self.folder} ({error.strerror})"


def _other_versions(wanted: Mapping[str, str]) -> Iterable[str]:
    found = _versions()
    for name, version in wanted.items():
        if found.get(name) != version:
            yield f"{name} is {found.get(name) or 'missing'} there and {version or 'missing'} here"


@cache
def _versions() -> dict[str, str]:
    """Of all that decides a flight's bytes; galeway's source itself, too, whose version says less."""
    return versions() | {"galeway's source": source_sha256()[:12]}


def _mark(path: Path) -> Mark:
    """Of a file; of a folder, such as a Zarr store, that of its files' names."""
    if path.is_dir():
        names = "\n".join(sorted(inner.relative_to(path).as_posix() for inner in path.rglob("*")))
        return len(names), hashlib.sha256(names.encode()).hexdigest()
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size  # on a network's disk `stat` may tell of before it was opened
        ends = file.read(_SAMPLE_BYTES)
        file.seek(max(size - _SAMPLE_BYTES, 0))
        ends += file.read(_SAMPLE_BYTES)
    return size, hashlib.sha256(ends).hexdigest()
