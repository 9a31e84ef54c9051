"""What the documents say is true: keys and defaults, commands and code."""

import re
import sys
from pathlib import Path

import msgspec
import numpy as np
import pytest

from aircraft.description import Description
from recordings.limits import figure_kinds
from sim.cli import main
from sim.scenario import Scenario

ROOT = Path(__file__).parent.parent


def fields(info, where=""):
    for field in info.fields:
        kind = field.type
        if isinstance(kind, msgspec.inspect.StructType) and field.encode_name != "start":
            yield from fields(kind, f"{where}{field.encode_name}.")
        else:
            yield f"{where}{field.encode_name}", field.default


def documented(page):
    """Key to default, as the tables of a page of docs/ give them."""
    table, found = "", {}
    for line in (ROOT / "docs" / page).read_text(encoding="utf-8").splitlines():
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
    check_defaults(documented("scenario.md"), dict(fields(msgspec.inspect.type_info(Scenario))))


def test_the_aircraft_page_lists_every_key_with_its_default():
    text = (ROOT / "docs" / "aircraft.md").read_text(encoding="utf-8")
    actual = dict(fields(msgspec.inspect.type_info(Description)))
    gains = [key for key in actual if key.startswith(("gains.", "properties"))]
    assert "Gains" in text
    found = {key: default for key, default in documented("aircraft.md").items() if key in actual}
    check_defaults(found, {key: default for key, default in actual.items() if key not in gains})


def check_defaults(found, actual):
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


def test_the_planner_pages_commands_on_matrices_run(tmp_path, monkeypatch):
    text = (ROOT / "docs" / "planner.md").read_text(encoding="utf-8")
    commands = [line.split()[1:] for line in text.splitlines() if line.startswith("galeway plan --hazards")]
    assert len(commands) == 6
    hourly = np.random.default_rng(1).random((18, 24, 36)) < 0.05
    hourly[:, 3, 5] = hourly[:, 20, 31] = hourly[:, 12, 8] = False
    members = np.zeros((2, 18, 24, 36), dtype=bool)
    members[0, :, 8:12, 14:18] = members[1, :, 10:14, 15:19] = True
    np.savez(tmp_path / "hazards.npz", hourly=hourly, members=members, days=members)
    monkeypatch.chdir(tmp_path)
    for arguments in commands:
        monkeypatch.setattr(sys, "argv", ["galeway", *arguments])
        with pytest.raises(SystemExit) as stopped:
            main()
        assert stopped.value.code == 0, arguments
    assert np.load(tmp_path / "arrival.npy").shape == (24, 36)


@pytest.mark.parametrize("name", ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_and_files_that_are_named_exist(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    linked = [link for link in re.findall(r"\]\(([^)#]+)\)", text) if not link.startswith("http")]
    named = re.findall(r"`((?:sim|planner|aircraft|recordings|docs)/[\w./]+\.\w+)`", text)
    missing = [path for path in {*linked, *named} if not (ROOT / path).exists()]
    assert not missing
