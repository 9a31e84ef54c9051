"""A recording says what made it."""

import re
from importlib import metadata

from sim.provenance import git_revision, versions


def test_versions_are_those_installed():
    found = versions()
    assert found["jsbsim"] == metadata.version("jsbsim")
    assert {"galeway", "numpy", "mcap", "python", "git"} <= set(found)


def test_the_revision_is_a_commit_or_nothing():
    assert re.fullmatch(r"([0-9a-f]{7,40}(-dirty)?)?", git_revision())
