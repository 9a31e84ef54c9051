"""Which of a flight's limits can be drawn beside its errors, as levels that the error is to stay between."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_SIZE = re.compile(
    r"\s*(?P<error>\w+)(?:\.(?P<figure>p[\d.]+|max)\s*(?P<comparison><=?)|\s+within)"
    rf"\s*(?:{_NUMBER}\s+to\s+)?(?P<bound>{_NUMBER})(?:\s.*)?"
)
_SIDE = re.compile(rf"\s*(?P<error>\w+)\s+always\s*(?P<comparison>[<>]=?)\s*(?P<bound>{_NUMBER})(?:\s.*)?")


class LimitBand(NamedTuple):
    """A limit on an error. `error`: its name in the report. `text`: "p95 <= 2". `levels`: of its lines."""

    error: str
    text: str
    levels: tuple[float, ...]


def limit_bands(limits: Iterable[str]) -> list[LimitBand]:
    """The limits on errors' percentiles, maxima and single moments; others say nothing of one moment.

    Percentiles, maxima and `within` are of the size of an error, so they bound it on both sides; `always` is
    of its sign, too.
    """
    bands = []
    for limit in limits:
        if size := _SIZE.fullmatch(limit):
            text = f"{size['figure']} {size['comparison']}" if size["figure"] else "within"
            bound = float(size["bound"])
            bands.append(LimitBand(size["error"], f"{text} {size['bound']}", (bound, -bound)))
        elif side := _SIDE.fullmatch(limit):
            text = f"always {side['comparison']} {side['bound']}"
            bands.append(LimitBand(side["error"], text, (float(side["bound"]),)))
    return bands
