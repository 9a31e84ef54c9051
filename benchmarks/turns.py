"""Sides that take turns, so that a machine whose own speed changes within minutes favours none of them.

Ratios are taken within a round, from neighbours in time; what is told is the median of all rounds, with the
least and the greatest beside it: how far apart these are says how far the machine can be trusted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from statistics import median
from typing import NamedTuple, TypeVar

T = TypeVar("T")


class Spread(NamedTuple):
    """Of the rounds."""

    median: float
    least: float
    greatest: float

    @classmethod
    def of(cls, values: Iterable[float]) -> Spread:
        """Of one value a round."""
        found = list(values)
        return cls(median(found), min(found), max(found))

    def told(self, text: Callable[[float], str]) -> str:
        """Such as "1.87 x (1.84 to 1.92)"."""
        least, greatest = (text(value).removesuffix(" x").removesuffix(" %") for value in self[1:])
        return f"{text(self.median)} ({least} to {greatest})"


def in_turns(sides: Sequence[Callable[[int], T]], rounds: int) -> Iterator[tuple[T, ...]]:
    """What the sides give in each round, in their order; they are called in it, and backwards in every other.

    Each is told the number of the round.
    """
    for number in range(rounds):
        order = list(enumerate(sides))
        found = {at: side(number) for at, side in (order if number % 2 == 0 else reversed(order))}
        yield tuple(found[at] for at in range(len(sides)))
