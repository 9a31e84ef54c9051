"""The page in docs/ is one that the command writes, and what it names is there."""

import re
import shlex
from pathlib import Path

import pytest

from sim.cli_reproduce import reproduce
from sim.reproduce.bootstrap import Interval
from sim.reproduce.page import prose, write_page
from sim.reproduce.wording import counted, number, percent, seeds, table

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "paper.md"


def test_every_command_of_the_page_is_one():
    commands = [line for line in PAGE.read_text().splitlines() if line.startswith("galeway reproduce ")]
    assert len(commands) == 4
    for command in commands:
        made = reproduce.make_context("reproduce", shlex.split(command)[2:])
        (part,) = made.params["parts"]
        assert part in ("figure2", "figure3", "figure4", "flown")


def test_its_pictures_are_there_and_small():
    pictures = re.findall(r"!\[.+\]\((.+)\)", PAGE.read_text())
    assert len(pictures) == 5
    for name in pictures:
        assert 0 < (PAGE.parent / name).stat().st_size < 100_000


def test_figures_are_told_with_their_intervals():
    assert number(Interval(3.14, 2.0, 4.26)) == "3.1 (2.0 to 4.3)"
    assert percent(Interval(0.5, float("nan"), float("nan"))) == "50 %"
    assert percent(Interval(-0.0001, -0.02, 0.001)) == "0 % (-2 to 0)"
    assert percent(None) == "-"
    assert table(["a", "b"], [["1", "2"]]) == ["| a | b |", "| --- | --- |", "| 1 | 2 |"]
    assert [counted(count, "day") for count in (0, 1, 1.0, 1.5, 2)] == [
        "0 days",
        "1 day",
        "1 day",
        "1.5 days",
        "2 days",
    ]
    assert (seeds(range(1, 2)), seeds(range(1, 31))) == ("seed 1", "seeds 1 to 30")
    assert prose("  two\n   lines ") == "two lines"


def test_only_the_sections_that_were_made_are_written(tmp_path):
    path = tmp_path / "new" / "page.md"
    write_page(path, {"figure4": ["figures"]}, {"figure4": "make it"}, ["weather"], {"figure4": ["how"]})
    text = path.read_text()
    assert "## Figure 4" in text
    assert "## Figure 3" not in text
    assert text.index("\nhow\n") < text.index("make it") < text.index("\nfigures\n")
    assert pytest.approx(95.0) == float(re.search(r"its (\S+) % paired", text)[1])
