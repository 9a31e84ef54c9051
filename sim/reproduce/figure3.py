"""The pictures and the section of figure 3."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.reproduce.arrivals_by_policy import REFERENCE, PolicyFigures, Rows, figures_of, shares
from sim.reproduce.bootstrap import Interval
from sim.reproduce.drawing import COLOURS, MARKS, SHARES_PERCENT, bare, new_figure, save, whole_numbers
from sim.reproduce.judging import Fate
from sim.reproduce.policies import POLICIES
from sim.reproduce.wording import FEW_DAYS, counted, percent, table

FIVE = 5
"""Days of which the paper shows each."""

AIM_CLOSED, AIM_LONGER = 0.5, 0.05
"""Half of the gap, and no more than 5 % longer flights."""

_FIRST = ("one day", "two days", "three days", "four days", "five days")

Levels = Mapping[str, Sequence[Rows]]
"""Title of a level of error to its days."""


def figures_by_policy(levels: Levels) -> dict[str, dict[str, PolicyFigures]]:
    """Level to policy to figures."""
    return {
        level: {policy: figures_of(days, policy) for policy in POLICIES if policy in days[0]}
        for level, days in levels.items()
    }


def first_days(days: int) -> str:
    """How many of so many days are shown each, in words."""
    return _FIRST[min(days, FIVE) - 1]


def draw_five(levels: Levels, path: Path) -> None:
    """Safe arrivals on each of the first days, a panel a level."""
    figure = new_figure(9.0, 3.9)
    panels = np.atleast_1d(figure.subplots(1, len(levels), sharey=True))
    for axes, (level, days) in zip(panels, levels.items(), strict=True):
        shown = days[:FIVE]
        policies = [policy for policy in POLICIES if policy in shown[0]]
        for at, policy in enumerate(policies):
            arrivals = [sum(row["fate"] == Fate.SAFE for row in rows[policy]) for rows in shown]
            place = np.arange(len(shown)) + 0.11 * (at - (len(policies) - 1) / 2.0)
            axes.bar(place, arrivals, 0.10, color=COLOURS[policy], label=POLICIES[policy].title)
        axes.set_xticks(range(len(shown)), [f"day {day + 1}" for day in range(len(shown))])
        axes.set_title(level)
        whole_numbers(axes.yaxis)
        bare(axes)
    goals = len(next(iter(levels.values()))[0][REFERENCE])
    panels[0].set_ylabel(f"safe arrivals, of {counted(goals, 'goal')}")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    save(figure, path)


def draw_means(found: Mapping[str, Mapping[str, PolicyFigures]], path: Path) -> None:
    """Share of goals arrived at safely, and of flights lost, over all days, with intervals."""
    figure = new_figure(9.0, 3.9)
    panels = np.atleast_1d(figure.subplots(1, len(found), sharey=True, sharex=True))
    for axes, (level, policies) in zip(panels, found.items(), strict=True):
        for at, (policy, figures) in enumerate(policies.items()):
            for height, part, filled in ((-0.13, figures.safe, True), (0.17, figures.lost, False)):
                _bar(axes, part, at + height, COLOURS[policy], MARKS[policy], filled=filled)
        axes.set_yticks(range(len(policies)), [POLICIES[policy].title for policy in policies])
        axes.set(title=level, xlabel="share of goals, %", xlim=SHARES_PERCENT)
        bare(axes)
    panels[0].invert_yaxis()
    filled = panels[0].plot([], [], "o", color="0.35", label="safe arrival")
    hollow = panels[0].plot([], [], "o", color="0.35", markerfacecolor="white", label="lost")
    figure.legend(handles=[*filled, *hollow], loc="outside lower center", ncols=2, frameon=False)
    save(figure, path)


def _bar(axes: Any, part: Interval, height: float, colour: str, mark: str, *, filled: bool) -> None:
    value, low, high = (100.0 * end for end in part)
    spread = None if np.isnan(low) else [[value - low], [high - value]]
    axes.errorbar(
        value,
        height,
        xerr=spread,
        fmt=mark,
        color=colour,
        markerfacecolor=colour if filled else "white",
        markersize=7,
        capsize=3,
    )


def section(levels: Levels, found: Mapping[str, Mapping[str, PolicyFigures]]) -> list[str]:
    """What the page says of figure 3, without the pictures."""
    lines: list[str] = []
    for level, policies in found.items():
        head = ["", "safe arrival", "lost", "not flown", "above the paper's score", "of the gap", "longer"]
        rows = [
            [
                POLICIES[policy].title,
                percent(figures.safe),
                percent(figures.lost),
                percent(figures.not_flown),
                "-" if policy == REFERENCE else percent(figures.more_than_score),
                "-" if policy == REFERENCE else percent(figures.closed),
                "-" if policy == REFERENCE else percent(figures.longer, 1),
            ]
            for policy, figures in policies.items()
        ]
        lines += [f"**{level}**, {counted(len(levels[level]), 'day')}:", "", *table(head, rows), ""]
    return lines


def verdict(found: Mapping[str, Mapping[str, PolicyFigures]], days: int) -> list[str]:
    """Whether the aim is met, level by level, by each of our policies; of few days, only their figures."""
    lines: list[str] = []
    for policy in ("survival", "replan"):
        told = []
        met = True
        for level, policies in found.items():
            if policy not in policies:
                return lines
            closed, longer = policies[policy].closed, policies[policy].longer
            if closed is None or longer is None:
                told.append(f"{level}: there is no gap to close")
                continue
            met &= closed.value >= AIM_CLOSED and longer.value <= AIM_LONGER
            told.append(f"{level}: {percent(closed)} of the gap closed, flights {percent(longer, 1)} longer")
        word = "meets the aim" if met else "**misses the aim**"
        if days < FEW_DAYS:
            word = f"cannot be judged by {counted(days, 'day')}"
        lines.append(f"- *{POLICIES[policy].title}* {word}. {'; '.join(told)}.")
    return lines


def five_days(levels: Levels) -> list[str]:
    """A table of the first days' safe arrivals."""
    lines: list[str] = []
    for level, days in levels.items():
        shown = days[:FIVE]
        policies = [policy for policy in POLICIES if policy in shown[0]]
        goals = len(shown[0][REFERENCE])
        rows = [
            [
                POLICIES[policy].title,
                *(f"{round(goals * share)}" for share in shares(shown, policy, Fate.SAFE)),
            ]
            for policy in policies
        ]
        head = [f"{level}, of {goals}", *(f"day {day + 1}" for day in range(len(shown)))]
        lines += [*table(head, rows), ""]
    return lines
