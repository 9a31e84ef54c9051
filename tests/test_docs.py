"""What the documents say is true: keys and defaults, commands and code."""

import re
from pathlib import Path

import msgspec
import pytest

from recordings.limits import figure_kinds
from sim.scenario import Scenario

ROOT = Path(__file__).parent.parent


def fields(info, where=""):
    for field in info.fields:
        kind = field.type
        if isinstance(kind, msgspec.inspect.StructType) and field.encode_name != "start":
            yield from fields(kind, f"{where}{field.encode_name}.")
        else:
            yield f"{where}{field.encode_name}", field.default


def documented():
    """Key to default, as the tables of docs/scenario.md give them."""
    table, found = "", {}
    for line in (ROOT / "docs" / "scenario.md").read_text(encoding="utf-8").splitlines():
        if not line.startswith("| "):
            continue
        keys, default = (cell.strip() for cell in line.split("|")[1:3])
        if heading := re.match(r"\*\*`\[([\w.]+)\]`\*\*", keys):
            table = heading[1] + "."
            continue
        names, defaults = re.findall(r"`(\w+)`", keys), re.findall(r"`([^`]*)`", default)
        for at, name in enumerate(names):
            found[table + name] = defaults[at] if defaults else None
    return found


def test_the_scenario_page_lists_every_key_with_its_default():
    found = documented()
    actual = dict(fields(msgspec.inspect.type_info(Scenario)))
    assert set(found) == set(actual)
    for key, default in actual.items():
        if default is msgspec.NODEFAULT or default is None:
            assert found[key] is None, key
        else:
            assert found[key] is not None, key
            assert msgspec.json.decode(found[key].encode()) == (list(default) if default == () else default)


def test_the_report_page_explains_every_figure():
    text = (ROOT / "docs" / "report.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    named = set(re.findall(r"`([\w.]+)`", " ".join(rows)))
    assert named == {*figure_kinds(), "real_time_factor"}


@pytest.mark.parametrize("name", ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_and_files_that_are_named_exist(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    linked = [link for link in re.findall(r"\]\(([^)#]+)\)", text) if not link.startswith("http")]
    named = re.findall(r"`((?:sim|planner|aircraft|recordings|docs)/[\w./]+\.\w+)`", text)
    missing = [path for path in {*linked, *named} if not (ROOT / path).exists()]
    assert not missing
