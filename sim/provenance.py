"""What made a recording: versions of the packages that decide its bytes, and the source's git revision."""

from __future__ import annotations

import platform
import shutil
import subprocess
from importlib import metadata
from pathlib import Path

_PACKAGES = ("galeway", "jsbsim", "mcap", "msgspec", "numpy", "protobuf", "pyproj", "rerun-sdk", "scipy")


def versions() -> dict[str, str]:
    """Package to version, with "python" and "git" among them."""
    found = {name: metadata.version(name) for name in _PACKAGES}
    return found | {"python": platform.python_version(), "git": git_revision()}


def git_revision() -> str:
    """The commit of the checkout that this code runs from, "-dirty" if changed; empty when installed."""
    folder = Path(__file__).parent.parent
    if not (folder / ".git").exists() or shutil.which("git") is None:
        return ""
    described = subprocess.run(
        ["git", "-C", str(folder), "describe", "--always", "--dirty", "--abbrev=12", "--match", ""],
        capture_output=True,
        text=True,
        check=False,
    )
    return described.stdout.strip()
