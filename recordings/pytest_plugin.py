"""Recorded-log assertions for pytest: `--recording PATH`, fixtures, and a marker for limits.

pytest loads this module in every run where galeway is installed, used or not. So it imports nothing but
pytest until a test asks for a recording.
"""

from __future__ import annotations

import glob
import os
from collections.abc import Sequence
from inspect import isfunction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from recordings.recording import Recording
    from recordings.tracking import Tracking

_PATH = "galeway_recording_path"
_FOUND = pytest.StashKey[list[Path]]()
_MARKER = "limits(*limits): judge the recordings by these limits, or by their own if none is given"
_NO_RECORDING = (
    "no recording to test: give --recording PATH (a file, a folder or a pattern; repeatable), "
    "such as --recording runs/ian/flight.mcap"
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `--recording`."""
    parser.getgroup("galeway").addoption(
        "--recording",
        action="append",
        default=[],
        metavar="PATH",
        help="recording of galeway to test: a file, a folder of them or a pattern; repeatable",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Add the marker, and find the recordings."""
    config.addinivalue_line("markers", _MARKER)
    config.stash[_FOUND] = find(config.getoption("--recording"), config.invocation_params.dir)


@pytest.hookimpl(tryfirst=True)
def pytest_pycollect_makeitem(collector: pytest.Collector, obj: object) -> None:
    """Give a test that is marked with limits a flight, also if it asks for none."""
    if not isfunction(obj):
        return
    own = [mark for mark in getattr(obj, "pytestmark", []) if mark.name in ("limits", "usefixtures")]
    marked = collector.get_closest_marker("limits") or any(mark.name == "limits" for mark in own)
    if marked and not any("tracking" in mark.args for mark in own if mark.name == "usefixtures"):
        pytest.mark.usefixtures("tracking")(obj)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test once for each recording."""
    paths = metafunc.config.stash[_FOUND]
    if _PATH in metafunc.fixturenames and paths:
        metafunc.parametrize(_PATH, paths, ids=names(paths), indirect=True, scope="session")


@pytest.fixture(scope="session")
def galeway_recording_path(request: pytest.FixtureRequest) -> Path:
    """The path of the recording of this test; fails if none was given, so that nothing passes untested."""
    if not hasattr(request, "param"):
        pytest.fail(_NO_RECORDING, pytrace=False)
    path: Path = request.param
    return path


@pytest.fixture(scope="session")
def recording(galeway_recording_path: Path) -> Recording:
    """The recording, as `recordings.recording.Recording`; a test that asks for it runs once for each."""
    import recordings
    from recordings.errors import RecordingError

    try:
        return recordings.open(galeway_recording_path)
    except RecordingError as error:
        raise pytest.fail.Exception(str(error), pytrace=False) from None


@pytest.fixture(scope="session")
def tracking(recording: Recording) -> Tracking:
    """The report of the recording, as `recordings.tracking.Tracking`."""
    from recordings.errors import RecordingError
    from recordings.tracking import track

    try:
        return track(recording)
    except RecordingError as error:
        raise pytest.fail.Exception(str(error), pytrace=False) from None


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call(item: pytest.Item) -> None:
    """Write what was flown into the JUnit file, and judge by the marked limits before the test runs."""
    used: dict[str, Any] = getattr(item, "funcargs", {})
    marks = list(item.iter_markers("limits"))
    if _PATH in used:
        _tell(item, used)
    elif marks:
        pytest.fail(
            f"limits are judged on the fixture tracking, which {item.name} does not have", pytrace=False
        )
    if marks:
        _judge(used["tracking"], used[_PATH], [text for mark in marks for text in mark.args])


def find(given: Sequence[str], folder: Path) -> list[Path]:
    """The recordings that are meant, in the order given, each once; those of a folder by name.

    Raises:
        pytest.UsageError: if one of them means no recording.
    """
    found: dict[Path, None] = {}
    for text in given:
        path = folder / text
        if path.is_dir():
            paths = sorted(path.rglob("*.mcap"))
        elif path.is_file():
            paths = [path]
        else:
            matches = glob.glob(str(path), recursive=True)  # noqa: PTH207 - of absolute patterns, too
            paths = sorted(match for match in map(Path, matches) if match.is_file())
        if not paths:
            raise pytest.UsageError(f"--recording {text}: no recording is there (looked in {folder})")
        found |= dict.fromkeys(paths)
    return list(found)


def names(paths: Sequence[Path]) -> list[str]:
    """The last parts of each path, as few as tell them apart, but the folder at least."""
    parts = [Path(os.path.normpath(path)).with_suffix("").parts for path in paths]
    for count in range(2, max(map(len, parts)) + 1):
        short = ["/".join(each[-count:]) for each in parts]
        if len(set(short)) == len(short):
            return short
    return [str(path) for path in paths]


def _tell(item: pytest.Item, used: dict[str, Any]) -> None:
    """Properties of the test, as `record_property` makes them."""
    from recordings.junit import properties

    told = {"recording": str(used[_PATH])}
    if "tracking" in used:
        told |= properties(used["tracking"])
    elif "recording" in used:
        told |= {"scenario": used["recording"].header.scenario, "seed": str(used["recording"].header.seed)}
    item.user_properties.extend(told.items())


def _judge(tracking: Tracking, path: Path, texts: Sequence[str]) -> None:
    from recordings.errors import RecordingError
    from recordings.limits import judge, parse_limits

    try:
        verdicts = judge(tracking, parse_limits(texts or tracking.recording.limits))
    except RecordingError as error:
        raise pytest.fail.Exception(str(error), pytrace=False) from None
    broken = [verdict for verdict in verdicts if not verdict.passed]
    if not broken and tracking.recording.complete:
        return
    lines = [
        f"{len(broken)} of {len(verdicts)} limits broken: {tracking.scenario}, seed {tracking.seed}, {path}"
    ]
    if not tracking.recording.complete:
        lines.append(f"the recording is incomplete: {tracking.recording.missing}")
    pytest.fail("\n".join([*lines, *map(str, broken)]), pytrace=False)
