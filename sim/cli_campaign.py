"""`galeway campaign`: a scenario flown many times, what came of it, and one flight of it again."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sim.cli_options import FAILED, INTERRUPTED, override_options, settings

if TYPE_CHECKING:
    from sim.campaign.campaign import Campaign
    from sim.campaign.executor import Executor
    from sim.campaign.folder import CampaignFolder
    from sim.campaign.progress import Progress
    from sim.campaign.row import Row
    from sim.campaign.summary import Summary

TOLD_EVERY_S = 10.0
_FOLDER = click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))


class _Campaigns(click.Group):
    """A group whose first command needs no name: a scenario stands where it would be."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if args and args[0] not in (*self.commands, *ctx.help_option_names):
            args = ["run", *args]
        return super().parse_args(ctx, args)


@click.group(cls=_Campaigns)
def campaign() -> None:
    """Fly SCENARIO many times: `galeway campaign SCENARIO --runs N --out DIR`, short for `campaign run`.

    Exit code 0: it is flown, whatever came of the flights; 1: with --fail-on failed, a flight did not pass;
    2: bad input, or it cannot go on; 130: interrupted (143: by SIGTERM).
    """


@campaign.command()
@click.argument("scenario")
@click.option(
    "--runs",
    type=click.IntRange(min=1),
    required=True,
    metavar="N",
    help="Seeds for each combination of varied values: the scenario's, the next one, and so on.",
)
@click.option(
    "--vary",
    multiple=True,
    metavar="KEY=V1,V2,...",
    help="Values of a key of the scenario, each flown with each of other keys' and all seeds; repeatable.",
)
@override_options
@click.option("--workers", type=click.IntRange(min=1), metavar="N", help="Processes; default: one a core.")
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Fly on the workers of a Dask cluster, such as tcp://10.0.0.1:8786, in place of this machine.",
)
@click.option(
    "--keep",
    default="failed",
    show_default=True,
    metavar="WHICH",
    help="Recordings that stay: all, failed, worst:N, worst:N:FIGURE or none.",
)
@click.option(
    "--flight-timeout",
    "timeout_s",
    type=click.FloatRange(min=1.0),
    default=3600.0,
    show_default=True,
    metavar="SECONDS",
    help="What a flight may take; then it is ended.",
)
@click.option(
    "--fail-on",
    type=click.Choice(["never", "failed"]),
    default="never",
    show_default=True,
    help="Whether exit code 1 tells that a flight did not arrive, or broke a limit.",
)
@click.option(
    "--out", type=click.Path(path_type=Path), required=True, metavar="DIR", help="Folder for all files."
)
def run(
    scenario: str,
    runs: int,
    vary: tuple[str, ...],
    workers: int | None,
    scheduler: str | None,
    keep: str,
    timeout_s: float,
    fail_on: str,
    out: Path,
    **given: Any,
) -> None:
    """Fly SCENARIO (a name or a TOML file) with other seeds and other values, a row a flight.

    Begun again with the same DIR it goes on where it stopped. --set, --goal and --planner are for all
    flights; --seed is the first one's.

    Exit code 0: it is flown, whatever came of the flights; 1: with --fail-on failed, a flight did not pass;
    2: bad input, or it cannot go on; 130: interrupted (143: by SIGTERM).
    """
    from sim.campaign.campaign import Campaign
    from sim.campaign.design import Design
    from sim.campaign.flight import Origin
    from sim.campaign.folder import CampaignFolder
    from sim.campaign.keeping import Keep
    from sim.campaign.progress import Progress
    from sim.campaign.variation import parse_variations

    if workers is not None and scheduler is not None:
        raise click.UsageError(
            "--workers is for this machine; a --scheduler knows its workers: leave one out"
        )
    kept, variations = Keep.parse(keep), parse_variations(vary)
    folder = CampaignFolder(out)
    design = Design.of(Origin.of(scenario), variations, runs, settings(**given))
    flown = Campaign(design, folder, kept)
    progress = Progress()
    try:
        with _executor(flown, workers, scheduler, timeout_s) as executor, _shown(progress) as watch:
            flown.fly(executor, watch, _tell)
    except KeyboardInterrupt:
        click.echo(
            f"galeway: interrupted; {progress.done} of {progress.total} flights are in {folder.path}, and "
            "the same command goes on",
            err=True,
        )
        sys.exit(INTERRUPTED)
    summary = _print_summary(folder, as_json=False)
    sys.exit(FAILED if fail_on == "failed" and summary.all.passed < summary.all.flights else 0)


