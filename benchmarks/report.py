"""Runs benchmarks and writes what they print into docs/benchmarks.md.

`make bench` runs all; `python benchmarks/report.py planner peers` runs two, and leaves the other sections of
the page as they are.

A benchmark is a script in this folder, listed in `SECTIONS` below, with

    TITLE: str                       # the heading, without its marks
    def section() -> str:            # the markdown under it
    if __name__ == "__main__":       # so that it can be run alone: prints section(), or parts of it

The section says what is measured, the target where there is one, and what came out, as ratios within one run
wherever it can. Progress goes to stderr, nothing to stdout. Where the sides that it compares do not agree it
raises SystemExit with the reason, and the page keeps what it had. `tables.py` writes tables, `timing.py`
takes times. Each runs in its own process; command, machine and revision are put under its heading here.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import subprocess
import sys
from collections.abc import Mapping
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

SECTIONS = {
    "planner": "planner_speed",
    "windaware": "windaware_speed",
    "peers": "peers_speed",
    "tracking": "tracking",
    "loop": "real_time_factor",
    "wind": "wind_lookup",
    "campaign": "campaign_speed",
    "dask": "dask_speed",
}
"""Name to module, in the order of the page."""

FOLDER = Path(__file__).resolve().parent
PAGE = FOLDER.parent / "docs" / "benchmarks.md"

INTRODUCTION = """\
# Benchmarks

Written by `make bench` in about 25 minutes, not by hand; the command under a heading measures one section
again. Speeds are ratios against a reference in the same run, so that they carry over to other machines.
"""

_MARKER = re.compile(r"^<!-- section: (\S+) -->\n", re.MULTILINE)


def sections_of(page: str) -> dict[str, str]:
    """The sections that a page holds, by name."""
    _, *parts = _MARKER.split(page)
    return {name: text.strip("\n") for name, text in zip(parts[::2], parts[1::2], strict=True)}


def with_sections(page: str, measured: Mapping[str, str]) -> str:
    """The page with sections put in place of what it had; sections that `SECTIONS` does not name go."""
    known = {**sections_of(page), **measured}
    parts = [f"<!-- section: {name} -->\n{known[name].strip()}\n" for name in SECTIONS if name in known]
    return "\n".join([INTRODUCTION, *parts])


def circumstances(name: str) -> str:
    """The command that measures a section, and on what it was measured."""
    return (
        f"`python benchmarks/report.py {name}`, measured at revision {revision()} on {os.cpu_count()} cores "
        f"({platform.machine()}), Python {platform.python_version()}, numpy {version('numpy')}."
    )


def revision() -> str:
    """The short git revision, with a word where files but the page were changed; 'unknown' outside git."""

    def git(*command: str) -> str:
        done = subprocess.run(
            ["git", *command], cwd=FOLDER.parent, capture_output=True, text=True, check=False
        )
        return done.stdout.strip()

    changed = git(
        "status", "--porcelain", "--untracked-files=no", "--", f":!{PAGE.relative_to(FOLDER.parent)}"
    )
    return (git("rev-parse", "--short", "HEAD") or "unknown") + (" with changes" if changed else "")


def measure(name: str) -> str:
    """Run one benchmark in a process of its own and give its section with its heading.

    Raises:
        subprocess.CalledProcessError: if it fails.
    """
    command = [sys.executable, __file__, "--print", name]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout.strip()


def print_section(name: str) -> None:
    """What that process does."""
    benchmark = import_module(SECTIONS[name])
    line = circumstances(name)  # before it is measured, with the revision that is
    print(f"## {benchmark.TITLE}\n\n{line}\n\n{benchmark.section().strip()}")


def main() -> None:
    parser = argparse.ArgumentParser(description="Run benchmarks and write docs/benchmarks.md.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(SECTIONS)}; default: all")
    parser.add_argument("--print", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    names = options.names or list(SECTIONS)
    for name in names:
        if name not in SECTIONS:
            parser.error(f"no benchmark is named {name!r}; there are {', '.join(SECTIONS)}")
    if options.print:
        print_section(*names)
        return
    failed = []
    for name in names:
        print(f"{name} ...", file=sys.stderr, flush=True)
        try:
            section = measure(name)
        except subprocess.CalledProcessError as error:
            failed.append(f"{name} (exit code {error.returncode})")
            continue
        page = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
        PAGE.write_text(with_sections(page, {name: section}), encoding="utf-8")
        print(f"\n{section}\n", flush=True)
    if failed:
        raise SystemExit(f"failed, and left as it was on the page: {', '.join(failed)}")


if __name__ == "__main__":
    main()
