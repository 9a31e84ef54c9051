"""One flight of a campaign: what is needed to fly it, and nothing that takes room."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from sim.scenario import LoadedScenario, scenario_of, scenario_text

MOST_SEEDS = 2**31
"""Seeds of scenarios are below this; beyond it they begin again at 0."""


@dataclass(frozen=True, slots=True)
class Origin:
    """The scenario that a campaign varies.

    `source`: the name or path that the user gave; `folder`: what the paths in it start from.
    """

    toml: str
    source: str
    folder: Path

    @classmethod
    def of(cls, name_or_path: str) -> Origin:
        """Read a scenario by its built-in name or its path; it may make sense with other values alone.

        Raises:
            ScenarioError: if there is no such scenario, or it cannot be read.
        """
        toml, path = scenario_text(name_or_path)
        return cls(toml, name_or_path, path.parent.absolute())

    @property
    def sha256(self) -> str:
        """Of the text."""
        return hashlib.sha256(self.toml.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Flight:
    """One flight: the scenario with values in place of its own, and a seed.

    `run`: its number in the campaign. `overrides`: "table.key=value" of what is varied. Flights share their
    origin, so that many of them, pickled together, hold its text once.
    """

    run: int
    origin: Origin
    overrides: tuple[str, ...]
    seed: int

    @property
    def settings(self) -> tuple[str, ...]:
        """All overrides, the seed last: what `galeway fly --set` is given for the same flight."""
        return (*self.overrides, f"seed={self.seed}")

    def load(self) -> LoadedScenario:
        """Its scenario.

        Raises:
            ScenarioError: if the values do not go together.
        """
        return scenario_of(self.origin.toml, self.origin.source, self.origin.folder, self.settings)


def seed_of(first: int, index: int) -> int:
    """The seed of the flights with one index: that of the scenario, the next one, and so on."""
    return (first + index) % MOST_SEEDS
