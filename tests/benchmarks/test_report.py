"""The page of benchmarks: sections are put in place without touching others, and each script can be run."""

import ast
import importlib
import importlib.util
import inspect
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"


def load(name):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


report = load("report")
FIRST, SECOND = list(report.SECTIONS)[:2]


def test_a_section_takes_the_place_of_its_older_self_alone():
    page = report.with_sections("", {FIRST: "## One\n\n1970", SECOND: "## Two\n\n| a |\n| --- |\n| 1 |"})
    again = report.with_sections(page, {FIRST: "## One\n\nnew"})
    assert report.sections_of(again) == {FIRST: "## One\n\nnew", SECOND: "## Two\n\n| a |\n| --- |\n| 1 |"}
    assert "1970" not in again
    assert report.with_sections(again, {}) == again


def test_sections_keep_the_order_of_the_list_whichever_is_measured_first():
    page = report.with_sections("", {SECOND: "## Two\n\n2"})
    page = report.with_sections(page, {FIRST: "## One\n\n1"})
    assert page.index("## One") < page.index("## Two")
    assert page.startswith("# Benchmarks\n")
    assert page.endswith("2\n")


def test_a_section_that_is_no_longer_listed_goes():
    page = report.INTRODUCTION + "\n<!-- section: forgotten -->\n## Gone\n\n0\n"
    assert "Gone" not in report.with_sections(page, {FIRST: "## One\n\n1"})


def test_the_circumstances_name_the_command_and_no_path():
    line = report.circumstances(FIRST)
    assert f"python benchmarks/report.py {FIRST}" in line
    assert str(FOLDER.parent) not in line


def test_a_section_is_printed_with_its_heading(monkeypatch, capsys):
    module = SimpleNamespace(TITLE="Two and two", section=lambda: "\nfour\n")
    monkeypatch.setattr(report, "import_module", lambda _: module)
    report.print_section(FIRST)
    assert capsys.readouterr().out == f"## Two and two\n\n{report.circumstances(FIRST)}\n\nfour\n"


def test_a_benchmark_that_fails_leaves_the_page_as_it_was(monkeypatch, tmp_path):
    page = tmp_path / "benchmarks.md"
    page.write_text(report.with_sections("", {FIRST: "## One\n\n1"}), encoding="utf-8")
    before = page.read_bytes()

    def fail(name):
        raise subprocess.CalledProcessError(1, name)

    monkeypatch.setattr(report, "PAGE", page)
    monkeypatch.setattr(report, "measure", fail)
    monkeypatch.setattr(sys, "argv", ["report.py", FIRST])
    with pytest.raises(SystemExit, match=FIRST):
        report.main()
    assert page.read_bytes() == before


@pytest.mark.parametrize("name", report.SECTIONS.values())
def test_each_benchmark_has_a_title_and_a_section_and_can_be_run_alone(name, monkeypatch):
    monkeypatch.syspath_prepend(FOLDER)
    module = importlib.import_module(name)
    assert module.TITLE
    assert not module.TITLE.startswith("#")
    assert not inspect.signature(module.section).parameters
    guard = ast.parse((FOLDER / f"{name}.py").read_text(encoding="utf-8")).body[-1]
    assert isinstance(guard, ast.If)
    assert "__main__" in ast.unparse(guard.test)


def test_the_page_holds_listed_sections_only():
    if not report.PAGE.exists():
        pytest.skip("nothing has been measured yet")
    page = report.PAGE.read_text(encoding="utf-8")
    assert report.with_sections(page, {}) == page
    assert set(report.sections_of(page)) <= set(report.SECTIONS)


def test_a_name_that_is_not_listed_is_refused():
    command = [sys.executable, FOLDER / "report.py", "nonsense"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "no benchmark is named 'nonsense'" in done.stderr
