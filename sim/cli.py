"""The command line. Each command imports what it needs, so that `galeway --help` answers at once."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from sim.cli_aircraft import aircraft
from sim.cli_campaign import campaign
from sim.cli_check import check
from sim.cli_fly import fly
from sim.cli_options import BAD_INPUT, INTERRUPTED, TERMINATED, load, scenario_options
from sim.cli_plan import plan
from sim.cli_repair import repair
from sim.cli_replay import picture, replay
from sim.cli_reproduce import reproduce
from sim.cli_weather import weather
from sim.interruption import terminated_as_interrupted


def main() -> None:
    """Run a command; what a user can put right ends in one message and exit code 2."""
    with terminated_as_interrupted() as was_terminated:
        try:
            _run()
        except SystemExit as ended:
            if ended.code == INTERRUPTED and was_terminated():
                sys.exit(TERMINATED)
            raise


def _run() -> None:
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


commands.add_command(fly)
commands.add_command(campaign)
commands.add_command(aircraft)
commands.add_command(plan)
commands.add_command(weather)
commands.add_command(repair)
commands.add_command(check)
commands.add_command(replay)
commands.add_command(picture)
commands.add_command(reproduce)


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
def scenarios() -> None:
    """List the scenarios that ship with galeway."""
    from sim.scenario import built_in_names, load_scenario

    for name in built_in_names():
        click.echo(f"{name:10s} {load_scenario(name).scenario.description}")
