"""Campaigns of two executors, flown in turns, and how many times one's throughput the other's is."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

from tables import table, times
from timing import say
from turns import Spread, in_turns

from sim.campaign.campaign import Campaign
from sim.campaign.design import Design
from sim.campaign.executor import Executor
from sim.campaign.flight import Origin
from sim.campaign.folder import CampaignFolder
from sim.campaign.keeping import Keep

ROUNDS = 6
FLIGHTS = 3
"""Of each worker in a round: few, so that the other side's turn comes soon."""

TIMEOUT_S = 3600.0

SCENARIO = """\
name = "{name}"
limits = ["arrived == true", "cross_track_m.p95 <= 2"]

[mission]
departure = 2022-09-29T00:00:00Z
goal = "There"
start = {{ name = "Here", lat_deg = 29.0, lon_deg = -90.6 }}
goals = [{{ name = "There", lat_deg = {goal_deg}, lon_deg = -90.6 }}]

[weather]
storm = "AL092022"

[grid]
south_deg = 28.5
north_deg = 31.0
west_deg = -91.5
east_deg = -89.5

[stages]
count = {stages}

[planner]
objective = "earliest"
"""
LONG = {"name": "hour", "goal_deg": 30.1, "stages": 3}
QUICK = {"name": "minutes", "goal_deg": 29.1, "stages": 1}


def passed(row: dict[str, Any]) -> None:
    """Stop where a flight was not what is measured."""
    if not row["passed"]:
        raise SystemExit(f"flight {row['run']} did not pass: {row['outcome']}, {row['reason']}")


@dataclass
class Flown:
    """A campaign: when it began, its flights landed and it ended [s]; how long a flight is [s of flight]."""

    workers: int
    begin_s: float = field(default_factory=time.perf_counter)
    landed_s: list[float] = field(default_factory=list)
    end_s: float = 0.0
    flight_s: float = 0.0

    def begin(self, total: int, landed: int) -> None:
        """Nothing to do."""

    def landed(self, row: dict[str, Any]) -> None:
        """Note when."""
        passed(row)
        self.landed_s.append(time.perf_counter())
        self.flight_s = row["flight_time_s"]

    @property
    def whole_rate_hz(self) -> float:
        """Flights a second, from the command to its end."""
        return len(self.landed_s) / (self.end_s - self.begin_s)

    @property
    def steady_rate_hz(self) -> float:
        """Flights a second with all workers up, from the first landings of each to the last ones."""
        first, last = self.landed_s[: self.workers], self.landed_s[-self.workers :]
        return (len(self.landed_s) - self.workers) / (fmean(last) - fmean(first))


def campaign(path: Path, folder: Path, flights: int) -> Campaign:
    """Of one scenario, nothing kept."""
    design = Design.of(Origin.of(str(path)), (), flights)
    return Campaign(design, CampaignFolder(folder), Keep.parse("none"))


def flown(path: Path, folder: Path, flights: int, executor: Executor) -> Flown:
    """A campaign from its command to its end; `flights` for each worker."""
    clock = Flown(executor.workers)
    campaign(path, folder, flights * executor.workers).fly(executor, clock, say)
    clock.end_s = time.perf_counter()
    return clock


class Sides(NamedTuple):
    """What is compared, each side by its name."""

    one: tuple[str, Executor]
    other: tuple[str, Executor]


def throughput(sides: Sides, path: Path, rounds: int, target: float) -> str:
    """Of campaigns of a scenario, by two executors: what was done, and a table with their ratio."""

    def side(name: str, executor: Executor) -> Callable[[int], Flown]:
        def fly(number: int) -> Flown:
            say(f"round {number + 1} of {rounds}: {name}")
            return flown(path, path.parent / f"{name}, {number}", FLIGHTS, executor)

        return fly

    found = list(in_turns([side(*one) for one in sides], rounds))
    rows = [
        row("all up", [[each.steady_rate_hz for each in both] for both in found]),
        row("from the command to its end", [[each.whole_rate_hz for each in both] for both in found]),
    ]
    minutes = found[0][0].flight_s / 60.0
    return f"""\
Campaigns of flights of {minutes:.0f} minutes, by the clock on the wall. The sides take turns, since a
machine's own speed drifts: {rounds} rounds of {FLIGHTS} flights for each process, the order reversed in
every other. A ratio is taken in each round; here is the median of them, and in brackets the least and
the greatest. Target: {sides.other[0]} at least {target} times {sides.one[0]}.

{table(["flights an hour", *(name for name, _ in sides), "as many"], rows)}
"""


def row(what: str, rates_hz: Sequence[Sequence[float]]) -> list[str]:
    """Of the table: the medians, and the ratio with its spread; `rates_hz` has both rates of each round."""
    medians_hz = (Spread.of(rates).median for rates in zip(*rates_hz, strict=True))
    ratio = Spread.of(other / one for one, other in rates_hz)
    return [what, *(f"{3600.0 * rate:.0f}" for rate in medians_hz), ratio.told(times)]
