"""The example of docs/ci.md, run as it stands there."""

import os
import re
import shlex
import shutil
import sys
from pathlib import Path

import pytest
from lxml import etree

ROOT = Path(__file__).parents[2]
SHORT = Path(__file__).parent / "scenarios" / "short.toml"

pytest_plugins = ["pytester"]


@pytest.fixture(scope="module")
def blocks():
    """The code blocks of the page, by language."""
    text = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
    return dict(re.findall(r"```(\w+)\n(.*?)```", text, re.DOTALL))


@pytest.fixture
def project(pytester, blocks, monkeypatch):
    """A folder with a scenario and the page's tests."""
    (pytester.path / "scenario.toml").write_text(SHORT.read_text(encoding="utf-8"), encoding="utf-8")
    (pytester.path / "test_flight.py").write_text(blocks["python"], encoding="utf-8")
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    return pytester


def commands(blocks):
    return [shlex.split(line) for line in re.findall(r"- run: (.*)", blocks["yaml"])]


def test_it_is_ten_lines_of_each(blocks):
    for language in ("yaml", "python"):
        assert 5 < sum(1 for line in blocks[language].splitlines() if line.strip()) <= 10


def test_the_workflow_passes_a_good_flight_and_fails_a_bad_one(project, blocks, galeway):
    install, fly, test, check = commands(blocks)
    assert install[:2] == ["pip", "install"]  # galeway is installed here
    assert (fly[0], test[0], check[0]) == ("galeway", "pytest", "galeway")
    assert galeway(*fly[1:]).returncode == 0
    done = project.run(sys.executable, "-m", *test)
    assert done.ret == 0
    done.assert_outcomes(passed=2)
    shutil.copy(project.path / "runs" / "flight" / "flight.mcap", project.path / "good.mcap")
    assert galeway(*check[1:]).returncode == 0
    properties = {
        held.get("name") for held in etree.parse(str(project.path / "junit.xml")).findall(".//property")
    }
    assert {"recording", "scenario", "seed", "goal", "outcome", "cross_track_m.p95"} <= properties
    strict = blocks["python"].replace("cross_track_m.p95 <= 2", "cross_track_m.p95 <= 0.02")
    (project.path / "test_flight.py").write_text(strict, encoding="utf-8")
    done = project.runpytest_inprocess(*test[1:])
    assert done.ret == 1
    done.assert_outcomes(passed=1, failed=1)
    done.stdout.fnmatch_lines(
        [
            "1 of 5 limits broken: short, seed 7, *runs/flight/flight.mcap",
            "FAIL cross_track_m.p95 <= 0.02: * (over by *), worst * m at 00:*, broken for *, longest 00:*",
        ]
    )
