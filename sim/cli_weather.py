"""`galeway weather`: what galeway sees in weather files, or in the weather of a scenario."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sim.cli_options import only_one

_FILE = click.Path(path_type=Path, dir_okay=False)


@click.command()
@click.argument("files", nargs=-1, required=True)
@click.option(
    "--threshold", type=float, default=15.0, show_default=True, help="Speed counted as hazard, m/s."
)
@click.option(
    "--variables", metavar="U,V", help="Names of the eastward and northward wind, if it has several."
)
@click.option("--levels", type=click.Choice(["height", "pressure"]), help="Which, where a file has both.")
@click.option(
    "--wind-axes",
    type=click.Choice(["earth", "grid"]),
    help="What components on a map's grid lie along, where they do not say.",
)
@click.option("--member", type=int, help="Of an ensemble, to save or draw; default the mean of all.")
@click.option("--save", type=_FILE, metavar="OUT.nc", help="Write the wind as CF NetCDF.")
@click.option("--picture", type=_FILE, metavar="OUT.png", help="Draw it, a panel a time.")
@click.option(
    "--at",
    multiple=True,
    callback=only_one,
    metavar="TIME",
    help="With --picture: one time instead of many, UTC.",
)
@click.option("--altitude", type=float, help="With --picture: metres, where there are heights.")
@click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Of a scenario: override a value."
)
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def weather(files: tuple[str, ...], **options: Any) -> None:
    """Show what is in FILES, NetCDF, GRIB or Zarr of one forecast (patterns will do), or in a scenario."""
    if options["picture"] is None and (options["at"] is not None or options["altitude"] is not None):
        raise click.UsageError("--at and --altitude say what --picture draws; add it")
    from sim.weather_job import Wanted, moment_s

    at = options.pop("at")
    wanted = Wanted(options.pop("save"), options.pop("picture"), None if at is None else moment_s(at))
    if _is_scenario(files):
        _scenario(files[0], wanted, **options)
    else:
        _files(files, wanted, **options)


def _is_scenario(files: tuple[str, ...]) -> bool:
    from sim.scenario import built_in_names

    return len(files) == 1 and (files[0].endswith(".toml") or files[0] in built_in_names())


def _scenario(name: str, wanted: Any, overrides: tuple[str, ...], **options: Any) -> None:
    context = click.get_current_context()
    for option in options:
        if context.get_parameter_source(option) is click.core.ParameterSource.COMMANDLINE:
            shown = option.replace("as_json", "json").replace("_", "-")
            raise click.UsageError(f"--{shown} belongs to files; a scenario says it itself (--set KEY=VALUE)")
    from sim.scenario import load_scenario
    from sim.weather_job import scenario_weather

    click.echo(scenario_weather(load_scenario(name, overrides), wanted))


def _files(
    files: tuple[str, ...],
    wanted: Any,
    *,
    threshold: float,
    member: int | None,
    altitude: float | None,
    overrides: tuple[str, ...],
    as_json: bool,
    **choices: Any,
) -> None:
    if overrides:
        raise click.UsageError("--set belongs to a scenario; leave it out with files")
    if not threshold > 0.0:
        raise click.BadParameter(f"a threshold is above 0 m/s, not {threshold:g}", param_hint="--threshold")
    from sim.weather.opening import found_files
    from sim.weather.survey import survey
    from sim.weather.survey_text import survey_json, survey_text
    from sim.weather_job import files_weather

    paths, reading = found_files(files), _reading(**choices)
    wanted.check()
    found = survey(paths, reading=reading, threshold_mps=threshold)
    click.echo(survey_json(found) if as_json else survey_text(found), nl=not as_json)
    if wanted.save is not None or wanted.picture is not None:
        quantity = found.quantity
        files_weather(
            paths,
            reading,
            wanted,
            threshold_mps=threshold,
            member="mean" if member is None else member,
            altitude_m=altitude,
            gust=quantity.name if quantity is not None and quantity.kind != "wind" else None,
        )


def _reading(variables: str | None, levels: Any, wind_axes: Any) -> Any:
    from sim.weather.files import Reading

    if variables is None:
        return Reading(None, levels, wind_axes)
    names = [name.strip() for name in variables.split(",")]
    if len(names) != 2 or not all(names):
        raise click.BadParameter(
            f"two names are needed, such as u10,v10, not {variables!r}", param_hint="--variables"
        )
    return Reading((names[0], names[1]), levels, wind_axes)
