"""Fixtures for every test."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from aircraft.description import BUILT_IN


def pytest_configure(config):
    """Measured envelopes are kept for this run only, for the commands that tests start, too."""
    kept = tempfile.TemporaryDirectory(prefix="galeway-")
    os.environ["GALEWAY_CACHE"] = kept.name
    config.add_cleanup(kept.cleanup)


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
def command():
    """The installed command, as the first words of a process."""
    return [str(Path(sys.executable).parent / "galeway")]


@pytest.fixture(scope="session")
def galeway(command):
    """Runs the command to its end: (*arguments) -> finished process, its output as text."""

    def run(*arguments, cwd=None):
        return subprocess.run(
            [*command, *arguments], capture_output=True, text=True, check=False, cwd=cwd, timeout=300
        )

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
