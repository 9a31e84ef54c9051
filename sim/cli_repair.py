"""`galeway repair`: a whole file of what a killed flight left."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("recording", type=click.Path(path_type=Path))
@click.option("-o", "--out", type=click.Path(path_type=Path), help="Default: NAME.repaired.mcap beside it.")
def repair(recording: Path, out: Path | None) -> None:
    """Write what is left of RECORDING, an MCAP file that was cut off, as a whole file."""
    from recordings.mcap_repair import repair as write_whole
    from recordings.mcap_repair import repaired_path

    target = out or repaired_path(recording)
    repaired = write_whole(recording, target)
    click.echo(f"{recording}: {repaired.reason}")
    if repaired.whole:
        click.echo(f"nothing of the flight is lost; it is whole in {target}")
    else:
        click.echo(f"what is left of it is in {target}, with the outcome `incomplete`")
