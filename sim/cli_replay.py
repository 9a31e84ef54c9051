"""`galeway replay` and `galeway picture`: recordings for the eyes."""

from __future__ import annotations

import re
from pathlib import Path

import click

from sim.cli_options import only_one

_LEAST_PX, _MOST_PX = 200, 8000
_FILES = click.argument("paths", metavar="FILE...", nargs=-1, required=True, type=click.Path(path_type=Path))


def flight_time(text: str) -> float:
    """Seconds since departure of a time given as h:mm or h:mm:ss."""
    found = re.fullmatch(r"(\d{1,3}):([0-5]\d)(?::([0-5]\d))?", text)
    if not found:
        raise click.BadParameter(
            f"{text!r} is not a time of flight; give hours and minutes, as in 6:30 or 6:30:15"
        )
    hours, minutes, seconds = (float(digits or 0) for digits in found.groups())
    return 3600.0 * hours + 60.0 * minutes + seconds


def size(text: str) -> tuple[int, int]:
    """Width and height, given as 1600x900."""
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    sides = (int(found[1]), int(found[2])) if found else (0, 0)
    if not all(_LEAST_PX <= side <= _MOST_PX for side in sides):
        raise click.BadParameter(
            f"{text!r} is not a size; give width and height, as in 1600x900, each from {_LEAST_PX} to "
            f"{_MOST_PX} pixels"
        )
    return sides


@click.command()
@_FILES
@click.option("--web", is_flag=True, help="Serve the viewer to a browser instead, on this machine alone.")
def replay(paths: tuple[Path, ...], web: bool) -> None:
    """Open recordings, .mcap or .rrd, in the Rerun viewer; several are laid over each other."""
    from recordings.rerun_replay import replay as open_viewer
    from recordings.rerun_shown import shown
    from recordings.rerun_web import serve

    with shown(paths, _say) as path:
        if web:
            serve(path, click.echo)
        else:
            open_viewer(path)


@click.command()
@_FILES
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), help="The PNG to write.")
@click.option(
    "--at",
    type=flight_time,
    multiple=True,
    callback=only_one,
    metavar="H:MM[:SS]",
    help="Moment since departure; default: the end.",
)
@click.option(
    "--size", "size_px", type=size, default="1600x900", show_default=True, metavar="WxH", help="In pixels."
)
@click.option("--small", is_flag=True, help="Write 256 colours alone: a third of the bytes.")
def picture(
    paths: tuple[Path, ...], out: Path, at: float | None, size_px: tuple[int, int], small: bool
) -> None:
    """Draw recordings, .mcap or .rrd, as they open in the viewer; no screen is needed."""
    from recordings.rerun_replay import picture as draw
    from recordings.rerun_shown import shown

    with shown(paths, _say) as path:
        draw(path, out, at, size_px, small=small)


def _say(text: str) -> None:
    click.secho(text, fg="yellow", err=True)
