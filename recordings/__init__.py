"""Recordings of a flight: schema, writers and readers, tracking report and limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from recordings.recording import Recording


def open(path: str | Path) -> Recording:  # noqa: A001 (read as `recordings.open`)
    """Read a recording: all of it, or all of it that is intact.

    Args:
        path: the file of a flight, finished or not, MCAP or Rerun; what it is decides, not its name.

    Raises:
        recordings.errors.BadRecordingError: if the file is no recording of galeway, or too little of it is
            left: what was known before take-off and a sample of the flight are the least.
    """
    path = Path(path)
    if _begins_with(path, b"RRF2"):
        from recordings.rerun_reader import read
    else:
        from recordings.mcap_reader import read
    return read(path)


def _begins_with(path: Path, magic: bytes) -> bool:
    """Whether it is a file that does; what is wrong with another its reader says."""
    try:
        with path.open("rb") as file:
            return file.read(len(magic)) == magic
    except OSError:
        return False
