"""The arrival against departure table that an operator reads, as text and as data."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from planner.departures import Assignment, BestBy, Departures


@dataclass(frozen=True, slots=True)
class Flown:
    """One departure to one goal, minutes from step 0; None what does not apply or is not reached."""

    depart_min: float | None = None
    arrival_min: float | None = None
    flight_min: float | None = None
    survival: float | None = None

    def text(self, *, flight: bool) -> str:
        """The arrival as hours and minutes, with the chance to survive and the time of flight."""
        if self.arrival_min is None or self.flight_min is None:
            return "-"
        survival = "" if self.survival is None else f" {percent(self.survival)}"
        return f"{clock(self.arrival_min)}{survival}{f' ({clock(self.flight_min)})' if flight else ''}"


@dataclass(frozen=True, slots=True)
class DepartureTable:
    """Departure slots that were searched, and the one chosen for each goal.

    `best_by`: what makes a departure the best, and which routes the arrivals are of. `distinct`: no two goals
    share a slot, at the least total of flight minutes. `names`: of the goals.
    """

    departures: Departures
    best_by: BestBy
    distinct: bool
    chosen: Assignment
    names: tuple[str, ...]

    def step_of(self, goal: int) -> int | None:
        """The step of the departure chosen for a goal."""
        slot = self.chosen.slot[goal]
        return None if slot is None else self.departures.slots[slot]

    @property
    def no_slot_left(self) -> str:
        """Why a goal that some slot reaches has none."""
        return f"all {len(self.departures.slots)} departure slots are better used for other goals; give more"

    def flown(self, slot: int | None, goal: int) -> Flown:
        """What one departure comes to for one goal."""
        if slot is None:
            return Flown()
        departures = self.departures
        step, leave, minutes = (
            departures.arrival_step[slot, goal],
            departures.slots[slot],
            departures.step_s / 60,
        )
        if step < 0:
            return Flown(leave * minutes)
        survival = None if departures.survival is None else float(departures.survival[slot, goal])
        return Flown(leave * minutes, int(step) * minutes, int(step - leave) * minutes, survival)

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain numbers and lists for JSON, None where a goal is not reached."""
        goals = range(len(self.names))
        kinds = ["arrival_min", "flight_min", *(["survival"] if self.departures.survival is not None else [])]
        table = []
        for slot in range(len(self.departures.slots)):
            row = [self.flown(slot, goal) for goal in goals]
            columns = {kind: [getattr(flown, kind) for flown in row] for kind in kinds}
            table.append({"depart_min": row[0].depart_min, **columns})
        chosen = [
            {"goal": self.names[goal], **asdict(self.flown(self.chosen.slot[goal], goal))} for goal in goals
        ]
        return {
            "best_by": str(self.best_by),
            "distinct": self.distinct,
            "total_min": self.chosen.total_min,
            "chosen": chosen,
            "table": table,
        }

    def text(self, origin: str = "step 0") -> str:
        """The table with a line for each departure, and below it the departure chosen for each goal.

        Args:
            origin: what times are counted from.
        """
        flight = self.distinct or self.best_by is BestBy.FLIGHT
        lines = [["departure", *(f"{name}  " for name in self.names)]]
        for slot, step in enumerate(self.departures.slots):
            cells = [
                f"{self.flown(slot, goal).text(flight=flight)} {'*' if slot == chosen else ' '}"
                for goal, chosen in enumerate(self.chosen.slot)
            ]
            lines.append([clock(step * self.departures.step_s / 60.0), *cells])
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        shown = "arrival" + (" and survival" if self.best_by is BestBy.SURVIVAL else "")
        return "\n".join(
            [
                f"{shown}{' (flight)' if flight else ''} against departure, h:mm after {origin}; * is chosen",
                *("  ".join(map(str.rjust, line, widths)).rstrip() for line in lines),
                *self._choices(),
            ]
        )

    def _choices(self) -> list[str]:
        lines = []
        for goal, (name, slot) in enumerate(zip(self.names, self.chosen.slot, strict=True)):
            flown = self.flown(slot, goal)
            if flown.depart_min is None or flown.flight_min is None:
                reached = (self.departures.arrival_step[:, goal] >= 0).any()
                lines.append(f"{name}: {self.no_slot_left if reached else 'no departure reaches it'}")
            else:
                lines.append(
                    f"{name}: leave at {clock(flown.depart_min)}, {clock(flown.flight_min)} h of flight"
                )
        if self.distinct:
            missed = self.chosen.slot.count(None)
            lines.append(
                f"total: {self.chosen.total_min:g} min, 1440 of them for each of {missed} goals missed"
            )
        return lines


def clock(minutes: float) -> str:
    """Minutes as hours and minutes."""
    whole = round(minutes)
    return f"{whole // 60}:{whole % 60:02d}"


def percent(chance: float) -> str:
    """A chance as per cent, to three digits."""
    return f"{100.0 * chance:.3g} %"
