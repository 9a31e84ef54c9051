"""A user's own aircraft: a copy of the Aerosonde's folder with one thing changed in it."""

import shutil
from pathlib import Path

import pytest

from aircraft.description import BUILT_IN


@pytest.fixture
def own(tmp_path):
    """Makes the folder `mine`: (file, old, new) -> its path; without arguments, unchanged."""

    def made(file: str = "", old: str = "", new: str = "") -> Path:
        folder = tmp_path / "mine"
        shutil.copytree(BUILT_IN / "aerosonde", folder)
        if file:
            text = (folder / file).read_text()
            assert old in text
            (folder / file).write_text(text.replace(old, new))
        return folder

    return made