@campaign.command()
@_FOLDER
@click.option("--json", "as_json", is_flag=True, help="Print all of it as JSON.")
def report(folder: Path, as_json: bool) -> None:
    """Tell what came of the campaign in DIR: outcomes, limits, distributions, the worst flights."""
    from sim.campaign.folder import CampaignFolder

    _print_summary(CampaignFolder(folder), as_json=as_json)


@campaign.command()
@_FOLDER
@click.argument("run", type=click.IntRange(min=0))
@click.option(
    "-o", "--out", type=click.Path(path_type=Path), help="Folder for all files; default DIR/replay_RUN."
)
def replay(folder: Path, run: int, out: Path | None) -> None:
    """Fly one flight of the campaign in DIR again, alone, as `galeway fly` does: RUN is in its row.

    Exit code as of `galeway fly`: 0 if it arrived and kept its limits, 1 if not, 2 for bad input, 130 if
    interrupted; 1, too, if the recording has not the same bytes as in the campaign. Where the campaign has
    none of it, as of a flight that timed out, the flight alone decides.
    """
    from sim.campaign.again import Again
    from sim.cli_fly import flown_well

    again = Again.of(folder, run, _tell)
    out = out or folder / f"replay_{run:06d}"
    passed = flown_well(again.flight.load(), out)
    differs = again.difference(out) if again.is_recorded else ""
    if not again.is_recorded:
        _tell(f"the campaign has no recording of run {run} to compare with: {again.row['outcome']}")
    elif differs:
        _tell(differs)
    else:
        click.echo("the recording has the same bytes as in the campaign")
    sys.exit(0 if passed and not differs else FAILED)


@contextmanager
def _executor(
    flown: Campaign, workers: int | None, scheduler: str | None, timeout_s: float
) -> Iterator[Executor]:
    """Processes of this machine, or the workers of a cluster, which must see what the campaign needs."""
    if scheduler is None:
        from sim.campaign.pool import LocalPool

        yield LocalPool(workers or os.cpu_count() or 1, timeout_s)
        return
    from sim.campaign.dask_cluster import connected

    reads, writes = {path for one in flown.design.combinations for path in one.files}, None
    if flown.keep.kind != "none":
        writes = flown.folder.recordings
        reads.add(flown.folder.manifest)
    with connected(scheduler, timeout_s, reads=reads, writes=writes) as cluster:
        yield cluster


def _print_summary(folder: CampaignFolder, *, as_json: bool) -> Summary:
    from sim.campaign.summary_text import summary_text

    summary = folder.read_summary(_tell)
    click.echo(summary.to_json().decode().rstrip() if as_json else summary_text(summary))
    return summary


class _Shown:
    """A bar on a terminal, or a line at times."""

    def __init__(self, progress: Progress) -> None:
        self._progress, self._told_s = progress, time.monotonic()
        self.bar: Any = None

    def begin(self, total: int, landed: int) -> None:
        self._progress.begin(total, landed)
        if sys.stderr.isatty():
            self.bar = click.progressbar(
                length=total,
                label="flying",
                show_eta=False,
                show_pos=True,
                item_show_func=lambda _: self._progress.line(),
                file=sys.stderr,
            )
            self.bar.__enter__()
            self.bar.update(landed)
        elif landed:
            click.echo(f"{landed} of {total} flights have landed before", err=True)

    def landed(self, row: Row) -> None:
        self._progress.landed(row)
        if self.bar is not None:
            self.bar.update(1)
        elif time.monotonic() - self._told_s >= TOLD_EVERY_S:
            self._told_s = time.monotonic()
            done, total = self._progress.done, self._progress.total
            click.echo(f"{done} of {total} flights, {self._progress.line()}", err=True)


@contextmanager
def _shown(progress: Progress) -> Iterator[_Shown]:
    shown = _Shown(progress)
    try:
        yield shown
    finally:
        if shown.bar is not None:
            shown.bar.__exit__(None, None, None)


def _tell(text: str) -> None:
    click.secho(text, fg="yellow", err=True)
