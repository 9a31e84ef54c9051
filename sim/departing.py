"""Departure slots as they are given on the command line."""

from __future__ import annotations

from dataclasses import dataclass

from sim.errors import SimError


@dataclass(frozen=True, slots=True)
class Departing:
    """Which departures are searched, minutes after the first possible one, and what is made of them."""

    slots_min: tuple[float, float, float]
    best_by: str
    distinct: bool

    @classmethod
    def parsed(cls, slots: str | None, best_by: str | None, distinct: bool) -> Departing | None:
        """What the options ask for, None without departures.

        Args:
            slots: "first:last:every", in minutes.
            best_by: "arrival" if not given.
            distinct: whether no two goals may share a slot.

        Raises:
            SimError: if the slots are not of that form, or the options do not go together.
        """
        if slots is None:
            for option, given in (("--best-by", best_by is not None), ("--distinct", distinct)):
                if given:
                    raise SimError(f"{option} chooses among departures; add --departures FIRST:LAST:EVERY")
            return None
        if distinct and best_by is not None:
            raise SimError(
                f"--distinct chooses departures by the total of flight minutes; leave out --best-by {best_by}"
            )
        try:
            first, last, every = (float(part) for part in slots.split(":"))
        except ValueError:
            raise SimError(
                f"--departures {slots!r} is not of the form FIRST:LAST:EVERY in minutes, such as 0:600:30"
            ) from None
        return cls((first, last, every), best_by or "arrival", distinct)
