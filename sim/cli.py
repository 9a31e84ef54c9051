"""The command line. Each command imports what it needs, so that `galeway --help` answers at once."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sim.cli_aircraft import aircraft
from sim.cli_options import BAD_INPUT, FAILED, INTERRUPTED, load, print_plan, scenario_options
from sim.cli_plan import plan

if TYPE_CHECKING:
    from planner.plans import Plan

BAR_STEP_S = 30.0


def main() -> None:
    """Run a command; what a user can put right ends in one message and exit code 2."""
    from aircraft.errors import AircraftError
    from planner.errors import PlannerError
    from recordings.errors import RecordingError
    from sim.errors import SimError

    try:
        commands(prog_name="galeway", standalone_mode=False)
    except (SimError, PlannerError, AircraftError, RecordingError) as error:
        click.secho(f"galeway: {error}", fg="red", err=True)
        sys.exit(BAD_INPUT)
    except OSError as error:  # such as a full disk
        click.secho(f"galeway: {error}", fg="red", err=True)
        sys.exit(BAD_INPUT)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except click.exceptions.Exit as stop:
        sys.exit(stop.exit_code)
    except (KeyboardInterrupt, click.Abort):
        click.echo("galeway: interrupted", err=True)
        sys.exit(INTERRUPTED)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="galeway")
def commands() -> None:
    """Plan a UAV's route through changing weather, fly it on JSBSim, and check the recording."""


commands.add_command(aircraft)
commands.add_command(plan)


@commands.command()
@scenario_options
@click.option("--out", type=click.Path(path_type=Path), help="Folder for all files; default runs/NAME.")
def fly(out: Path | None, **scenario: Any) -> None:
    """Plan SCENARIO (a name or a TOML file; default ian), fly it, record it and report."""
    loaded = load(**scenario)
    from sim.job import Files, run

    files = Files(out or Path("runs") / loaded.scenario.name)
    try:
        with _progress(loaded.scenario.planner.abstain_below) as (on_plan, on_time):
            flown = run(loaded, files, on_plan=on_plan, on_time=on_time)
    except KeyboardInterrupt:
        left = ", ".join(str(path) for path in sorted(files.folder.glob("*.partial.*")))
        click.echo(f"galeway: interrupted; recorded so far: {left or 'nothing'}", err=True)
        sys.exit(INTERRUPTED)
    if flown is None:
        sys.exit(FAILED)
    click.echo(f"\n{flown.tracking.summary()}")
    click.echo(f"flown at {flown.real_time_factor:.0f} times real time\n")
    if not flown.verdicts:
        click.echo("the scenario sets no limits, so nothing is judged")
    passed = _print_verdicts(flown.verdicts)
    click.echo(f"\nfiles    {files.plan}, {files.mcap}, {files.rerun}, {files.report}")
    click.echo(f"check    {sys.argv[0]} check {files.mcap}\nreplay   {sys.argv[0]} replay {files.rerun}")
    sys.exit(0 if passed and flown.tracking.arrived else FAILED)


@commands.command()
@scenario_options
@click.option("--picture", type=click.Path(path_type=Path, dir_okay=False), help="Draw the routes to a PNG.")
@click.option("--only", help="Planners to run, separated by commas; all take minutes on a large grid.")
def compare(picture: Path | None, only: str | None, **scenario: Any) -> None:
    """Run other planners and ours on SCENARIO's weather, and set their routes side by side."""
    loaded = load(**scenario)
    from sim.comparison import compare_planners

    def progress(name: str) -> None:
        click.echo(f"{name} ...", err=True)

    click.echo(compare_planners(loaded, only.split(",") if only else (), picture, progress))


@commands.command()
@click.argument("recording", type=click.Path(path_type=Path))
@click.option(
    "--limits", type=click.Path(path_type=Path), help='TOML with limits = ["..."]; default: its own.'
)
@click.option("--json", "as_json", is_flag=True, help="Print the report as JSON; verdicts go to stderr.")
def check(recording: Path, limits: Path | None, as_json: bool) -> None:
    """Recompute the report of RECORDING from its samples alone, and judge it by limits."""
    from recordings.limits import judge, load_limits, parse_limits
    from recordings.mcap_reader import read
    from recordings.tracking import track

    given = load_limits(limits) if limits else None
    log = read(recording)
    tracking = track(log)
    if as_json:
        click.echo(tracking.to_json(), nl=False)
    else:
        click.echo(f"{tracking.summary()}\n")
    if not log.complete:
        click.secho(f"incomplete: {log.missing}", fg="yellow", err=True)
    verdicts = judge(tracking, given if given is not None else parse_limits(log.limits))
    sys.exit(0 if _print_verdicts(verdicts, err=as_json) and log.complete else FAILED)


@commands.command()
@click.argument("recording", type=click.Path(path_type=Path))
def replay(recording: Path) -> None:
    """Open RECORDING in the Rerun viewer."""
    from recordings.rerun_replay import replay as open_viewer

    open_viewer(recording)


@commands.command()
def scenarios() -> None:
    """List the scenarios that ship with galeway."""
    from sim.scenario import built_in_names, load_scenario

    for name in built_in_names():
        click.echo(f"{name:10s} {load_scenario(name).scenario.description}")


@contextmanager
def _progress(abstain_below: float) -> Iterator[tuple[Callable[[Plan], None], Callable[[float], None]]]:
    """Prints the plan when it is there, then shows a bar of flight time on a terminal."""
    bars: list[Any] = []
    with ExitStack() as stack:

        def on_plan(made: Plan) -> None:
            print_plan(made, abstain_below)
            hidden = not (made.waypoints and sys.stderr.isatty())
            bar = click.progressbar(
                length=round(made.duration_s), label="flying", hidden=hidden, file=sys.stderr
            )
            bars.append(stack.enter_context(bar))

        def on_time(time_s: float) -> None:
            (bar,) = bars
            if time_s - bar.pos >= BAR_STEP_S:
                bar.update(round(time_s) - bar.pos)

        yield on_plan, on_time


def _print_verdicts(verdicts: list[Any], *, err: bool = False) -> bool:
    for verdict in verdicts:
        click.secho(str(verdict), fg="green" if verdict.passed else "red", err=err)
    return all(verdict.passed for verdict in verdicts)
