"""The command line. Each command imports what it needs, so that `galeway --help` answers at once."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from sim.cli_aircraft import aircraft

if TYPE_CHECKING:
    from planner.plans import GoalOutcome, Plan
    from sim.scenario import LoadedScenario

BAD_INPUT = 2
FAILED = 1
INTERRUPTED = 130

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


def scenario_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The scenario and everything that overrides a part of it."""
    for decorate in (
        click.argument("scenario", default="ian"),
        click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override any value."),
        click.option("--goal", help="Fly to this goal; short for --set mission.goal=NAME."),
        click.option("--seed", type=int, help="Short for --set seed=N."),
        click.option("--planner", help="Short for --set planner.kind=KIND."),
    ):
        command = decorate(command)
    return command


def _load(
    scenario: str, overrides: tuple[str, ...], goal: str | None, seed: int | None, planner: str | None
) -> LoadedScenario:
    from sim.scenario import load_scenario

    shortcuts = {"mission.goal": goal, "seed": seed, "planner.kind": planner}
    given = [f"{key}={json.dumps(value)}" for key, value in shortcuts.items() if value is not None]
    return load_scenario(scenario, [*overrides, *given])


@commands.command()
@scenario_options
@click.option("--out", type=click.Path(path_type=Path), help="Folder for all files; default runs/NAME.")
def fly(out: Path | None, **scenario: Any) -> None:
    """Plan SCENARIO (a name or a TOML file; default ian), fly it, record it and report."""
    loaded = _load(**scenario)
    from sim.job import Files, run

    files = Files(out or Path("runs") / loaded.scenario.name)
    try:
        with _progress() as (on_plan, on_time):
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


def matrix_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Everything that belongs to `galeway plan --hazards`."""
    for decorate in (
        click.option(
            "--hazards", type=click.Path(path_type=Path), help="Matrices of your own, a NumPy file."
        ),
        click.option("--key", help="With --hazards: name of the array in an .npz that holds several."),
        click.option("--index", type=int, help="With --hazards: which of several sets."),
        click.option("--start", metavar="R,C", help="With --hazards: row, column from 0."),
        click.option("--steps-per-stage", type=int, default=30, show_default=True),
        click.option("--step-s", type=float, default=120.0, show_default=True),
        click.option("--objective", default="earliest", show_default=True, help="Or score, or survival."),
        click.option("--occupancy", default="paper", show_default=True, help="Or strict."),
        click.option("--exact", is_flag=True, help="With score: the true optimum, and the gap to it."),
        click.option("--alpha", type=float, default=1.0, show_default=True, help="Weight of clearance."),
        click.option("--beta", type=float, default=1.0, show_default=True, help="Weight of mean clearance."),
        click.option("--gamma", type=float, default=0.1, show_default=True, help="Weight of length."),
        click.option("--delta", type=float, default=0.1, show_default=True, help="Weight of time."),
    ):
        command = decorate(command)
    return command


@commands.command()
@click.argument("scenario", default="ian")
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override any value.")
@click.option("--goal", "goals", multiple=True, help="A goal by name; with --hazards ROW,COLUMN, repeatable.")
@click.option("--seed", type=int, help="Short for --set seed=N.")
@click.option("--planner", help="Short for --set planner.kind=KIND.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write the plan to this file.")
@click.option("--json", "as_json", is_flag=True, help="Print the plan as JSON.")
@click.option(
    "--export",
    "exports",
    type=click.Path(path_type=Path, dir_okay=False),
    multiple=True,
    help="Write the route as .geojson, .kml, .gpx, .plan or .waypoints; repeatable.",
)
@matrix_options
def plan(
    scenario: str,
    overrides: tuple[str, ...],
    goals: tuple[str, ...],
    seed: int | None,
    planner: str | None,
    out: Path | None,
    as_json: bool,
    exports: tuple[Path, ...],
    **matrices: Any,
) -> None:
    """Plan SCENARIO without flying it, or on hazard matrices of your own with --hazards (prints JSON)."""
    if matrices["hazards"] is not None:
        _plan_matrices(goals, **matrices)
    if len(goals) > 1:
        raise click.UsageError("give one --goal; the other goals of a scenario are planned along with it")
    loaded = _load(scenario, overrides, goals[0] if goals else None, seed, planner)
    from sim.preparation import plan_scenario

    made = plan_scenario(loaded)
    if out:
        made.save(out)
    if exports and made.waypoints:
        from planner.export import export

        for path in exports:
            export(made, path)
    if as_json:
        click.echo(made.to_json(), nl=False)
    else:
        _print_plan(made)
    sys.exit(0 if made.waypoints else FAILED)


def _plan_matrices(
    goals: tuple[str, ...],
    *,
    hazards: Path,
    key: str | None,
    index: int | None,
    start: str | None,
    **how: Any,
) -> NoReturn:
    if start is None or not goals:
        raise click.UsageError("--hazards needs --start ROW,COLUMN and at least one --goal ROW,COLUMN")
    from planner.score import Weights
    from sim.own_matrices import plan_matrices

    how["weights"] = Weights(*(how.pop(name) for name in ("alpha", "beta", "gamma", "delta")))
    found = plan_matrices(hazards, key, index, start, goals, **how)
    click.echo(json.dumps(found))
    sys.exit(0 if all(goal["reachable"] for goal in found) else FAILED)


@commands.command()
@scenario_options
@click.option("--picture", type=click.Path(path_type=Path, dir_okay=False), help="Draw the routes to a PNG.")
@click.option("--only", help="Planners to run, separated by commas; all take minutes on a large grid.")
def compare(picture: Path | None, only: str | None, **scenario: Any) -> None:
    """Run other planners and ours on SCENARIO's weather, and set their routes side by side."""
    loaded = _load(**scenario)
    from sim.comparison import compare_planners

    click.echo(compare_planners(loaded, only.split(",") if only else (), picture))


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
def _progress() -> Iterator[tuple[Callable[[Plan], None], Callable[[float], None]]]:
    """Prints the plan when it is there, then shows a bar of flight time on a terminal."""
    bars: list[Any] = []
    with ExitStack() as stack:

        def on_plan(made: Plan) -> None:
            _print_plan(made)
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


def _print_plan(made: Plan) -> None:
    click.echo(f"plan ({made.planner}, by {made.objective})")
    for goal in made.goals:
        mark = ">" if goal.name == made.goal else " "
        click.echo(f" {mark} {goal.name:14s} {_goal_line(goal)}")
    if not made.waypoints:
        click.secho(f"no route to {made.goal}: {made.outcome.reason}", fg="red", err=True)


def _goal_line(goal: GoalOutcome) -> str:
    if goal.arrival_s is None or goal.earliest_arrival_s is None or goal.length_m is None:
        return f"no route: {goal.reason}"
    waits = f", waits {goal.waiting_s / 60.0:.0f} min" if goal.waiting_s else ""
    clear = (
        "" if goal.min_clearance_m is None else f", {goal.min_clearance_m / 1000.0:.0f} km clear of hazard"
    )
    return (
        f"{_hours(goal.arrival_s)} h (earliest {_hours(goal.earliest_arrival_s)}), "
        f"{goal.length_m / 1000.0:.0f} km{waits}{clear}"
    )


def _hours(time_s: float) -> str:
    minutes = round(time_s / 60.0)
    return f"{minutes // 60}:{minutes % 60:02d}"


def _print_verdicts(verdicts: list[Any], *, err: bool = False) -> bool:
    for verdict in verdicts:
        click.secho(str(verdict), fg="green" if verdict.passed else "red", err=err)
    return all(verdict.passed for verdict in verdicts)
