"""`galeway plan`: a scenario, or hazard matrices of one's own."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import click
from click.core import ParameterSource

from sim.cli_options import FAILED, load, print_other_hazards, print_plan, tell

WEIGHTS = {"alpha": 1.0, "beta": 1.0, "gamma": 0.1, "delta": 0.1, "clearance_cap_cells": 30.0}
_OF_WEIGHTS = (
    *("Weight of clearance.", "Weight of mean clearance.", "Weight of length.", "Weight of time."),
    "What a cell far from hazard counts as.",
)
OF_SCENARIOS = ("scenario", "overrides", "seed", "planner", "out", "exports")
OF_MATRICES = (
    *("key", "index", "members", "start", "steps_per_stage", "step_s", "occupancy", "exact", "blur_cells"),
    *WEIGHTS,
)
_FILE = click.Path(path_type=Path, dir_okay=False)


def scenario_only(command: Callable[..., Any]) -> Callable[..., Any]:
    """Everything that belongs to a scenario."""
    options = (
        click.argument("scenario", default="ian"),
        click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override any value."),
        click.option("--seed", type=int, help="Short for --set seed=N."),
        click.option("--planner", help="Short for --set planner.kind=KIND."),
        click.option("--out", type=_FILE, help="Write the plan to this file."),
        click.option(
            "--export",
            "exports",
            type=_FILE,
            multiple=True,
            help="Write the route as .geojson, .kml, .gpx, .plan or .waypoints; repeatable.",
        ),
    )
    return _decorated(command, options)


def matrices_only(command: Callable[..., Any]) -> Callable[..., Any]:
    """Everything that belongs to `galeway plan --hazards`."""
    options = (
        click.option(
            "--hazards", type=click.Path(path_type=Path), help="Matrices of your own, a NumPy file."
        ),
        click.option("--key", help="With --hazards: name of the array in an .npz that holds several."),
        click.option("--index", type=int, help="With --hazards: which of several sets."),
        click.option("--members", metavar="KEY", help="With --hazards: an ensemble to count survivors in."),
        click.option("--start", metavar="R,C", help="With --hazards: row, column from 0."),
        click.option("--steps-per-stage", type=int, default=30, show_default=True),
        click.option("--step-s", type=float, default=120.0, show_default=True),
        click.option("--occupancy", default="paper", show_default=True, help="Or strict."),
        click.option("--exact", is_flag=True, help="With score: the true optimum, and the gap to it."),
        click.option("--blur-cells", type=float, help="Blur of the share of members; 3."),
        *(
            click.option(
                f"--{name.replace('_', '-')}", type=float, default=value, show_default=True, help=text
            )
            for (name, value), text in zip(WEIGHTS.items(), _OF_WEIGHTS, strict=True)
        ),
    )
    return _decorated(command, options)


def _decorated(command: Callable[..., Any], options: Sequence[Callable[..., Any]]) -> Callable[..., Any]:
    for decorate in reversed(options):  # the last one applied comes first in --help
        command = decorate(command)
    return command


@click.command()
@scenario_only
@click.option("--goal", "goals", multiple=True, help="A goal by name; with --hazards ROW,COLUMN, repeatable.")
@click.option(
    "--objective",
    help="Earliest, score, survival (or, windaware, fuel); short for --set planner.objective=NAME.",
)
@click.option("--abstain-below", type=float, help="Turn down plans with a smaller chance to survive, 0 to 1.")
@click.option("--departures", metavar="FIRST:LAST:EVERY", help="Minutes; plan from the best of these slots.")
@click.option("--best-by", help="With --departures: arrival (the default), flight or survival.")
@click.option(
    "--distinct", is_flag=True, help="With --departures: one vehicle to each goal, no two in a slot."
)
@click.option("--isochrones", type=_FILE, help="Write the arrival step of every cell to this .npy file.")
@click.option("--json", "as_json", is_flag=True, help="Print the plan as JSON.")
@matrices_only
def plan(hazards: Path | None, objective: str | None, **options: Any) -> None:
    """Plan SCENARIO without flying it, or on hazard matrices of your own with --hazards (prints JSON)."""
    if options["departures"] is not None and (objective is not None or options["exact"]):
        raise click.UsageError(
            "--departures plans what --best-by asks for; leave out --objective and --exact"
        )
    if hazards is None:
        _refuse(OF_MATRICES, "belongs to --hazards; a scenario takes it from its file or from --set")
        _plan_scenario(objective=objective, **_without(options, OF_MATRICES))
    _refuse(OF_SCENARIOS, "belongs to a scenario; leave it out with --hazards")
    _plan_matrices(hazards, objective=objective, **_without(options, OF_SCENARIOS))


def _refuse(names: Sequence[str], why: str) -> None:
    """Refuse what was given on the command line and would not be looked at."""
    context = click.get_current_context()
    for option in context.command.params:
        if option.name in names and context.get_parameter_source(option.name) is ParameterSource.COMMANDLINE:
            if isinstance(option, click.Argument):
                given = context.params[option.name]
                raise click.UsageError(f"give the scenario {given!r} or --hazards, not both")
            raise click.UsageError(f"{option.opts[-1]} {why}")


def _without(options: dict[str, Any], names: Sequence[str]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if name not in names}


def _plan_scenario(
    *,
    goals: tuple[str, ...],
    out: Path | None,
    exports: tuple[Path, ...],
    isochrones: Path | None,
    departures: str | None,
    best_by: str | None,
    distinct: bool,
    as_json: bool,
    **scenario: Any,
) -> NoReturn:
    if len(goals) > 1:
        raise click.UsageError("give one --goal; the other goals of a scenario are planned along with it")
    from sim.departing import Departing

    departing = Departing.parsed(departures, best_by, distinct)
    if departing is not None and departing.best_by == "survival":
        scenario["objective"] = "survival"
    loaded = load(goal=goals[0] if goals else None, **scenario)
    from sim.plan_job import PlanFiles, plan_job
    from sim.plan_text import utc

    planned = plan_job(loaded, departing, PlanFiles(out, exports, isochrones), tell)
    if as_json:
        click.echo(planned.to_json(), nl=False)
    else:
        if planned.table is not None:
            click.echo(f"{planned.table.text(utc(loaded.scenario.mission.departure_s))}\n")
        print_other_hazards(loaded)
        for made in planned.plans:
            print_plan(made, loaded.scenario.planner.abstain_below, goal_alone=distinct)
    sys.exit(0 if planned.passed else FAILED)


def _plan_matrices(
    hazards: Path,
    *,
    goals: tuple[str, ...],
    key: str | None,
    index: int | None,
    members: str | None,
    start: str | None,
    objective: str | None,
    exact: bool,
    departures: str | None,
    best_by: str | None,
    distinct: bool,
    isochrones: Path | None,
    as_json: bool,
    **how: Any,
) -> NoReturn:
    if start is None or not goals:
        raise click.UsageError("--hazards needs --start ROW,COLUMN and at least one --goal ROW,COLUMN")
    from planner.score import Weights
    from sim.departing import Departing
    from sim.own_matrices import plan_matrices

    how["weights"] = Weights(*(how.pop(name) for name in WEIGHTS))
    how = {name: value for name, value in how.items() if value is not None}
    departing = Departing.parsed(departures, best_by, distinct)
    if departing is None:
        how |= {"objective": objective or "earliest", "exact": exact}
    found = plan_matrices(hazards, key, index, members, start, goals, departing, isochrones, **how)
    click.echo(json.dumps(found.answer))
    if found.table is not None and not as_json:
        click.echo(found.table, err=True)
    sys.exit(0 if found.passed else FAILED)
