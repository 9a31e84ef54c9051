"""What made a recording: versions of the packages that decide its bytes, and the source's git revision."""

from __future__ import annotations

import hashlib
import platform
import shutil
import subprocess
from functools import cache
from importlib import metadata
from pathlib import Path

_ROOT = Path(__file__).parent.parent
_PACKAGES = ("galeway", "jsbsim", "mcap", "msgspec", "numpy", "protobuf", "pyproj", "rerun-sdk", "scipy")


def versions() -> dict[str, str]:
    """Package to version, with "python" and "git" among them."""
    return dict(_versions())


@cache  # of the code that this process has loaded, whatever happens to packages and checkout later
def _versions() -> dict[str, str]:
    found = {name: metadata.version(name) for name in _PACKAGES}
    return found | {"python": platform.python_version(), "git": git_revision()}


@cache
def git_revision() -> str:
    """The commit of the checkout that this code runs from, "-dirty" if changed; empty when installed."""
    if not (_ROOT / ".git").exists() or shutil.which("git") is None:
        return ""
    described = subprocess.run(
        ["git", "-C", str(_ROOT), "describe", "--always", "--dirty", "--abbrev=12", "--match", ""],
        capture_output=True,
        text=True,
        check=False,
    )
    return described.stdout.strip()


@cache
def source_sha256() -> str:
    """Of the Python files of galeway's packages and the aircraft that come with it, also where no git is."""
    digest = hashlib.sha256()
    for package in ("aircraft", "planner", "recordings", "sim"):
        for path in sorted((_ROOT / package).rglob("*")):
            if path.suffix in (".py", ".toml", ".xml"):
                digest.update(f"{path.relative_to(_ROOT).as_posix()}\n".encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()
