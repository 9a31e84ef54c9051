"""Campaigns: two workers against one, and what a campaign adds to a flight.

Measured by the clock on the wall, since processes wait for each other; so it needs a machine that does
nothing else. Its speed may drift: the sides take turns, and are compared with their neighbours in time.
`--quick` tries it with flights of minutes.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from campaign_sides import LONG, QUICK, ROUNDS, SCENARIO, TIMEOUT_S, Sides, campaign, passed, throughput
from tables import duration, table
from timing import say
from turns import Spread

import recordings
from recordings.limits import judge, parse_limits
from recordings.mcap_writer import McapRecorder
from recordings.tracking import track
from sim.campaign.design import Design
from sim.campaign.pool import LocalPool
from sim.closed_loop import fly
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.weather.source import bring_weather

TITLE = "Campaigns"

PAIRS = 10
TARGET_TWO_WORKERS = 1.8
TARGET_OVERHEAD = 0.05


class OneByOne:
    """An executor of one process that is given a flight when the last one's row has been kept."""

    workers, is_local = 1, True

    def results(self, work: Any, chunks: Iterable[Sequence[Any]]) -> Generator[Sequence[tuple[Any, Any]]]:
        """See `Executor.results`."""
        alone = ((flight,) for chunk in chunks for flight in chunk)
        return LocalPool(1, TIMEOUT_S).results(work, alone)


class Pairs:
    """Watches a campaign, and flies each of its flights alone, too, before it or after it.

    The campaign waits meanwhile. What it takes for a flight is all that goes by between: telling the worker,
    the flight, the row's way back, and the row kept. The first flight starts the worker and does not count.
    """

    def __init__(self, design: Design, folder: Path) -> None:
        self._design, self._folder = design, folder
        self._since_s = 0.0
        self.campaign_s: dict[int, float] = {}
        self.alone_s: dict[int, float] = {}

    def begin(self, total: int, landed: int) -> None:  # noqa: ARG002 - a `Watch`
        """Have this process warm, as a worker is after its first flight."""
        self._alone(0)

    def landed(self, row: dict[str, Any]) -> None:
        """Fly those alone whose turn it is: 1 after the campaign's 1, 2 before its 2, 3 after its 3, ..."""
        passed(row)
        run = row["run"]
        self.campaign_s[run] = time.perf_counter() - self._since_s
        for other in (run, run + 1) if run % 2 else ():
            if other < self._design.count:
                self._alone(other)
        self._since_s = time.perf_counter()

    def _alone(self, run: int) -> None:
        begin_s = time.perf_counter()
        loaded, path = self._design.flight(run).load(), self._folder / "flight.mcap"
        aircraft, weather = make_aircraft(loaded.scenario, loaded.folder), bring_weather(loaded)
        plan = make_plan(loaded.scenario, weather, aircraft)
        fly(prepare_flight(loaded, weather, plan, aircraft), McapRecorder(path), lambda _: None)
        judge(track(recordings.open(path)), parse_limits(loaded.scenario.limits))
        self.alone_s[run] = time.perf_counter() - begin_s

    def counted(self) -> Iterator[tuple[float, float]]:
        """Alone and in the campaign [s], pair by pair."""
        for run in range(1, self._design.count):
            yield self.alone_s[run], self.campaign_s[run]


@contextmanager
def on_one_core() -> Iterator[None]:
    """Both sides of a pair, which never fly at once, on the same core, where a system lets us choose."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def pairs(path: Path, folder: Path, count: int) -> list[tuple[float, float]]:
    """A flight alone and in a campaign with one worker [s], pair by pair."""
    made = campaign(path, folder, count + 1)
    watch = Pairs(made.design, path.parent)
    with on_one_core():
        made.fly(OneByOne(), watch, say)
    return list(watch.counted())


def section() -> str:
    return measured(LONG, ROUNDS, PAIRS)


def measured(scenario: dict[str, object], rounds: int, pair_count: int) -> str:
    with TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "scenario.toml"
        path.write_text(SCENARIO.format(**scenario))
        say("flights alone and in a campaign")
        found = pairs(path, folder / "pairs", pair_count)
        pools = Sides(("one worker", LocalPool(1, TIMEOUT_S)), ("two workers", LocalPool(2, TIMEOUT_S)))
        told = throughput(pools, path, rounds, TARGET_TWO_WORKERS)
    overhead = Spread.of(within / alone - 1.0 for alone, within in found)
    alone_s, within_s = (Spread.of(seconds).median for seconds in zip(*found, strict=True))
    row = ["one worker", duration(alone_s), duration(within_s), overhead.told(percent)]
    return f"""\
{told}
What a campaign adds to a flight: {pair_count} of them, each made both alone and in a campaign, one right
after the other on the same core. Alone, a flight makes its weather and plan, is flown, recorded to MCAP
and judged, in a process that has flown before. In a campaign it shares weather and plan; its time begins
when its worker is told and ends when its row is kept. Target: the median of the pairs at most
{100.0 * TARGET_OVERHEAD:.0f} % more.

{table(["a flight", "alone", "in a campaign", "more"], [row])}
"""


def percent(share: float) -> str:
    """With its sign."""
    return f"{100.0 * share:+.1f} %"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure campaigns.")
    parser.add_argument("--quick", action="store_true", help="flights of minutes, to try it")
    quick = parser.parse_args().quick
    print(measured(QUICK, 2, 4) if quick else section())
