"""The policies' dials turned: a grid of values, tried on days that no figure is made from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain

from sim.reproduce.choosing import Rows, Tried, choose
from sim.reproduce.experiments import LEVELS, Tell
from sim.reproduce.kept import Kept
from sim.reproduce.sources import SeededDays, Source
from sim.reproduce.trials import TRIED, FlownDays, TrialDay, Trials, try_day
from sim.reproduce.tuning import TUNED, TUNED_SMALL, Tuning
from sim.reproduce.tuning_text import RULE, section
from sim.reproduce.worlds import FLOWN, PAPER, World


@dataclass(frozen=True, slots=True)
class Setting:
    """Days of one size, what is tried on them, and where the dials stand.

    `source`: world and scale of errors to the days. `days`: their seeds.
    """

    title: str
    world: World
    source: Callable[[World, float], Source]
    days: range
    trials: Trials
    used: Tuning


SETTINGS = (
    Setting(
        "The paper's size",
        PAPER,
        SeededDays,
        range(1001, 1013),
        Trials(
            betas=(0.5, 1.0, 2.0, 4.0, 8.0, 16.0),
            caps_cells=(15.0, 30.0, 60.0),
            margins_cells=(3.0, 6.0, 9.0, 12.0, 18.0, 24.0),
            blurs_cells=(1.0, 3.0, 6.0, 12.0),
            prices=(0.0, 0.005, 0.01, 0.02, 0.03, 0.05, 0.1),
        ),
        TUNED,
    ),
    Setting(
        "The flown size",
        FLOWN,
        FlownDays,
        range(501, 601),
        Trials(
            betas=(0.5, 1.0, 2.0, 4.0, 8.0),
            caps_cells=(3.0, 6.0, 12.0),
            margins_cells=(1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0),
            blurs_cells=(0.5, 1.0, 2.0, 3.0),
            prices=(0.0, 0.005, 0.01, 0.02, 0.03, 0.05, 0.1),
        ),
        TUNED_SMALL,
    ),
)
"""None of these days is ever reported on."""


def turn(setting: Setting, kept: Kept, tell: Tell) -> dict[str, list[Tried]]:
    """Policy to what came of each of its dials; `tell`: see `Experiments`."""
    found: dict[str, list[list[Rows]]] = {policy: [] for policy in TRIED}
    for scale, level in LEVELS.items():
        source = setting.source(setting.world, scale)
        tasks = [[TrialDay(source, day, setting.trials)] for day in setting.days]
        days = kept.all(try_day, tasks, partial(tell, f"{setting.title}, {level}"))
        for policy in TRIED:
            by_dials = zip(*(day[policy] for day in days), strict=True)
            found[policy].append([list(chain.from_iterable(rows)) for rows in by_dials])
    return {
        policy: [
            Tried(dials, levels)
            for dials, *levels in zip(setting.trials.of(policy), *found[policy], strict=True)
        ]
        for policy in TRIED
    }


def tune(settings: Sequence[Setting], kept: Kept, tell: Tell) -> str:
    """Turn all dials, and tell in Markdown what came of each value, and which is chosen."""
    lines = ["# How the dials were turned", "", *RULE]
    for setting in settings:
        tried = turn(setting, kept, tell)
        lines += ["", f"## {setting.title}", "", *section(choose(tried), setting.days, setting.used)]
    return "\n".join(lines) + "\n"
