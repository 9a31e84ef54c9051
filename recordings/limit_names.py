"""What a limit can be on: figures of the report, quantities and their statistics, by name."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from functools import cache
from typing import NamedTuple, get_type_hints

import numpy as np

from recordings.figures import Floats
from recordings.quantities import DURATIONS, QUANTITIES
from recordings.tracking import Tracking
from recordings.tracking_report import NOT_REPORTED

_STATISTIC = re.compile(r"mean|min|max|p(\d{1,2}(?:\.\d+)?|100)")
_OF_THE_COMPUTER = "real_time_factor"
_STATISTICS = "mean, min, max and percentiles such as p95"


class UnknownNameError(ValueError):
    """A name that a limit cannot be on; the message is the rest of "the limit ... "."""


class Statistic(NamedTuple):
    """A quantity and what is made of its values."""

    quantity: str
    statistic: str

    def of(self, values: Floats) -> float:
        """The statistic of one value or more."""
        if self.statistic.startswith("p"):
            return float(np.percentile(values, float(self.statistic[1:])))
        return float(getattr(np, self.statistic)(values))


def statistic(name: str) -> Statistic | None:
    """The parts of a name such as "cross_track_m.p95"; None if it is no such name."""
    quantity, _, of = name.partition(".")
    known = quantity in QUANTITIES and _STATISTIC.fullmatch(of)
    return Statistic(quantity, of) if known else None


@cache
def figure_kinds() -> dict[str, type]:
    """Every figure of a report, such as "arrived" or "cross_track_m.p95", and its type."""
    kinds: dict[str, type] = {}
    hints = get_type_hints(Tracking)
    for field in fields(Tracking):
        hint = hints[field.name]
        if field.name in NOT_REPORTED:
            continue
        if is_dataclass(hint):
            kinds |= {f"{field.name}.{part.name}": float for part in fields(hint)}
        else:
            kinds[field.name] = hint if hint in (bool, str) else float
    return kinds


def compared_kind(name: str) -> type:
    """The type of a figure or statistic.

    Raises:
        UnknownNameError: if it is neither.
    """
    if name in figure_kinds():
        return figure_kinds()[name]
    if statistic(name):
        return float
    _require_recorded(name)
    quantity, dot, of = name.partition(".")
    if quantity not in QUANTITIES:
        raise UnknownNameError(f"is on {name}, which no report has; {_nearest_name(name)}")
    within = f"or limit every moment, `{quantity} within 2`"
    if dot:
        raise UnknownNameError(f"is on {of or 'no statistic'} of {quantity}; it has {_STATISTICS}, {within}")
    raise UnknownNameError(
        f"is on {name}, which is measured all through a flight; did you mean {name}.mean or {name}.p95 or "
        f"{name}.max? There are {_STATISTICS}; {within}"
    )


def require_quantity(name: str) -> None:
    """Pass if it is measured all through a flight.

    Raises:
        UnknownNameError: if it is not.
    """
    _require_recorded(name)
    quantity, dot, _ = name.partition(".")
    if quantity in QUANTITIES and dot:
        raise UnknownNameError(f"is on every moment of {name}, which has none; did you mean {quantity}?")
    if name in figure_kinds():
        raise UnknownNameError(f"is on every moment of {name}, which is one figure; write `{name} <= …`")
    if name not in QUANTITIES:
        raise UnknownNameError(f"is on {name}, which is not measured; {nearest(quantity, QUANTITIES)}")


def _require_recorded(name: str) -> None:
    if name == _OF_THE_COMPUTER:
        raise UnknownNameError(
            f"is on {name}, which stands in report.json alone: it says how fast the computer was, and no "
            "recording of a flight holds it"
        )


def has_parts(name: str) -> bool:
    """Whether a figure can be taken over a part of the flight."""
    return name in DURATIONS or statistic(name) is not None


def _nearest_name(name: str) -> str:
    _, dot, of = name.partition(".")
    if dot and _STATISTIC.fullmatch(of):
        return nearest(name, [f"{known}.{of}" for known in QUANTITIES])
    return nearest(name, [*figure_kinds(), *(f"{known}.max" for known in QUANTITIES)])


def nearest(word: str, known: Iterable[str]) -> str:
    """The question whether the nearest of the known words was meant."""
    (near,) = difflib.get_close_matches(word, known, n=1, cutoff=0.0)
    return f"did you mean {near}?"
