"""What is wrong with a recording as annotations that GitHub shows beside a change."""

from __future__ import annotations

from recordings.checking import Checked


def workflow_commands(checked: Checked) -> list[str]:
    """A workflow command of GitHub Actions for everything that is wrong with a recording."""
    wrong = [(str(verdict.limit), str(verdict)) for verdict in checked.verdicts if not verdict.passed]
    if checked.missing:
        wrong.append(("incomplete recording", checked.missing))
    if checked.error:
        wrong.append(("not checked", checked.error))
    file = _escaped(str(checked.path), ":,")
    return [f"::error file={file},title={_escaped(title, ':,')}::{_escaped(text)}" for title, text in wrong]


def _escaped(text: str, more: str = "") -> str:
    """Text in which GitHub reads nothing but itself."""
    return "".join(f"%{ord(mark):02X}" if mark in f"%\r\n{more}" else mark for mark in text)
