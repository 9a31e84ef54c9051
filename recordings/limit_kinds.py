"""The kinds of limits, and over which part of a flight they hold; `str` of each is as it is written."""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import UTC, datetime

from aircraft.path import Phase
from recordings.figures import clock, number

Value = bool | str | float

PHASES = {
    "takeoff": Phase.LEAD_IN,
    "lead_in": Phase.LEAD_IN,
    "leg": Phase.LEG,
    "turn": Phase.TURN,
    "loiter": Phase.LOITER,
}
"""By the name that a limit gives them. Flights begin in the air: their takeoff is the lead-in."""


@dataclass(frozen=True, slots=True)
class Time:
    """A time since departure, or, if `absolute`, since 1970-01-01 UTC; whole seconds."""

    time_s: int
    absolute: bool = False

    def since(self, departure_s: float) -> float:
        """The time since a departure."""
        return self.time_s - departure_s if self.absolute else float(self.time_s)

    def __str__(self) -> str:
        if not self.absolute:
            return clock(self.time_s).removesuffix(":00").removeprefix("0")
        moment = datetime.fromtimestamp(self.time_s, UTC)
        return f"{moment:%Y-%m-%dT%H:%M}" + (f":{moment:%S}Z" if moment.second else "Z")


@dataclass(frozen=True, slots=True)
class During:
    """Some phases of the flight, by name, or all of it but them."""

    phases: tuple[str, ...]
    excepted: bool = False

    def __str__(self) -> str:
        phases = " or ".join(json.dumps(name) for name in self.phases)
        return f"{'except ' if self.excepted else ''}during {phases}"


@dataclass(frozen=True, slots=True)
class Span:
    """The flight between two times, both included, or all of it but that; None is its beginning or end."""

    start: Time | None
    end: Time | None
    excepted: bool = False

    def __str__(self) -> str:
        if self.start is None:
            text = f"until {self.end}"
        else:
            text = f"from {self.start}" + (f" to {self.end}" if self.end is not None else "")
        return f"{'except ' if self.excepted else ''}{text}"


Window = tuple[During | Span, ...]
"""Where all of them agree; empty for the whole flight."""


@dataclass(frozen=True, slots=True)
class Compared:
    """A figure of the report or a statistic of a quantity, by name, and what it has to be."""

    name: str
    comparison: str
    bound: Value
    window: Window = ()

    def __str__(self) -> str:
        return _written(self.name, self.comparison, literal(self.bound), *self.window)


@dataclass(frozen=True, slots=True)
class Within:
    """What a quantity has to be at every moment: between two bounds; without `low`, of no greater size."""

    name: str
    low: float | None
    high: float
    window: Window = ()

    def __str__(self) -> str:
        band = literal(self.high) if self.low is None else f"{literal(self.low)} to {literal(self.high)}"
        return _written(self.name, "within", band, *self.window)


@dataclass(frozen=True, slots=True)
class Always:
    """What a quantity has to be at every moment: on one side of a bound, its sign counting."""

    name: str
    comparison: str
    bound: float
    window: Window = ()

    def __str__(self) -> str:
        return _written(self.name, "always", self.comparison, literal(self.bound), *self.window)


@dataclass(frozen=True, slots=True)
class Happening:
    """An end of the flight, such as "crashed", or, if `quoted`, events with some words in them."""

    words: str
    quoted: bool

    def __str__(self) -> str:
        return literal(self.words) if self.quoted else self.words


@dataclass(frozen=True, slots=True)
class Never:
    """What must not happen."""

    happening: Happening
    window: Window = ()

    def __str__(self) -> str:
        return _written("never", self.happening, *self.window)


@dataclass(frozen=True, slots=True)
class Timely:
    """What has to happen, and before or after which time it has to happen first."""

    happening: Happening
    before: bool
    time: Time

    def __str__(self) -> str:
        return _written(self.happening, "before" if self.before else "after", self.time)


Limit = Compared | Within | Always | Never | Timely


@dataclass(frozen=True, slots=True)
class Against:
    """A limit that was made of what an earlier flight did: `before`, with a tolerance, for people."""

    limit: Compared
    before: Value | None
    tolerance: str

    def __str__(self) -> str:
        was = "nothing" if self.before is None else short(self.before)
        if not isinstance(self.before, float):
            return f"{self.limit.name} as before: {was}"
        side, sign = {"<=": ("at most", "+"), ">=": ("at least", "-")}[self.limit.comparison]
        return f"{self.limit.name} {side} {was} ({sign} {self.tolerance})"


def literal(value: Value) -> str:
    """A value as it is written in a limit, in all of its digits."""
    if isinstance(value, float):
        return repr(value).removesuffix(".0")
    return json.dumps(value, ensure_ascii=False)


def short(value: Value) -> str:
    """A value for people, its digits as many as say something."""
    return number(value) if isinstance(value, float) else literal(value)


def _written(*parts: object) -> str:
    return " ".join(map(str, parts))
