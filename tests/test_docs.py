"""What the documents say is true: keys and defaults, commands and code."""

import re
import shlex
import sys
import tomllib
from pathlib import Path

import msgspec
import numpy as np
import pytest

from aircraft.description import Description
from recordings.comparison import RULES
from recordings.figures import unit_of
from recordings.limit_kinds import PHASES
from recordings.limits import figure_kinds, parse_limits
from recordings.quantities import QUANTITIES
from sim.campaign.columns import schema
from sim.campaign.row import Unflown
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


def rows(page, heading):
    """The cells of a page's table below a heading."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8").split(f"## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in text.splitlines() if line.startswith("| `")]
    return [tuple(cell.strip() for cell in line.strip("|").split("|")) for line in lines]


def test_the_limits_page_lists_every_quantity():
    listed = [
        (f"`{name}`", unit_of(name), quantity.meaning, quantity.at_waypoints)
        for name, quantity in QUANTITIES.items()
    ]
    found = rows("limits.md", "Quantities")
    assert [(name, unit, meaning, where == "waypoints") for name, unit, meaning, where in found] == listed


def test_the_limits_page_lists_every_figure_that_is_compared():
    worse = {("<=",): "greater", (">=",): "less", ("==",): "other"}
    listed = [
        (
            f"`{name}`",
            worse[rule.comparisons],
            "none" if rule.comparisons == ("==",) else rule.tolerance.text(name),
        )
        for name, rule in RULES.items()
    ]
    assert rows("limits.md", "Against an earlier flight") == listed


def test_the_limits_pages_examples_are_limits_and_its_phases_all_there_are():
    text = (ROOT / "docs" / "limits.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    limits = tomllib.loads(example)["limits"]
    assert [str(limit) for limit in parse_limits(limits)] == limits
    assert len({type(limit) for limit in parse_limits(limits)}) == 5
    (phases,) = [cell for name, cell in rows("limits.md", "The language") if "during" in name]
    assert set(re.findall(r"`(\w+)`", phases)) == set(PHASES)


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


def test_the_campaign_pages_commands_and_code_run(tmp_path, monkeypatch, capsys):
    text = (ROOT / "docs" / "campaigns.md").read_text(encoding="utf-8")
    commands = [line for line in text.splitlines() if line.startswith("galeway campaign ")]
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(commands) == 4
    (tmp_path / "mission.toml").write_bytes((ROOT / "tests/sim/scenarios/hop.toml").read_bytes())
    monkeypatch.chdir(tmp_path)
    for command in commands:
        monkeypatch.setattr(sys, "argv", shlex.split(command))
        with pytest.raises(SystemExit) as stopped:
            sys.exit(main())
        assert not stopped.value.code, command
    exec(compile(code, "campaigns.md", "exec"), {})
    assert "count    6" in capsys.readouterr().out
    listed = text.split("## What comes out")[1].split("### Columns")[0]
    files = set(re.findall(r"^\| `([\w./]+)`(?:, `([\w./]+)`)? \|", listed, re.MULTILINE))
    named = {name for pair in files for name in pair if "." in name and "/" not in name}
    assert named == {path.name for path in (tmp_path / "runs/severity").iterdir() if path.is_file()}


def test_the_campaign_page_explains_every_column_and_outcome():
    text = (ROOT / "docs" / "campaigns.md").read_text(encoding="utf-8")
    columns = set(schema((), {}).names) - set(figure_kinds())
    assert columns <= set(re.findall(r"`(\w+)`", text.split("### Columns")[1]))
    assert {str(outcome) for outcome in Unflown} <= set(re.findall(r"`(\w+)`", text))


@pytest.mark.parametrize("name", ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_and_files_that_are_named_exist(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    linked = [link for link in re.findall(r"\]\(([^)#]+)\)", text) if not link.startswith("http")]
    named = re.findall(r"`((?:sim|planner|aircraft|recordings|docs)/[\w./]+\.\w+)`", text)
    missing = [path for path in {*linked, *named} if not (ROOT / path).exists()]
    assert not missing


@pytest.mark.parametrize("name", ["katrina_wrf10km_20050828.nc", "ens_stjude_gust_20131025.grib"])
def test_the_weather_page_shows_what_the_command_prints(name, data_folder, monkeypatch, capsys):
    page = (ROOT / "docs" / "weather.md").read_text(encoding="utf-8")
    shown = page.split(f"$ galeway weather {name}\n")[1].split("```")[0]
    monkeypatch.chdir(data_folder)
    monkeypatch.setattr(sys, "argv", ["galeway", "weather", name])
    with pytest.raises(SystemExit) as stopped:
        sys.exit(main())
    assert not stopped.value.code
    assert capsys.readouterr().out == shown
