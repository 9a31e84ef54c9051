"""Lists a GRIB file's messages in a process of its own: on some broken files ecCodes ends the process.

`python -m sim.weather.grib_trial FILE INDEX` lets cfgrib do all that it does with a file but read its values,
and leaves cfgrib's index of the messages at INDEX, so that nothing has to be done twice. It prints as JSON
the windows of messages that are of more than a moment, of which cfgrib keeps but the ends. It ends with code
2 and the reason if any of that cannot be.
"""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from sim.errors import WeatherError

_REFUSED = 2


class MessageWindow(NamedTuple):
    """The window of a message [h after the forecast's reference time], and what cfgrib tells it by."""

    parameter: int
    data_type: str
    kind_of_level: str
    step_type: str
    begin_h: float
    end_h: float


def try_alone(path: Path, index: str) -> list[MessageWindow]:
    """Let a process of its own list the file's messages, and leave the index.

    Args:
        path: of the file.
        index: where to, as cfgrib's `indexpath`.

    Returns:
        The windows of the messages that are of more than a moment, each once.

    Raises:
        WeatherError: if that process finds the file broken, or is ended by it.
    """
    command = [sys.executable, "-m", __name__, str(path), index]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode == 0:
        return [MessageWindow(*window) for window in json.loads(done.stdout)]
    said = done.stderr.strip().splitlines()
    known = done.returncode == _REFUSED and said
    reason = said[-1] if known else f"ecCodes breaks off, code {done.returncode}"
    raise WeatherError(f"{path} cannot be read ({reason}); it may be broken or cut off: fetch it again")


def main() -> None:
    """List the messages of the file that the command line names."""
    sys.modules["xarray"] = None  # type: ignore[assignment]  # cfgrib does without it, in a quarter of the time
    try:
        print(json.dumps(_list(*sys.argv[1:])))
    except Exception as error:  # of many kinds
        print(f"{type(error).__name__}: {' '.join(str(error).split())[:200]}", file=sys.stderr)
        sys.exit(_REFUSED)


def _list(path: str, indexpath: str) -> list[MessageWindow]:
    from cfgrib import COMPUTED_KEYS, FileStream
    from cfgrib.dataset import open_fileindex

    logging.getLogger("cfgrib").setLevel(logging.CRITICAL)
    stream = FileStream(path, errors="raise")
    index = open_fileindex(stream, computed_keys=COMPUTED_KEYS, indexpath=indexpath)
    for parameter in index["paramId"]:
        _build(index.subindex({"paramId": parameter}))
    return sorted(set(_windows(index)))


def _windows(index: Any) -> Iterator[MessageWindow]:
    from cfgrib.cfmessage import from_grib_step

    kind = index.index_keys.index("stepType")
    for header, places in index.iter_index():
        if header[kind] in ("instant", "undef"):
            continue
        for place in places:
            message = index.get_field(place)
            begin_h, end_h = (from_grib_step(message, key) for key in ("startStep:int", "endStep:int"))
            parameter, data_type, kind_of_level = (
                message[key] for key in ("paramId", "dataType", "typeOfLevel")
            )
            yield MessageWindow(parameter, data_type, kind_of_level, header[kind], begin_h, end_h)


def _build(index: Any) -> None:
    """Make datasets of messages, split as far as they have to be."""
    from cfgrib import DatasetBuildError, open_from_index

    try:
        open_from_index(index, encode_cf=("parameter", "time", "geography", "vertical"), errors="raise")
    except DatasetBuildError as error:
        splits = error.args[2] if len(error.args) > 2 else ()
        for split in splits:
            _build(index.subindex(split))


if __name__ == "__main__":
    main()
