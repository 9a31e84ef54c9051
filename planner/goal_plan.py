"""What is found for one goal on a user's own matrices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from planner.dead_end import DeadEnd
from planner.ground import Cell
from planner.route import Route
from planner.staged import StageEnd
from planner.survival import Survival


@dataclass(frozen=True, slots=True)
class GoalPlan:
    """What was found for one goal.

    `route` is None where `reason` says why. `stages`: the best route so far at the end of each stage, by the
    plan's objective. `gap`: how far the score may lie from the optimum (exact). `chance` to survive and
    `abstained`: where a probability of hazard is known.
    """

    goal: Cell
    step_s: float
    route: Route | None
    reason: str = ""
    earliest_step: int | None = None
    dead_end: DeadEnd | None = None
    stages: tuple[StageEnd, ...] = ()
    gap: float | None = None
    chance: Survival | None = None
    abstained: bool = False

    @property
    def reachable(self) -> bool:
        """Whether there is a route."""
        return self.route is not None

    def to_dict(self) -> dict[str, Any]:
        """The plan as plain numbers and lists, for JSON; what does not apply is left out."""
        common: dict[str, Any] = {"goal": list(self.goal), "reachable": self.reachable}
        if self.route is None:
            common["reason"] = self.reason
            if self.dead_end is not None:
                end = self.dead_end
                common |= {
                    "nearest": None if end.nearest is None else list(end.nearest),
                    "nearest_distance_cells": end.distance_cells,
                    "nearest_step": end.nearest_step,
                    "last_door_stage": end.last_door_stage,
                }
            return common
        route = self.route
        common |= {
            "depart_step": route.first_step,
            "depart_min": route.first_step * self.step_s / 60.0,
            "arrival_step": route.arrival_step,
            "arrival_min": route.arrival_step * self.step_s / 60.0,
            "flight_min": (route.arrival_step - route.first_step) * self.step_s / 60.0,
            "earliest_step": self.earliest_step,
            "waits": route.waits,
            "moves": route.moves,
            "score": route.score,
            "terms": {
                "clearance": route.terms.clearance,
                "mean_clearance": route.terms.mean_clearance,
                "length": route.terms.length,
                "time": route.terms.time,
            },
            "min_clearance_cells": min(route.clearance_cells),
            "route": [list(place) for place in route.steps],
        }
        if self.stages:
            common["stages"] = list(self._stages())
        if self.gap is not None:
            common["gap"] = self.gap
        if self.chance is not None:
            common |= {"survival": self.chance.at_least, "survival_at_most": self.chance.at_most}
            if self.chance.members is not None:
                common["members_survived"] = self.chance.members_survived
                common["members"] = self.chance.members
            common["abstained"] = self.abstained
        return common

    def _stages(self) -> Iterator[dict[str, Any]]:
        """The stages; a route is written where it is new, else that of the stage before holds."""
        before = None
        for end in self.stages:
            best = end.best
            entry: dict[str, Any] = {
                "stage": end.stage,
                "reachable": best is not None,
                "arrival_step": best.arrival_step if best else None,
                "score": best.score if best else None,
            }
            if best is not None and best != before:
                entry["route"] = [list(place) for place in best.steps]
            before = best
            yield entry
