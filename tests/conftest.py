"""Fixtures for every test."""

import gc
import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import chdir, redirect_stderr, redirect_stdout
from io import BytesIO, TextIOWrapper
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from aircraft.description import BUILT_IN
from recordings.errors import RecordingError
from recordings.rerun_viewer import headless
from sim.cli import main

# No test depends on the wall's clock: where the machine is busy, examples take longer.
settings.register_profile("unhurried", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("unhurried")


def pytest_configure(config):
    """Measured envelopes are kept for this run only, for the commands that tests start, too."""
    kept = tempfile.TemporaryDirectory(prefix="galeway-")
    os.environ["GALEWAY_CACHE"] = kept.name
    config.add_cleanup(kept.cleanup)


_FIRST = (
    "test_ian.py",
    "test_cli.py",
    "test_closed_loop.py",
    "test_replanning.py",
    "test_watching.py",
    "test_cli_replay.py",
    "test_rerun_replay.py",
    "test_faults.py",
    "test_ci_page.py",
    "test_all.py",
    "test_formats.py",
)
"""The files that take longest, in this order: begun last, they would keep one core waiting for the other."""


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """What is imported stays: looking through it for garbage would be a fifth of the collection's time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(items):
    places = {name: place for place, name in enumerate(_FIRST)}
    items.sort(key=lambda item: places.get(item.path.name, len(_FIRST)))


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder with real weather files, which the repository does not hold."""
    named = os.environ.get("GALEWAY_DATA")
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(named) if named else beside
    if not folder.is_dir():
        pytest.skip(
            f"no real weather: {folder} is not a folder; set GALEWAY_DATA to the one with the weather files"
        )
    return folder


@pytest.fixture(scope="session")
def without_vulkan(tmp_path_factory) -> str:
    """Why the viewer can draw nothing on this machine, or an empty text where it can."""
    folder = tmp_path_factory.mktemp("viewer")
    try:
        with headless(folder, (320, 180)) as viewer:
            viewer.save_screenshot(str(folder / "drawn.png"))  # it may answer for a while without a driver
            return ""
    except RecordingError as error:
        if "there is no Vulkan driver" in str(error):
            return str(error)
        raise


@pytest.fixture
def vulkan(without_vulkan):
    """For tests that need the viewer to draw."""
    if without_vulkan:
        pytest.skip(without_vulkan)


@pytest.fixture(scope="session")
def command():
    """The installed command, as the first words of a process."""
    return [str(Path(sys.executable).parent / "galeway")]


@pytest.fixture(scope="session")
def galeway_process(command):
    """Runs the command to its end in a process of its own: (*arguments) -> finished process."""

    def run(*arguments, cwd=None):
        return subprocess.run(
            [*command, *arguments], capture_output=True, text=True, check=False, cwd=cwd, timeout=900
        )

    return run


@pytest.fixture(scope="session")
def galeway():
    """Runs the command in this process, which spares starting one: (*arguments) -> finished process.

    An exception that would be a traceback for the user is one here, too.
    """

    def run(*arguments, cwd="."):
        out, err = (TextIOWrapper(BytesIO(), encoding="utf-8", write_through=True) for _ in range(2))
        with (
            pytest.MonkeyPatch.context() as patch,
            chdir(cwd),
            redirect_stdout(out),
            redirect_stderr(err),
        ):
            patch.setattr(sys, "argv", ["galeway", *map(str, arguments)])
            code = 0
            try:
                main()
            except SystemExit as stopped:
                code = stopped.code or 0
        told, complained = (stream.buffer.getvalue().decode() for stream in (out, err))
        return subprocess.CompletedProcess(arguments, code, told, complained)

    return run


@pytest.fixture
def own(tmp_path):
    """Makes `mine`, a copy of the Aerosonde's folder with one change: (file, old, new) -> its path."""

    def made(file: str = "", old: str = "", new: str = "") -> Path:
        folder = tmp_path / "mine"
        shutil.copytree(BUILT_IN / "aerosonde", folder)
        if file:
            text = (folder / file).read_text()
            assert old in text
            (folder / file).write_text(text.replace(old, new))
        return folder

    return made
