"""`galeway reproduce`: the paper's experiments, made again."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from sim.cli_options import INTERRUPTED

_PATH = click.Path(path_type=Path)


@click.command()
@click.argument("parts", nargs=-1, metavar="[figure2|figure3|figure4|flown]...")
@click.option("--days", type=click.IntRange(1, 400), default=30, show_default=True, help="Seeded days.")
@click.option(
    "--seed", type=click.IntRange(0, 2**31 - 1000), default=1, show_default=True, help="Of the first."
)
@click.option(
    "--flown-days",
    type=click.IntRange(1, 400),
    help="Days that are flown; default as many as --days, 12 at most, or 1 with --quick.",
)
@click.option(
    "--replan/--no-replan", default=True, show_default=True, help="Replanning takes most of the time."
)
@click.option("--quick", is_flag=True, help="Small maps and one flown day, for a look in a minute or two.")
@click.option("--workers", type=click.IntRange(1, 64), default=1, show_default=True, help="Processes.")
@click.option(
    "--out", type=_PATH, default=Path("runs/paper"), show_default=True, help="Where results are kept."
)
@click.option("--page", type=_PATH, help="The page to write, pictures beside it; default in --out.")
@click.option(
    "--tune",
    is_flag=True,
    help="Instead turn the policies' dials on days of their own, and tell what each value gives: 15 minutes.",
)
@click.option(
    "--hazards",
    type=_PATH,
    help="The truth as matrices of your own, a NumPy file: [(day,) stage, row, column].",
)
@click.option("--key", help="With --hazards: name of the array in an .npz that holds several.")
@click.option("--forecast", type=_PATH, help="With --hazards: what the planners see, of the same shape.")
@click.option("--forecast-key", help="With --forecast: the same as --key.")
@click.option(
    "--members",
    metavar="KEY",
    help="With --forecast: an ensemble in that file, [(day,) member, stage, row, column].",
)
@click.option("--start", metavar="R,C", help="With --hazards: row, column from 0.")
@click.option("--goal", "goals", metavar="R,C", multiple=True, help="With --hazards; repeatable.")
@click.option("--steps-per-stage", type=int, default=30, show_default=True, help="With --hazards.")
@click.option("--step-s", type=float, default=120.0, show_default=True, help="With --hazards.")
def reproduce(parts: tuple[str, ...], *, tune: bool, **options: Any) -> None:
    """Make the paper's figures again, and fly them: tables, intervals and pictures on one page.

    What is done is kept in --out, so that a stopped run goes on where it was.
    """
    own = {name: options.pop(name) for name in _OF_MATRICES}
    if tune:
        _refuse((*_OF_MATRICES, *_OF_DAYS, "parts", "replan"), "has nothing to do with --tune; leave it out")
    elif own["hazards"] is not None:
        _refuse(_OF_DAYS, "is of seeded days; leave it out with --hazards")
    else:
        _refuse(_OF_MATRICES, "belongs to --hazards; add it")
    from sim.reproduce.job import Asked, reproduce, tune_dials

    asked = Asked(parts=parts, own=_own(**own), **options)
    try:
        if tune:
            click.echo(tune_dials(asked, _Progress()).read_text(encoding="utf-8"), nl=False)
        else:
            click.echo(reproduce(asked, _Progress()))
    except KeyboardInterrupt:
        click.echo(
            f"galeway: interrupted; what is done is kept in {asked.results}, and the same command goes on",
            err=True,
        )
        sys.exit(INTERRUPTED)


_OF_MATRICES: tuple[str, ...] = (
    *("hazards", "key", "forecast", "forecast_key", "members", "start", "goals"),
    *("steps_per_stage", "step_s"),
)
_OF_DAYS: tuple[str, ...] = ("days", "seed", "flown_days", "quick")


def _refuse(idle: tuple[str, ...], why: str) -> None:
    """Refuse what was given and would not be looked at."""
    context = click.get_current_context()
    for option in context.command.params:
        given = option.name is not None and context.get_parameter_source(option.name)
        if option.name in idle and given is click.core.ParameterSource.COMMANDLINE:
            name = " ".join(context.params["parts"]) if option.name == "parts" else option.opts[-1]
            raise click.UsageError(f"{name} {why}")


def _own(
    hazards: Path | None,
    forecast: Path | None,
    start: str | None,
    goals: tuple[str, ...],
    members: str | None,
    **how: Any,
) -> Any:
    if hazards is None:
        return None
    if forecast is None or start is None or not goals:
        raise click.UsageError(
            "--hazards, the truth, needs --forecast, --start ROW,COLUMN and at least one --goal ROW,COLUMN"
        )
    from sim.own_matrices import cell_of
    from sim.reproduce.own_days import OwnDays

    places = tuple(cell_of(goal, "--goal") for goal in goals)
    return OwnDays(
        hazards=hazards,
        forecast=forecast,
        members_key=members,
        start=cell_of(start, "--start"),
        goals=places,
        **how,
    )


class _Progress:
    """A line a task on a terminal, and elsewhere, such as in a file, one for each tenth of a part."""

    def __init__(self) -> None:
        self._told: tuple[str, int] | None = None

    def __call__(self, part: str, done: int, of: int) -> None:
        now = part, 10 * done // of
        if sys.stderr.isatty() or now != self._told:
            click.echo(f"{part}: {done} of {of}", err=True)
        self._told = now
