"""The picture and the section of the flown part."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sim.reproduce.bootstrap import mean_interval
from sim.reproduce.drawing import COLOURS, MARKS, SHARES_PERCENT, bare, new_figure, save
from sim.reproduce.flights import Row
from sim.reproduce.flown_figures import (
    FlownFigures,
    flown_figures,
    tracking_by_wind,
    why_lost,
    with_abstention,
)
from sim.reproduce.policies import POLICIES
from sim.reproduce.wording import percent, table

Found = dict[str, dict[str, FlownFigures]]
"""Level to policy to figures, the best by flown-safe arrivals first."""


def ranked(rows: Sequence[Row], levels: Mapping[float, str]) -> Found:
    """The figures of each policy at each level, ranked by what was flown."""
    whole = [*rows, *with_abstention(rows)]
    found: Found = {}
    for scale, level in levels.items():
        of_level = [row for row in whole if row["scale"] == scale]
        figures = {
            policy: flown_figures([row for row in of_level if row["policy"] == policy])
            for policy in POLICIES
            if any(row["policy"] == policy for row in of_level)
        }
        order = sorted(figures, key=lambda policy: (-figures[policy].flown.value, figures[policy].lost.value))
        found[level] = {policy: figures[policy] for policy in order}
    return found


def draw(rows: Sequence[Row], found: Found, path: Path) -> None:
    """Planned-safe against flown-safe, a panel a level, and tracking by wind speed."""
    figure = new_figure(10.0, 3.9)
    panels = figure.subplots(1, len(found) + 1)
    for axes, (level, policies) in zip(panels, found.items(), strict=False):
        for at, (policy, figures) in enumerate(policies.items()):
            for height, part, filled in ((-0.15, figures.planned, False), (0.15, figures.flown, True)):
                value, low, high = (100.0 * end for end in part)
                spread = None if np.isnan(low) else [[value - low], [high - value]]
                axes.errorbar(
                    value,
                    at + height,
                    xerr=spread,
                    fmt=MARKS[policy],
                    color=COLOURS[policy],
                    markerfacecolor=COLOURS[policy] if filled else "white",
                    markersize=7,
                    capsize=3,
                )
        axes.set_yticks(range(len(policies)), [POLICIES[policy].title for policy in policies])
        axes.invert_yaxis()
        axes.set(title=level, xlabel="share of goals, %", xlim=SHARES_PERCENT)
        bare(axes)
    hollow = panels[0].plot([], [], "o", color="0.35", markerfacecolor="white", label="planned-safe")
    filled = panels[0].plot([], [], "o", color="0.35", label="flown-safe")
    figure.legend(handles=[*hollow, *filled], loc="outside lower center", ncols=2, frameon=False)
    axes, winds = panels[-1], tracking_by_wind(rows)
    middles = [0.5 * (wind.low_mps + min(wind.high_mps, wind.low_mps + 3.0)) for wind in winds]
    for label, values, mark in (
        ("95th percentile", [wind.p95_m for wind in winds], "s-"),
        ("median", [wind.median_m for wind in winds], "o-"),
    ):
        axes.plot(middles, values, mark, color="#0072B2", label=label)
    axes.axvline(15.0, color="0.4", linestyle=":")
    axes.set(
        title="tracking", xlabel="wind at the aircraft, m/s", ylabel="cross-track error, m", ylim=(0.0, None)
    )
    axes.legend(frameon=False)
    bare(axes)
    save(figure, path)


def section(rows: Sequence[Row], found: Found) -> list[str]:
    """What the page says of the flights, without the picture."""
    lines: list[str] = []
    for level, policies in found.items():
        head = ["", "planned-safe", "flown-safe", "flown and lost", "goals", "flights"]
        head += ["safe as planned", "planned safe, lost", "planned lost, safe"]
        table_rows = [
            [
                f"{rank}. {POLICIES[policy].title}",
                percent(figures.planned),
                percent(figures.flown),
                percent(figures.lost),
                str(figures.goals),
                str(figures.goals - figures.unflown),
                *(
                    str(figures.counts[pair])
                    for pair in (("safe", "safe"), ("safe", "lost"), ("lost", "safe"))
                ),
            ]
            for rank, (policy, figures) in enumerate(policies.items(), 1)
        ]
        lines += [f"**{level}**:", "", *table(head, table_rows), ""]
    return [*lines, *_differences(rows), *_losses(rows), *_tracking(rows)]


def _differences(rows: Sequence[Row]) -> list[str]:
    """Flown-safe arrivals of each policy above the paper's score's, paired by day, all levels together."""
    whole = [*rows, *with_abstention(rows)]
    days = sorted({row["seed"] for row in whole})

    def share(policy: str, day: int) -> float:
        mine = [row for row in whole if row["policy"] == policy and row["seed"] == day]
        return float(np.mean([row.get("flown") == "safe" for row in mine]))

    table_rows = [
        [
            POLICIES[policy].title,
            percent(mean_interval([share(policy, day) - share("score", day) for day in days])),
        ]
        for policy in POLICIES
        if policy != "score"
    ]
    head = ["both levels, paired by day", "flown-safe above the paper's score"]
    return [*table(head, table_rows), ""]


def _losses(rows: Sequence[Row]) -> list[str]:
    lost = Counter(why_lost(row) for row in rows if row.get("flown") == "lost")
    flown = sum("flown" in row for row in rows)
    if not lost:
        return [f"None of the {flown} flights was lost.", ""]
    head = [f"why flights were lost, {lost.total()} of {flown}", "flights"]
    return [*table(head, [[why, str(count)] for why, count in lost.most_common()]), ""]


def _tracking(rows: Sequence[Row]) -> list[str]:
    head = ["wind at the aircraft, m/s", "hours", "median, m", "95th percentile, m", "99th percentile, m"]
    return table(
        head,
        [
            [
                f"{wind.low_mps:g} to {wind.high_mps:g}"
                if wind.high_mps < 30.0
                else f"above {wind.low_mps:g}",
                f"{wind.samples / SAMPLES_AN_HOUR:.1f}",
                *(f"{value:.2f}" for value in (wind.median_m, wind.p95_m, wind.p99_m)),
            ]
            for wind in tracking_by_wind(rows)
        ],
    )


SAMPLES_AN_HOUR = 5 * 3600
"""Of the recordings of these flights."""
