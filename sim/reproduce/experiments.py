"""The experiments: their tasks, what is kept of them, and their part of the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from planner.pictures import figures
from sim.reproduce import figure2, figure3, figure4, figure_flown
from sim.reproduce.arrivals_by_policy import Rows
from sim.reproduce.costs import costs_by_day
from sim.reproduce.days_judged import DayTask, judge_day
from sim.reproduce.flights import FlownTask, Row, fly_task
from sim.reproduce.kept import Kept
from sim.reproduce.one_stage import compare_in_one_stage, longest_pair
from sim.reproduce.own_days import OwnDays
from sim.reproduce.page import prose
from sim.reproduce.policies import POLICIES
from sim.reproduce.sources import SeededDays
from sim.reproduce.tuning import Tuning
from sim.reproduce.worlds import World

PARTS = ("figure2", "figure3", "figure4", "flown")

LEVELS = {1.0: "published errors", 2.0: "twice those"}
"""Scale of the errors of forecasts to its title."""

ABSTAINS_AS = {"abstain": "survival"}
"""Policies that fly another one's plans, or none."""

Tell = Callable[[str, int, int], object]


@dataclass(frozen=True)
class Experiments:
    """What is asked for.

    `source`: of the days, at each level of error by its title. `days`: their numbers. `flown_world`,
    `flown_days`: of the flights. `replan`: whether figure 3 has replanning, too. `tell`: told of a part how
    many tasks are done, and of how many.
    """

    sources: dict[str, SeededDays | OwnDays]
    days: Sequence[int]
    tuning: Tuning
    flown_world: World
    flown_days: Sequence[int]
    kept: Kept
    replan: bool
    tell: Tell

    def figure2(self, folder: Path) -> list[str]:
        """Draw figure 2 and tell of it."""
        tasks = self._tasks(next(iter(self.sources.values())), ("bfs", "score"))
        found = self.kept.all(compare_in_one_stage, _each(tasks), self._told("figure2"))
        drawn = longest_pair(tasks[0])
        picture = None
        if drawn is not None:
            figure2.draw(*drawn, folder / "figure2.png", self.tuning.weights.clearance_cap_cells)
            picture = f"{folder.name}/figure2.png"
        return figure2.section(found, picture)

    def figure3(self, folder: Path) -> list[str]:
        """Draw figure 3 and tell of it."""
        levels = {level: self._judged(source, level) for level, source in self.sources.items()}
        found = figure3.figures_by_policy(levels)
        shown = figure3.first_days(len(self.days))
        by_day = f"figure3_{shown.replace(' ', '_')}.png"
        figure3.draw_five(levels, folder / by_day)
        figure3.draw_means(found, folder / "figure3.png")
        return [
            f"![Safe arrivals on {shown}]({folder.name}/{by_day})",
            "",
            *figure3.five_days(levels),
            f"![Safe arrivals and losses over all days]({folder.name}/figure3.png)",
            "",
            *figure3.section(levels, found),
            prose(
                """The aim: half of the gap between the paper's score and the oracle closed at every level of
                error, without more than 5 % longer flights on those that arrive in both."""
            ),
            "",
            *figure3.verdict(found, len(self.days)),
        ]

    def figure4(self, folder: Path) -> list[str]:
        """Draw figure 4 and tell of it."""
        level, source = next(iter(self.sources.items()))
        costs = costs_by_day(self._judged(source, level, replanned=False))
        if not len(costs.days):
            return ["On no day both planners have a route to the same goal, so there is nothing to compare."]
        figure4.draw(costs, folder / "figure4.png")
        return [
            f"![Cost by day]({folder.name}/figure4.png)",
            "",
            *figure4.section(costs),
        ]

    def flown(self, folder: Path) -> list[str]:
        """Fly, draw and tell of it."""
        chunks = [
            [
                FlownTask(self.flown_world, day, scale, policy, goal)
                for policy in POLICIES
                if policy not in ABSTAINS_AS
                for goal in range(self.flown_world.goals)
            ]
            for day in self.flown_days
            for scale in LEVELS
        ]
        rows: list[Row] = self.kept.all(fly_task, chunks, self._told("flown"))
        found = figure_flown.ranked(rows, LEVELS)
        figure_flown.draw(rows, found, folder / "flown.png")
        return [
            f"![Planned and flown]({folder.name}/flown.png)",
            "",
            *figure_flown.section(rows, found),
        ]

    def _judged(self, source: SeededDays | OwnDays, level: str, *, replanned: bool = True) -> list[Rows]:
        """The rows of all days; replanning is dear and kept apart."""
        plain = tuple(name for name, policy in POLICIES.items() if not policy.replans)
        days: list[Rows] = self._done(source, plain, f"{level}, planned once")
        if replanned and self.replan:
            replanning = tuple(name for name, policy in POLICIES.items() if policy.replans)
            more = self._done(source, replanning, f"{level}, replanned")
            days = [rows | other for rows, other in zip(days, more, strict=True)]
        return days

    def _done(self, source: SeededDays | OwnDays, policies: tuple[str, ...], title: str) -> list[Any]:
        tasks = self._tasks(source, policies)
        return self.kept.all(judge_day, _each(tasks), self._told(title))

    def _tasks(self, source: SeededDays | OwnDays, policies: tuple[str, ...]) -> list[DayTask]:
        return [DayTask(source, day, policies, self.tuning) for day in self.days]

    def _told(self, part: str) -> Callable[[int, int], object]:
        return lambda done, of: self.tell(part, done, of)


def _each(tasks: Sequence[DayTask]) -> list[list[DayTask]]:
    """Each in a chunk of its own."""
    return [[task] for task in tasks]


def check_drawable() -> None:
    """Find out before anything takes its minutes whether pictures can be drawn; PlannerError if not."""
    figures()
