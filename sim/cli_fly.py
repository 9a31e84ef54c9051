"""`galeway fly`: a scenario planned, flown, recorded and judged."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sim.cli_check import print_verdicts
from sim.cli_options import FAILED, INTERRUPTED, load, print_other_hazards, print_plan, scenario_options, tell

if TYPE_CHECKING:
    from planner.plans import Plan
    from sim.scenario import LoadedScenario

BAR_STEP_S = 30.0
TOLD_EVERY_S = 10.0


@click.command()
@scenario_options
@click.option("--out", type=click.Path(path_type=Path), help="Folder for all files; default runs/NAME.")
@click.option("--live", is_flag=True, help="Show the flight in the viewer while it is flown.")
@click.option(
    "--pace", type=click.FloatRange(min=0.0, min_open=True), help="Fly at most so many times real time."
)
def fly(out: Path | None, live: bool, pace: float | None, **scenario: Any) -> None:
    """Plan SCENARIO (a name or a TOML file; default ian), fly it, record it and report."""
    loaded = load(**scenario)
    passed = flown_well(loaded, out or Path("runs") / loaded.scenario.name, live=live, pace=pace)
    sys.exit(0 if passed else FAILED)


def flown_well(loaded: LoadedScenario, out: Path, *, live: bool = False, pace: float | None = None) -> bool:
    """Fly a scenario into a folder and tell all about it; whether it arrived and kept its limits."""
    print_other_hazards(loaded)
    from sim.job import Files, run
    from sim.watching import watched

    files = Files(out)
    begun = False
    try:
        with (
            _progress(loaded.scenario.planner.abstain_below) as (on_plan, progress),
            watched(files.rerun_partial, live=live, pace=pace) as watch,
        ):

            def on_time(time_s: float) -> None:
                nonlocal begun
                begun = True
                progress(time_s)
                watch(time_s)

            flown = run(loaded, files, on_plan=on_plan, on_time=on_time, tell=tell)
    except KeyboardInterrupt:
        left = _readable(files.folder) if begun else []
        told = f"; recorded so far: {', '.join(map(str, left))}" if left else " before anything was flown"
        click.echo(f"galeway: interrupted{told}", err=True)
        sys.exit(INTERRUPTED)
    if flown is None:
        return False
    click.echo(f"\n{flown.tracking.summary()}")
    click.echo(f"flown at {flown.real_time_factor:.0f} times real time\n")
    if not flown.verdicts:
        click.echo("the scenario sets no limits, so nothing is judged")
    print_verdicts(flown.verdicts)
    passed = all(verdict.passed for verdict in flown.verdicts)
    click.echo(f"\nfiles    {files.plan}, {files.mcap}, {files.rerun}, {files.report}")
    click.echo(f"check    {sys.argv[0]} check {files.mcap}\nreplay   {sys.argv[0]} replay {files.rerun}")
    return passed and flown.tracking.arrived


def _readable(folder: Path) -> list[Path]:
    """The recordings of an interrupted flight that a sample can be read from."""
    import recordings
    from recordings.errors import RecordingError

    found = []
    for path in sorted(path for path in folder.glob("flight*.*") if path.suffix in (".mcap", ".rrd")):
        with suppress(RecordingError):
            recordings.open(path)
            found.append(path)
    return found


@contextmanager
def _progress(abstain_below: float) -> Iterator[tuple[Callable[[Plan], None], Callable[[float], None]]]:
    """Prints the plan when it is there, then the time flown: a bar on a terminal, or a line at times."""
    bars: list[Any] = []
    told_s = time.monotonic()
    with ExitStack() as stack:

        def on_plan(made: Plan) -> None:
            print_plan(made, abstain_below)
            nonlocal told_s
            told_s = time.monotonic()
            hidden = not (made.waypoints and sys.stderr.isatty())
            bar = click.progressbar(
                length=round(made.duration_s), label="flying", hidden=hidden, file=sys.stderr
            )
            bars.append(stack.enter_context(bar))

        def on_time(time_s: float) -> None:
            nonlocal told_s
            (bar,) = bars
            if bar.hidden and time.monotonic() - told_s >= TOLD_EVERY_S:
                told_s = time.monotonic()
                click.echo(_flown(time_s, bar.length), err=True)
            if time_s - bar.pos >= BAR_STEP_S:
                bar.update(round(time_s) - bar.pos)

        yield on_plan, on_time


def _flown(time_s: float, planned_s: float) -> str:
    """How far it is; a plan that was made anew on the way, or a late flight, can take longer than planned."""
    if time_s <= planned_s:
        return f"flown {_h_mm(time_s)} of {_h_mm(planned_s)} h"
    return f"flown {_h_mm(time_s)} h, {_h_mm(planned_s)} h were planned at departure"


def _h_mm(time_s: float) -> str:
    minutes = int(max(time_s, 0.0) // 60.0)
    return f"{minutes // 60}:{minutes % 60:02d}"
