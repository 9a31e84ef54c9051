"""`galeway check`: recordings judged by limits, and compared with an earlier one."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from sim.cli_options import BAD_INPUT, FAILED

if TYPE_CHECKING:
    from recordings.checking import Baseline, Checked
    from recordings.verdicts import Verdict

_PATH = click.Path(path_type=Path)


@click.command()
@click.argument("recordings", type=_PATH, nargs=-1, required=True, metavar="RECORDING...")
@click.option("--limits", type=_PATH, help='TOML with limits = ["..."]; default: its own.')
@click.option("--against", type=_PATH, help="Compare with this recording, too: no figure may have got worse.")
@click.option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="FIGURE=SIZE",
    help="With --against: by how much, such as cross_track_m.p95=10% or flight_time_s=30s; repeatable.",
)
@click.option(
    "--json", "as_json", is_flag=True, help="Print reports and verdicts as JSON; lines go to stderr."
)
@click.option(
    "--junit", type=click.Path(path_type=Path, dir_okay=False), help="Write the verdicts as JUnit XML."
)
@click.option("--github", is_flag=True, help="Print what is broken as annotations of GitHub Actions.")
def check(
    recordings: tuple[Path, ...],
    limits: Path | None,
    against: Path | None,
    tolerances: tuple[str, ...],
    as_json: bool,
    junit: Path | None,
    github: bool,
) -> NoReturn:
    """Recompute the report of each RECORDING from its samples alone, and judge it by limits."""
    if tolerances and against is None:
        raise click.UsageError("--tolerance belongs to --against; give the recording to compare with")
    if junit is not None and not junit.parent.is_dir():
        raise click.BadParameter(
            f"cannot write {junit}: there is no folder {junit.parent}; name a file in a folder that exists",
            param_hint="--junit",
        )
    from recordings.checking import check as check_recording
    from recordings.limits import load_limits

    given = load_limits(limits) if limits else None
    baseline = _baseline(against, tolerances) if against else None
    checks = []
    for path in recordings:
        checked = check_recording(path, given, baseline)
        checks.append(checked)
        _show(checked, as_json=as_json, named=len(recordings) > 1)
        if github:
            _annotate(checked, err=as_json)
    if junit is not None:
        from recordings.junit import junit as as_xml

        junit.write_bytes(as_xml(checks))
    if any(checked.error for checked in checks):
        sys.exit(BAD_INPUT)
    sys.exit(0 if all(checked.passed for checked in checks) else FAILED)


def print_verdicts(verdicts: list[Verdict] | tuple[Verdict, ...], *, err: bool = False) -> None:
    """A table, what passed green and what failed red; nothing if there is none."""
    from recordings.verdict_table import table

    if not verdicts:
        return
    headings, *rows = table(verdicts)
    click.secho(headings, dim=True, err=err)
    for verdict, row in zip(verdicts, rows, strict=True):
        click.secho(row, fg="green" if verdict.passed else "red", err=err)


def _baseline(against: Path, tolerances: tuple[str, ...]) -> Baseline:
    import recordings
    from recordings.checking import Baseline
    from recordings.comparison import parse_tolerances
    from recordings.tracking import track

    parsed = parse_tolerances(tolerances)
    return Baseline(track(recordings.open(against)), parsed)


def _show(checked: Checked, *, as_json: bool, named: bool) -> None:
    if as_json:
        click.echo(json.dumps(checked.to_dict(), indent=1))
    elif named:
        click.secho(f"{checked.path}", bold=True)
    if checked.tracking is not None and not as_json:
        click.echo(f"{checked.tracking.summary()}\n")
    if checked.missing:
        click.secho(f"incomplete: {checked.missing}", fg="yellow", err=True)
    for note in checked.notes:
        click.secho(f"note: {note}", fg="yellow", err=True)
    if checked.error:
        click.secho(f"galeway: {checked.error}", fg="red", err=True)
    print_verdicts(checked.verdicts, err=as_json)
    if named and not as_json:
        click.echo()


def _annotate(checked: Checked, *, err: bool) -> None:
    from recordings.github import workflow_commands

    for line in workflow_commands(checked):
        click.echo(line, err=err)
