"""Where cases come from: seeded days of a world at one level of forecast error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from sim.reproduce.days import Day
from sim.reproduce.forecasts import MEMBERS, DayForecasts
from sim.reproduce.outlook import Case
from sim.reproduce.worlds import World


class Source(Protocol):
    """Gives the case of a day; it can be pickled, and its text tells it from any other."""

    def case(self, day: int) -> Case:
        """The mission of a day."""


@dataclass(frozen=True, slots=True)
class SeededDays:
    """Days by their seeds; errors of forecasts are the published means times `scale`."""

    world: World
    scale: float
    members: int = MEMBERS

    def case(self, day: int) -> Case:
        """See `Source`."""
        return DayForecasts(Day(self.world, day), self.scale, self.members).case()
