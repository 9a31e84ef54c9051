"""What to say of a recording that cannot be read, and which one may have been meant."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from recordings.errors import BadRecordingError

_SUFFIXES = (".mcap", ".rrd")
_MOST = 3


def unreadable(path: Path, error: OSError) -> BadRecordingError:
    """The error to raise for a file that the system does not give out; it names those that are there."""
    return BadRecordingError(f"cannot read the recording {path}: {error.strerror}{_meant(path)}")


def _meant(path: Path) -> str:
    folder = path if path.is_dir() else path.parent
    names = sorted(one.name for one in folder.glob("*") if one.suffix in _SUFFIXES)
    if path.is_dir():
        in_it = (
            f"a file in it: {_listed(folder, names)}" if names else "the file of a flight, *.mcap or *.rrd"
        )
        return f"; give {in_it}"
    left = f"{path.stem}.partial{path.suffix}"
    if left in names:
        remedy = (
            f"; `galeway repair {folder / left}` makes a whole file of it" if path.suffix == ".mcap" else ""
        )
        return f"; the flight was stopped, and left {folder / left}{remedy}"
    near = get_close_matches(path.name, names, _MOST)
    return f"; did you mean {_listed(folder, near)}?" if near else ""


def _listed(folder: Path, names: list[str]) -> str:
    shown = [str(folder / name) for name in names[:_MOST]]
    return " or ".join(shown) + (" or another" if len(names) > _MOST else "")
