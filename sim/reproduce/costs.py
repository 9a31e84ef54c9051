"""Figure 4: the cost by day of plain BFS and of the paper's planner, by equation (2) in the truth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.reproduce.arrivals_by_policy import Rows
from sim.reproduce.bootstrap import Interval, mean_interval


class DayCosts(NamedTuple):
    """Of the days on which both have a route to some goal: mean f over those goals, and how many they are."""

    days: NDArray[np.intp]
    bfs: NDArray[np.float64]
    staged: NDArray[np.float64]
    goals: NDArray[np.intp]

    def means(self) -> tuple[Interval, Interval, Interval]:
        """Over the days: of plain BFS, of the staged planner, and of the second less the first."""
        return mean_interval(self.bfs), mean_interval(self.staged), mean_interval(self.staged - self.bfs)


def costs_by_day(days: Sequence[Rows]) -> DayCosts:
    """Equation (2) of both planners on the goals to which both have a route, safe or not."""
    found = []
    for day, rows in enumerate(days):
        both = [
            (bfs["score"], staged["score"])
            for bfs, staged in zip(rows["bfs"], rows["score"], strict=True)
            if "score" in bfs and "score" in staged
        ]
        if both:
            found.append((day, *np.mean(both, axis=0), len(both)))
    day_of, bfs_f, staged_f, goals = np.array(found, dtype=np.float64).reshape(-1, 4).T
    return DayCosts(day_of.astype(np.intp), bfs_f, staged_f, goals.astype(np.intp))
