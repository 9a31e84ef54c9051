"""What a campaign varies: `--vary 'planner.kind=staged,windaware'`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

from sim.errors import CampaignError
from sim.overrides import key_of

_EXAMPLE = "write, for example, 'turbulence.severity=0,3,4'"
_PIECE = re.compile(
    r"""(?P<text>"(?:\\.|[^"\\])*"|'[^']*'|[^\[\]{},"']+)|(?P<open>[\[{])|(?P<close>[\]}])|(?P<comma>,)|(?P<stray>.)""",
    re.DOTALL,
)


@dataclass(frozen=True, slots=True)
class Variation:
    """A key of the scenario and the values that it takes, as they were written."""

    key: str
    values: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.key}={','.join(self.values)}"

    @property
    def overrides(self) -> tuple[str, ...]:
        """One for each value, of the form "table.key=value"."""
        return tuple(f"{self.key}={value}" for value in self.values)


def parse_variations(texts: Iterable[str]) -> tuple[Variation, ...]:
    """From the texts of `--vary`.

    Raises:
        CampaignError: if one has no key, no value or one twice, or a key is varied twice, or the seed.
    """
    found: dict[str, Variation] = {}
    for text in texts:
        variation = _parse(text)
        if variation.key in found:
            raise CampaignError(f"--vary {variation.key} is given twice; give all of its values at once")
        found[variation.key] = variation
    return tuple(found.values())


def combinations(variations: Iterable[Variation]) -> list[tuple[str, ...]]:
    """Each value of each key with each of the others, the last key's changing fastest."""
    return list(product(*(variation.overrides for variation in variations)))


def require_apart(settings: Iterable[str], variations: Iterable[Variation]) -> None:
    """Pass if no value that all flights are given is put aside by one that is varied.

    Raises:
        CampaignError: naming one that is.
    """
    for setting, variation in product(settings, variations):
        if f"{key_of(setting)}.".startswith(f"{variation.key}."):
            raise CampaignError(f"--vary {variation.key} leaves nothing of --set {setting}; give one of them")


def _parse(text: str) -> Variation:
    key, equals, rest = text.partition("=")
    key, values = key.strip(), tuple(value.strip() for value in _split(rest))
    if not equals or not key:
        raise CampaignError(f"--vary {text!r} is not of the form table.key=value,value; {_EXAMPLE}")
    if key == "seed":
        raise CampaignError("--vary seed is not needed: --runs N flies each combination with N seeds")
    if not all(values):
        raise CampaignError(f"--vary {text!r} has a value that is empty; {_EXAMPLE}")
    for value in values:
        if values.count(value) > 1:
            raise CampaignError(f"--vary {text!r} has the value {value} twice; give it once")
    return Variation(key, values)


def _split(text: str) -> Iterator[str]:
    """The parts between commas that stand neither in quotes nor in brackets."""
    part, depth = "", 0
    for piece in _PIECE.finditer(text):
        if piece["comma"] and depth == 0:
            yield part
            part = ""
            continue
        part += piece[0]
        depth += bool(piece["open"]) - bool(piece["close"])
    yield part
