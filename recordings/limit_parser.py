"""Reads limits, such as `altitude_error_m within 10 except during "takeoff"`; docs/limits.md has them all."""

from __future__ import annotations

import json
import math
import re
from calendar import timegm
from collections.abc import Callable
from datetime import datetime
from typing import NamedTuple, NoReturn, TypeVar, cast

from recordings.errors import BadLimitError
from recordings.limit_kinds import (
    PHASES,
    Always,
    Compared,
    During,
    Happening,
    Limit,
    Never,
    Span,
    Time,
    Timely,
    Value,
    Window,
    Within,
)
from recordings.limit_names import UnknownNameError, compared_kind, has_parts, nearest, require_quantity
from recordings.recorder import Outcome

EXAMPLE = 'write it like `cross_track_m.p95 <= 2`, `altitude_error_m within 10 except during "takeoff"`'

_TOKEN = re.compile(
    r"""\s*(?:
    (?P<utc>\d{4}-\d\d-\d\dT\d\d:\d\d(?::\d\d)?Z)
  | (?P<clock>\d+:\d\d(?::\d\d)?)(?![\w:.])
  | (?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)
  | (?P<text>"(?:[^"\\]|\\.)*")
  | (?P<word>[A-Za-z_][\w.]*)
  | (?P<comparison><=|>=|==|!=|<|>)
  | (?P<other>\S)
  )""",
    re.VERBOSE | re.DOTALL,
)
_WINDOW = 'during "PHASE", from TIME to TIME, until TIME, each also with except'
_KINDS: dict[type, str] = {bool: "true or false", str: 'a "text"', float: "a number"}
_TIME = "a time since departure such as 1:30 or 1:30:05, or in UTC such as 2022-09-29T12:00Z"

_Known = TypeVar("_Known")


class _Token(NamedTuple):
    kind: str
    text: str
    at: int


def parse_limit(text: str) -> Limit:
    """A limit from its expression.

    Raises:
        BadLimitError: saying what was found where, what was expected there, and the nearest name to one that
            is unknown.
    """
    return _Parser(text).limit()


