"""Fixtures for every test."""

import os
from pathlib import Path

import pytest


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
