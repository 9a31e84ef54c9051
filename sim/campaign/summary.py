"""What comes of a campaign: outcomes, limits, distributions by what was varied, and the worst flights."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterator
from itertools import groupby, islice
from operator import itemgetter
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from msgspec import Struct

from recordings.recorder import Outcome
from sim.campaign.columns import VARIED
from sim.campaign.keeping import Keep
from sim.campaign.row import Row

FIGURES = (
    "flight_time_s",
    "delay_s",
    "cross_track_m.p95",
    "altitude_error_m.p95",
    "waypoint_time_error_s.p95",
    "hazard_exposure_s",
    "min_clearance_m",
)
"""Of which distributions are told."""

WORST_SHOWN = 10
UNFLOWN_SHOWN = 3
"""Of each outcome, flights without a recording that are shown in front of the worst."""

REASONS_SHOWN = 5
"""Of each outcome."""


class Spread(Struct, frozen=True):
    """Percentiles of a figure over the flights that have it."""

    p5: float
    p50: float
    p95: float
    flights: int


class Group(Struct, frozen=True):
    """The flights with one value of what is varied; or all, without key and value."""

    flights: int
    arrived: int
    passed: int
    figures: dict[str, Spread]
    key: str | None = None
    value: bool | int | float | str | None = None


class LimitRate(Struct, frozen=True):
    """Of the flights that a limit was held against, how many kept it."""

    limit: str
    flights: int
    passed: int


class WorstFlight(Struct, frozen=True):
    """One of the worst, and the command that makes it again; `figure`: that by which it is among them.

    `passed`: it arrived and kept its limits, and is among them for want of worse ones.
    """

    run: int
    seed: int
    overrides: tuple[str, ...]
    outcome: str
    reason: str
    passed: bool
    limits_broken: tuple[str, ...]
    figure: float | None
    replay: str


class Summary(Struct, frozen=True):
    """All of it.

    `planned`: flights of the whole campaign, landed or not; `reasons`: of each outcome but arrival the most
    frequent ones, in how many flights; `unjudged`: flights that were flown without a limit; `wall_time_s`: of
    one flight.
    """

    scenario: str
    planned: int
    outcomes: dict[str, int]
    reasons: dict[str, dict[str, int]]
    limits: tuple[LimitRate, ...]
    unjudged: int
    all: Group
    varied: tuple[Group, ...]
    worst_by: str
    worst: tuple[WorstFlight, ...]
    wall_time_s: Spread | None

    def to_json(self) -> bytes:
        """As indented JSON."""
        return msgspec.json.format(msgspec.json.encode(self), indent=1) + b"\n"


def summarize(table: pa.Table, folder: Path, scenario: str, planned: int, keep: Keep) -> Summary:
    """Of the flights in a table.

    Args:
        table: see `columns.schema`.
        folder: of the campaign, for commands.
        scenario: its name or path.
        planned: flights of the whole campaign.
        keep: says by which figure flights are the worst.
    """
    outcomes = dict(sorted(_counted(table["outcome"]).items(), key=lambda item: (-item[1], item[0])))
    return Summary(
        scenario=scenario,
        planned=planned,
        outcomes=outcomes,
        reasons={outcome: _reasons(table, outcome) for outcome in outcomes if outcome != Outcome.ARRIVED},
        limits=tuple(_limits(table)),
        unjudged=_count(pc.equal(pc.list_value_length(table["limits"]), 0)),
        all=_group(table),
        varied=tuple(_varied(table)),
        worst_by=keep.by,
        worst=tuple(_worst(table, folder, keep)),
        wall_time_s=_spread(table["wall_time_s"]),
    )


def _counted(column: pa.ChunkedArray) -> Counter[str]:
    return Counter(column.to_pylist())


def _reasons(table: pa.Table, outcome: str) -> dict[str, int]:
    """The most frequent first."""
    reasons = _counted(table.filter(pc.equal(table["outcome"], outcome))["reason"])
    return dict(sorted(reasons.items(), key=lambda item: (-item[1], item[0]))[:REASONS_SHOWN])


def _limits(table: pa.Table) -> Iterator[LimitRate]:
    """Limits in the order in which they are first met."""
    judged, passed = Counter[str](), Counter[str]()
    for limits in table["limits"].to_pylist():
        for limit in limits or ():
            judged[limit["limit"]] += 1
            passed[limit["limit"]] += limit["passed"]
    for limit, flights in judged.items():
        yield LimitRate(limit, flights, passed[limit])


def _varied(table: pa.Table) -> Iterator[Group]:
    for name in table.column_names:
        if name.startswith(VARIED):
            for value in pc.unique(table[name]).to_pylist():
                having = table.filter(pc.equal(table[name], value))
                yield _group(having, name.removeprefix(VARIED), value)


def _group(table: pa.Table, key: str | None = None, value: Any = None) -> Group:
    spreads = {name: _spread(table[name]) for name in FIGURES}
    return Group(
        flights=table.num_rows,
        arrived=_count(table["arrived"]),
        passed=_count(table["passed"]),
        figures={name: spread for name, spread in spreads.items() if spread is not None},
        key=key,
        value=value,
    )


def _count(true: pa.ChunkedArray) -> int:
    return int(pc.sum(true).as_py() or 0)


def _spread(column: pa.ChunkedArray) -> Spread | None:
    values = column.drop_null().to_numpy().astype(float)
    if not len(values):
        return None
    p5, p50, p95 = (round(float(value), 6) for value in np.percentile(values, (5.0, 50.0, 95.0)))
    return Spread(p5, p50, p95, len(values))


def _worst(table: pa.Table, folder: Path, keep: Keep) -> Iterator[WorstFlight]:
    """Some of the flights without a recording, then the worst of the others."""
    columns = ["run", "seed", "overrides", "outcome", "reason", "passed", "arrived", "limits", keep.by]
    rows = table.select(list(dict.fromkeys(columns)))
    is_flown = pc.is_valid(rows["arrived"])
    flown = sorted(rows.filter(is_flown).to_pylist(), key=keep.badness, reverse=True)
    for row in (*_unflown(rows.filter(pc.invert(is_flown)).to_pylist()), *flown[:WORST_SHOWN]):
        yield WorstFlight(
            run=row["run"],
            seed=row["seed"],
            overrides=tuple(row["overrides"]),
            outcome=row["outcome"],
            reason=row["reason"],
            passed=row["passed"],
            limits_broken=tuple(limit["limit"] for limit in row["limits"] or () if not limit["passed"]),
            figure=row[keep.by],
            replay=f"galeway campaign replay {shlex.quote(str(folder))} {row['run']}",
        )


def _unflown(rows: list[Row]) -> Iterator[Row]:
    """Some of each outcome, of different reasons as far as there are."""
    repeated, ordered = Counter[tuple[str, str]](), []
    for row in rows:
        why = (row["outcome"], row["reason"])
        ordered.append((row["outcome"], repeated[why], row["run"], row))
        repeated[why] += 1
    ordered.sort(key=itemgetter(0, 1, 2))
    for _, alike in groupby(ordered, key=itemgetter(0)):
        yield from (row for *_, row in islice(alike, UNFLOWN_SHOWN))