class _Parser:
    """Reads the tokens of one limit from left to right."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._tokens = [
            _Token(kind, found[kind], found.start(kind))
            for found in _TOKEN.finditer(text.rstrip())
            if (kind := found.lastgroup)
        ]
        self._tokens.append(_Token("end", "", len(text.rstrip())))
        self._next = 0

    def limit(self) -> Limit:
        limit = self._limit()
        if self._peek().kind != "end":
            unit = ", and no unit: it is in the name" if self._peek().kind == "word" else ""
            self._expected(f"nothing more, or {_WINDOW}{unit}")
        return limit

    def _limit(self) -> Limit:
        if self._took("never"):
            return Never(self._happening(), self._window())
        if self._peek().kind == "text" or self._words_ahead(1) in ("before", "after"):
            happening = self._happening()
            side = self._one_of("before", "after")
            return Timely(happening, side == "before", self._time())
        if self._peek().kind != "word":
            self._expected('a name such as cross_track_m.p95, never, or the "words" of an event')
        name = self._take().text
        if self._took("within"):
            return self._within(name)
        if self._took("always"):
            return self._always(name)
        return self._compared(name)

    def _within(self, name: str) -> Within:
        self._check(require_quantity, name)
        low, high = None, self._number()
        if self._took("to"):
            low, high = high, self._number()
        if high <= 0.0 if low is None else low >= high:
            what = "a size above zero" if low is None else f"a bound above {low:g}"
            self._refuse(f"allows nothing: expected {what}, and not {high:g}")
        return Within(name, low, high, self._window())

    def _always(self, name: str) -> Always:
        self._check(require_quantity, name)
        comparison = self._comparison("<=", ">=", "<", ">")
        return Always(name, comparison, self._number(), self._window())

    def _compared(self, name: str) -> Compared:
        kind = self._check(compared_kind, name)
        comparison = self._comparison("<=", ">=", "==", "!=", "<", ">", else_also="within, always, before")
        if kind is not float and comparison not in ("==", "!="):
            self._refuse(f"compares by {comparison}; {name} is {_KINDS[kind]}, use ==")
        bound = self._value(name, kind)
        if name == "outcome" and bound not in list(Outcome):
            near = nearest(cast(str, bound), list(Outcome))
            self._refuse(f"compares with {json.dumps(bound)}, an outcome that no flight has; {near}")
        window = self._window()
        if window and not has_parts(name):
            self._refuse(
                f"is over a part of the flight, but {name} is of the whole; "
                "statistics such as cross_track_m.max, and hazard_exposure_s, can be taken over a part"
            )
        return Compared(name, comparison, bound, window)

    def _happening(self) -> Happening:
        if self._peek().kind == "text":
            words = self._unquoted(self._take())
            if not words.strip():
                self._refuse("names an event without a word")
            return Happening(words, quoted=True)
        outcomes = list(Outcome)
        if self._peek().kind != "word":
            self._expected(f'an end of the flight ({", ".join(outcomes)}), or the "words" of an event')
        word = self._take().text
        if word not in outcomes:
            self._refuse(
                f"names {word}, an end that no flight has; {nearest(word, outcomes)} "
                f'The words of an event stand in quotes: "{word}"'
            )
        return Happening(word, quoted=False)

    def _window(self) -> Window:
        clauses: list[During | Span] = []
        while (excepted := self._took("except")) or self._peek().text in ("during", "from", "until"):
            clause = self._one_of("during", "from", "until")
            if clause == "during":
                clauses.append(During(self._phases(), excepted))
                continue
            start = self._time() if clause == "from" else None
            end = self._time() if clause == "until" or self._took("to") else None
            if start is not None and end is not None and start.absolute == end.absolute:
                self._require_order(start, end)
            clauses.append(Span(start, end, excepted))
        return tuple(clauses)

    def _require_order(self, start: Time, end: Time) -> None:
        if start.time_s >= end.time_s:
            self._refuse(f"is from {start} to {end}, which is no time at all; put the earlier one first")

    def _phases(self) -> tuple[str, ...]:
        phases = [self._phase()]
        while self._took("or"):
            phases.append(self._phase())
        return tuple(phases)

    def _phase(self) -> str:
        if self._peek().kind != "text":
            self._expected(f"a phase in quotes, one of {', '.join(map(json.dumps, PHASES))}")
        phase = self._unquoted(self._take())
        if phase not in PHASES:
            self._refuse(
                f"names the phase {json.dumps(phase)}, which no flight has; they are "
                f"{', '.join(PHASES)}, {nearest(phase, PHASES)}"
            )
        return phase

    def _time(self) -> Time:
        token = self._peek()
        if token.kind not in ("clock", "utc"):
            self._expected(_TIME)
        self._take()
        if token.kind == "utc":
            try:
                return Time(timegm(datetime.fromisoformat(token.text).utctimetuple()), absolute=True)
            except ValueError:
                self._refuse(f"has the time {token.text}, which no calendar has; expected {_TIME}")
        hours, minutes, seconds = (*map(int, token.text.split(":")), 0)[:3]
        if minutes > 59 or seconds > 59:
            self._refuse(f"has the time {token.text}, whose minutes or seconds are over 59; expected {_TIME}")
        return Time(3600 * hours + 60 * minutes + seconds)

    def _number(self) -> float:
        if self._peek().kind != "number":
            self._expected("a number")
        return self._finite(self._take())

    def _finite(self, token: _Token) -> float:
        number = float(token.text)
        if not math.isfinite(number):
            self._refuse(f"has the number {token.text[:12]}…, which is too large to be a number")
        return number

    def _value(self, name: str, kind: type) -> Value:
        token = self._peek()
        if token.kind == "end":
            self._expected(_KINDS[kind])
        self._take()
        if token.kind == "number" and kind is float:
            return self._finite(token)
        if token.kind == "text" and kind is str:
            return self._unquoted(token)
        if token.text in ("true", "false") and kind is bool:
            return token.text == "true"
        return self._refuse(f"compares with {token.text}, but {name} is {_KINDS[kind]}")

    def _unquoted(self, token: _Token) -> str:
        try:
            return cast(str, json.loads(token.text))
        except ValueError:
            self._refuse(f"has the text {token.text}, in which a backslash says nothing that is known")

    def _comparison(self, *allowed: str, else_also: str = "") -> str:
        if self._peek().text not in allowed or self._peek().kind != "comparison":
            self._expected(f"one of {' '.join(allowed)}{' or ' + else_also if else_also else ''}")
        return self._take().text

    def _one_of(self, *words: str) -> str:
        if self._peek().text not in words or self._peek().kind != "word":
            self._expected(f"{' or '.join(words)}")
        return self._take().text

    def _took(self, word: str) -> bool:
        if self._peek().kind == "word" and self._peek().text == word:
            self._next += 1
            return True
        return False

    def _words_ahead(self, count: int) -> str:
        ahead = self._tokens[min(self._next + count, len(self._tokens) - 1)]
        return ahead.text if ahead.kind == "word" else ""

    def _peek(self) -> _Token:
        return self._tokens[self._next]

    def _take(self) -> _Token:
        token = self._peek()
        self._next += 1
        return token

    def _check(self, ask: Callable[[str], _Known], name: str) -> _Known:
        try:
            return ask(name)
        except UnknownNameError as error:
            self._refuse(str(error))

    def _expected(self, what: str) -> NoReturn:
        token = self._peek()
        where = f"at {token.text!r}, character {token.at + 1}" if token.kind != "end" else "at its end"
        self._refuse(f"cannot be understood {where}: expected {what}; {EXAMPLE}")

    def _refuse(self, why: str) -> NoReturn:
        raise BadLimitError(f"the limit {self._text!r} {why}") from None
