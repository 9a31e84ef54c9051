"""`galeway reproduce`: what is asked for, checked, made and put on a page."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sim.errors import SimError
from sim.job import write_whole
from sim.reproduce import texts
from sim.reproduce.experiments import LEVELS, PARTS, Experiments, check_drawable
from sim.reproduce.flown_day import CORRIDOR_M, SEVERITY
from sim.reproduce.forecasts import MEMBERS
from sim.reproduce.kept import Kept
from sim.reproduce.own_days import OwnDays
from sim.reproduce.page import write_page
from sim.reproduce.pool import executor_of
from sim.reproduce.sources import SeededDays
from sim.reproduce.tune import SETTINGS, tune
from sim.reproduce.tuning import TUNED, TUNED_SMALL
from sim.reproduce.wording import seeds
from sim.reproduce.worlds import FLOWN, PAPER, QUICK

MOST_FLOWN_DAYS = 12
"""That are flown if nothing is said of it; a day is two dozen flights, a minute of one core."""

TUNED_ON = f"{seeds(SETTINGS[0].days)}, for the flown part {SETTINGS[1].days[0]} to {SETTINGS[1].days[-1]}"


@dataclass(frozen=True, slots=True)
class Asked:
    """What the command line asks for.

    `parts`: of `PARTS`, none for all that can be made. `replan`: whether figure 3 has replanning, too.
    `flown_days`: if None, one of a quick look, and else of the days no more than `MOST_FLOWN_DAYS`.
    `own`: matrices in place of seeded days.
    """

    parts: tuple[str, ...]
    days: int
    flown_days: int | None
    seed: int
    quick: bool
    replan: bool
    own: OwnDays | None
    out: Path
    page: Path | None
    workers: int

    @property
    def written(self) -> Path:
        """The page."""
        return self.page or self.out / "paper.md"

    @property
    def results(self) -> Path:
        """The folder in which what is done is kept."""
        return self.out / "results"

    @property
    def flown(self) -> range:
        """Seeds of the days that are flown."""
        usual = 1 if self.quick else min(self.days, MOST_FLOWN_DAYS)
        return range(self.seed, self.seed + (self.flown_days or usual))


def reproduce(asked: Asked, tell: Callable[[str, int, int], object]) -> Path:
    """Make it all.

    Args:
        asked: what.
        tell: told of a part how many tasks are done, and of how many.

    Returns:
        The page that was written.

    Raises:
        SimError: for what makes no sense; PlannerError without matplotlib.
    """
    parts = _parts(asked)
    check_drawable()
    path = asked.written
    if asked.own is not None:
        days: Sequence[int] = range(asked.own.count())
        sources: dict[str, SeededDays | OwnDays] = {"your forecast": asked.own}
    else:
        days = range(asked.seed, asked.seed + asked.days)
        world = QUICK if asked.quick else PAPER
        sources = {title: SeededDays(world, scale) for scale, title in LEVELS.items()}
    _make_room(asked)
    experiments = Experiments(
        sources,
        days,
        TUNED_SMALL if asked.quick else TUNED,
        FLOWN,
        asked.flown,
        Kept(asked.results, executor_of(asked.workers)),
        asked.replan and asked.own is None,
        tell,
    )
    folder = path.parent / path.stem
    sections = {part: getattr(experiments, part)(folder) for part in PARTS if part in parts}
    write_page(path, sections, commands_of(asked), _weather(asked, days), _about(asked))
    return path


def tune_dials(asked: Asked, tell: Callable[[str, int, int], object]) -> Path:
    """Turn the policies' dials instead, on days of their own; the page is `tuning.md` where none is named.

    Raises:
        SimError: if nothing can be written.
    """
    asked = replace(asked, page=asked.page or asked.out / "tuning.md")
    _make_room(asked)
    text = tune(SETTINGS, Kept(asked.results, executor_of(asked.workers)), tell)
    write_whole(asked.written, text.encode())
    return asked.written


def _make_room(asked: Asked) -> None:
    """The folders of results and page, before anything takes its minutes."""
    path = asked.written
    if path.is_dir() or not path.suffix:  # pictures go to a folder of its name without the suffix
        raise SimError(f"--page {path} is no name of a page; give one such as {path / 'paper.md'}")
    for option, folder in (("--out", asked.results), ("--page" if asked.page else "--out", path.parent)):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = "it is a file" if folder.is_file() else error.strerror
            raise SimError(f"cannot write to {folder}: {reason}; choose another {option}") from error


def _parts(asked: Asked) -> tuple[str, ...]:
    for part in asked.parts:
        if part not in PARTS:
            raise SimError(f"there is no part {part!r}; choose of {', '.join(PARTS)}")
    if asked.own is not None and "flown" in asked.parts:
        raise SimError(
            "matrices say nothing of the wind, so there is nothing to fly; leave out flown, or --hazards"
        )
    last = max(asked.seed + asked.days - 1, asked.flown[-1])
    if asked.own is None and any(
        setting.days[0] <= last and asked.seed <= setting.days[-1] for setting in SETTINGS
    ):
        raise SimError(
            f"seeds {asked.seed} to {last} are among those that the policies were tuned on, {TUNED_ON}; "
            "choose another --seed or fewer days"
        )
    possible = PARTS if asked.own is None else PARTS[:3]
    return asked.parts or possible


def commands_of(asked: Asked) -> dict[str, str]:
    """What makes each part again, as it was asked for."""
    how = [f"--days {asked.days}", f"--seed {asked.seed}"]
    if asked.own is not None:
        how = _matrix_options(asked.own)
    quick = ["--quick"] if asked.quick else []
    how += quick
    made = {part: " ".join(["galeway reproduce", part, *how]) for part in PARTS[:3]}
    if not asked.replan:
        made["figure3"] += " --no-replan"
    how = [f"--flown-days {len(asked.flown)}", f"--seed {asked.seed}", *quick]
    return made | {"flown": " ".join(["galeway reproduce flown", *how])}


def _matrix_options(own: OwnDays) -> list[str]:
    named = {
        "--hazards": own.hazards,
        "--key": own.key,
        "--forecast": own.forecast,
        "--forecast-key": own.forecast_key,
        "--members": own.members_key,
        "--start": "{},{}".format(*own.start),
    }
    given = [f"{name} {shlex.quote(str(value))}" for name, value in named.items() if value is not None]
    goals = ["--goal {},{}".format(*goal) for goal in own.goals]
    return [*given, *goals, f"--steps-per-stage {own.steps_per_stage}", f"--step-s {own.step_s:g}"]


def _weather(asked: Asked, days: Sequence[int]) -> list[str]:
    """Where the weather comes from."""
    if asked.own is not None:
        return texts.about_own_days(len(days), asked.own.hazards.name, asked.own.forecast.name)
    return texts.about_days(QUICK if asked.quick else PAPER, days, MEMBERS, _error_model(asked.written))


def _error_model(page: Path) -> str:
    """Its name, with a link from a page that has its description beside it."""
    document = page.parent / "forecasts.md"
    return "[project's model](forecasts.md)" if document.is_file() else "project's model (docs/forecasts.md)"


def _about(asked: Asked) -> dict[str, list[str]]:
    """How each part is made."""
    return {
        "figure2": texts.FIGURE2,
        "figure3": texts.about_policies(TUNED_SMALL if asked.quick else TUNED, TUNED_SMALL, TUNED_ON),
        "figure4": texts.FIGURE4,
        "flown": texts.about_flights(FLOWN, asked.flown, CORRIDOR_M, SEVERITY),
    }
