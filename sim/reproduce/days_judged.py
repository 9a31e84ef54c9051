"""A day as a task: every policy's plans on it, judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sim.reproduce.judged import judge_policies
from sim.reproduce.sources import Source
from sim.reproduce.tuning import Tuning


@dataclass(frozen=True, slots=True)
class DayTask:
    """One day, to be planned by some policies."""

    source: Source
    day: int
    policies: tuple[str, ...]
    tuning: Tuning


def judge_day(task: DayTask) -> dict[str, Any]:
    """Policy to rows, a goal each."""
    return judge_policies(task.source.case(task.day), task.policies, task.tuning)
