"""The files that a scenario names, and whether they are still what they were."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from msgspec import Struct

from aircraft.description import load_aircraft
from sim.scenario import LoadedScenario
from sim.weather.opening import found_files


class FileMark(Struct, frozen=True):
    """What tells a file from another: its content; size and time of change say when to look at that again."""

    size_bytes: int
    changed_ns: int
    sha256: str


def named_files(loaded: LoadedScenario) -> Iterator[Path]:
    """Weather, hazards, and the parts of an aircraft that did not come with galeway; folders file by file.

    Raises:
        SimError: if one is missing; AircraftError for an aircraft.
    """
    weather, folder = loaded.scenario.weather, loaded.folder
    of_hazards = [getattr(table, "file", None) for table in loaded.scenario.hazard.also]
    for name in (weather.file, weather.truth.file, *of_hazards):
        if name is not None:
            for path in found_files(name, folder):
                yield from _whole(path)
    aircraft = load_aircraft(loaded.scenario.aircraft.model, beside=folder)
    if not aircraft.built_in:
        yield from _whole(aircraft.path)


def _whole(path: Path) -> Iterator[Path]:
    if path.is_dir():  # Zarr, an aircraft
        yield from sorted(inner for inner in path.rglob("*") if inner.is_file())
    else:
        yield path


def marks_of(paths: Iterable[Path], known: Mapping[str, FileMark]) -> dict[str, FileMark]:
    """The marks of files by their absolute paths; of one that was not touched since, the known one."""
    return {str(path): _mark(path, known.get(str(path))) for path in {path.absolute() for path in paths}}


def _mark(path: Path, known: FileMark | None) -> FileMark:
    status = path.stat()
    if known and (known.size_bytes, known.changed_ns) == (status.st_size, status.st_mtime_ns):
        return known
    with path.open("rb") as file:
        return FileMark(status.st_size, status.st_mtime_ns, hashlib.file_digest(file, "sha256").hexdigest())
