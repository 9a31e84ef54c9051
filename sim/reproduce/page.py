"""The page about the experiments: text around figures that were computed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from sim.job import write_whole
from sim.reproduce.bootstrap import LEVEL, RESAMPLES

TITLES = {
    "figure2": "Figure 2: within one stage",
    "figure3": "Figure 3: planned on the forecast, judged in the truth",
    "figure4": "Figure 4: the cost by day",
    "flown": "Flown",
}


def write_page(
    path: Path,
    sections: Mapping[str, Sequence[str]],
    commands: Mapping[str, str],
    about_weather: Sequence[str],
    about: Mapping[str, Sequence[str]],
) -> None:
    """Write it whole.

    Args:
        path: of the page.
        sections: part to the lines that its figures make.
        commands: part to the command that makes it.
        about_weather: lines on where the weather comes from.
        about: part to the lines on how it is made.
    """
    lines = [
        "# The paper's experiments, made again and flown",
        "",
        prose(
            """What "Route planning of UAV based on improved BFS" shows, on weather of galeway's own, and
            what it could not ask: what happens when an aircraft flies it. `galeway reproduce` writes this
            page with all its figures, pictures and verdicts."""
        ),
        "",
        *about_weather,
        "",
        prose(
            f"""A figure with a range is over days, with its {100 * LEVEL:g} % paired bootstrap interval
            ({RESAMPLES} resamples of days, since the goals of a day share their weather)."""
        ),
        "",
    ]
    for part, section in sections.items():
        lines += [
            f"## {TITLES[part]}",
            "",
            *about[part],
            "",
            "```sh",
            commands[part],
            "```",
            "",
            *section,
            "",
        ]
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, ("\n".join(lines).rstrip() + "\n").encode())


def prose(text: str) -> str:
    """A paragraph in one line, as it is written over several in the source."""
    return " ".join(text.split())
