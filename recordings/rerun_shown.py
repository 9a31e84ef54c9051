"""What is to be shown, as one Rerun file: a recording as it is, made whole, or drawn anew."""

from __future__ import annotations

import subprocess
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa
from rerun.chunk import RrdReader
from rerun.error_utils import RerunWarning

import recordings
from recordings.errors import BadRecordingError
from recordings.limits import judge, parse_limits
from recordings.overlay import overlaid
from recordings.playback import play
from recordings.recording import Recording
from recordings.rerun_overlay import record_overlay
from recordings.rerun_times import TIMELINE
from recordings.rerun_writer import RerunRecorder
from recordings.tracking import track
from recordings.unreadable import unreadable
from recordings.viewer_program import viewer

Say = Callable[[str], object]

_MAGIC = b"RRF2"
_APPLICATION = "galeway"
_MOVING = ["/state", "/chart/**"]
"""What is written as long as a flight lasts."""


@contextmanager
def shown(paths: Sequence[Path], say: Say) -> Iterator[Path]:
    """A Rerun file that shows recordings; what had to be made for it is gone when the block ends.

    Args:
        paths: recordings of galeway, MCAP or Rerun; several are laid over each other.
        say: told what is lacking.

    Raises:
        RecordingError: if one of them is no recording of galeway, nothing is left of it, or several do not go
            together.
    """
    with TemporaryDirectory(prefix="galeway-") as folder:
        yield _made(paths, Path(folder), say)


def _made(paths: Sequence[Path], folder: Path, say: Say) -> Path:
    if len(paths) > 1:
        flights = overlaid([(path, _read(path, say)) for path in paths])
        made = folder / "overlay.rrd"
        record_overlay(flights, made)
        return made
    (path,) = paths
    return _whole(path, folder, say) if _is_rerun(path) else _drawn(path, folder, say)


def last_time_s(path: Path) -> float:
    """When the flight in a whole Rerun file ended, since departure."""
    ends_s = [
        float(np.max(chunk.to_record_batch().column(TIMELINE).cast(pa.int64()).to_numpy())) / 1e9
        for chunk in RrdReader(path).stream().filter(content=_MOVING)
        if TIMELINE in chunk.timeline_names
    ]
    return max(ends_s)


def _is_rerun(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            return stream.read(len(_MAGIC)) == _MAGIC
    except OSError as error:
        raise unreadable(path, error) from error


def _drawn(path: Path, folder: Path, say: Say) -> Path:
    """An MCAP recording drawn as its flight's own Rerun recording was."""
    recording, drawn = _read(path, say), folder / f"{path.stem}.rrd"
    recorder = RerunRecorder(drawn, judged=True)
    play(recording, recorder)
    limits = parse_limits(recording.limits)
    recorder.verdicts(judge(track(recording), limits) if limits else [])
    return drawn


def _read(path: Path, say: Say) -> Recording:
    recording = recordings.open(path)
    if not recording.complete:
        say(f"{path} is incomplete: {recording.missing}; what is left is shown")
    if any(sheet.wind_north_mps is None for sheet in recording.hazards):
        say(f"{path} does not hold the wind of the area; its hazard is shown alone")
    return recording


def _whole(path: Path, folder: Path, say: Say) -> Path:
    """A Rerun recording of galeway; of one that is cut off or damaged a copy of what is left."""
    try:
        found = _applications(path)
    except (RuntimeError, RerunWarning):
        say(f"{path} is incomplete or damaged; what is left is shown")
        path = _copied(path, folder)
        found = _applications(path)
    if found != {_APPLICATION}:
        by = " and ".join(sorted(found)) or "nobody"
        raise BadRecordingError(f"{path} was recorded by {by}, not by galeway; open it with `rerun {path}`")
    return path


def _applications(path: Path) -> set[str]:
    """Who wrote a Rerun file; fails if it has no table of contents, which is written last."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RerunWarning)
        return {entry.application_id for entry in RrdReader(path).recordings()}


def _copied(path: Path, folder: Path) -> Path:
    """A whole Rerun file with all that can be read of a damaged one."""
    copy = folder / path.name
    done = subprocess.run(
        [viewer(), "rrd", "merge", "--continue-on-error", path, "-o", copy], check=False, capture_output=True
    )
    if done.returncode != 0 or not copy.exists():
        raise BadRecordingError(f"nothing can be read of {path}; show the MCAP recording of the flight")
    return copy
