"""`galeway aircraft`: which aircraft there are, and what was measured of one."""

from __future__ import annotations

import click


@click.command()
@click.argument("model", required=False)
def aircraft(model: str | None) -> None:
    """Show what was measured of MODEL, a built-in name or your own folder; without it, list the built-in."""
    from aircraft.description import built_in_names, load_aircraft

    if model is None:
        for name in built_in_names():
            click.echo(f"{name:10s} {load_aircraft(name).description.description}")
        return
    from sim.aircraft_sheet import aircraft_sheet

    click.echo(aircraft_sheet(load_aircraft(model)))
