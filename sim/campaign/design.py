"""All flights of a campaign: each combination of the varied values, flown with the same seeds."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from aircraft.errors import AircraftError
from recordings.errors import RecordingError
from recordings.limits import parse_limits
from sim.campaign.flight import Flight, Origin, seed_of
from sim.campaign.named_files import named_files
from sim.campaign.shared import depends_on_seed, weather_part
from sim.campaign.variation import Variation, combinations, require_apart
from sim.errors import CampaignError, ScenarioError, SimError
from sim.overrides import key_of
from sim.scenario import Scenario, scenario_of

MOST_FLIGHTS = 1_000_000
CHUNK = 8
"""Flights given to a worker at once, at most: enough to keep their weather together."""


@dataclass(frozen=True, slots=True)
class Combination:
    """Overrides, and what the scenario is with them; None if it does not make sense, which `refusal` says."""

    overrides: tuple[str, ...]
    scenario: Scenario | None
    files: tuple[Path, ...] = ()
    refusal: str = ""


@dataclass(frozen=True, slots=True)
class Design:
    """What is flown: each combination with `runs` seeds; more runs would add flights at the end.

    `settings`: "table.key=value" of what all flights have in place of the scenario's values; each combination
    begins with them.
    """

    origin: Origin
    settings: tuple[str, ...]
    variations: tuple[Variation, ...]
    combinations: tuple[Combination, ...]
    runs: int
    first_seed: int

    @classmethod
    def of(
        cls, origin: Origin, variations: Sequence[Variation], runs: int, given: Sequence[str] = ()
    ) -> Design:
        """Check all combinations, with the overrides that are given for all; their seed is the first one.

        A combination may be refused, and its flights will be; a value that is refused in all of its
        combinations is a mistake.

        Raises:
            SimError: if the scenario makes no sense with any combination; AircraftError, RecordingError
                for its aircraft and limits. CampaignError if there are too many flights.
        """
        seeds = [override for override in given if key_of(override) == "seed"]
        settings = tuple(override for override in given if override not in seeds)
        require_apart(settings, variations)
        mixed = [(*settings, *varied) for varied in combinations(variations)]
        if len(mixed) * runs > MOST_FLIGHTS:
            raise CampaignError(
                f"{len(mixed)} combinations with {runs} seeds each are {len(mixed) * runs} flights, the "
                f"limit is {MOST_FLIGHTS}; lower --runs or vary less"
            )
        first_seed = _seed(origin, [settings, *mixed], seeds)
        checked = tuple(_checked(Flight(0, origin, overrides, first_seed)) for overrides in mixed)
        for override in (override for variation in variations for override in variation.overrides):
            having = [combination for combination in checked if override in combination.overrides]
            if all(combination.scenario is None for combination in having):
                raise CampaignError(f"{having[0].refusal} (with {', '.join(having[0].overrides)})")
        if checked[0].scenario is None and not variations:
            raise CampaignError(checked[0].refusal)
        return cls(origin, settings, tuple(variations), checked, runs, first_seed)

    @property
    def count(self) -> int:
        """Of flights."""
        return self.runs * len(self.combinations)

    def flight(self, run: int) -> Flight:
        """One of them, by its number."""
        index, which = divmod(run, len(self.combinations))
        return Flight(run, self.origin, self.combinations[which].overrides, seed_of(self.first_seed, index))

    def chunks(self, landed: Collection[int], workers: int) -> Iterator[tuple[Flight, ...]]:
        """The flights that are left, those that share weather together; smaller chunks towards the end."""
        groups = self._groups()
        left = [run for run in range(self.count) if run not in landed]
        left.sort(key=lambda run: (*self._group(run, groups), run))
        begin = 0
        while begin < len(left):
            size = max(1, min(CHUNK, (len(left) - begin) // (4 * workers)))
            first = self._group(left[begin], groups)
            chunk = [run for run in left[begin : begin + size] if self._group(run, groups) == first]
            yield tuple(map(self.flight, chunk))
            begin += len(chunk)

    def _groups(self) -> list[tuple[bool, int]]:
        """Of each combination: whether its weather depends on the seed, and a number for it otherwise."""
        numbers: dict[Scenario | None, int] = {}
        groups = []
        for combination in self.combinations:
            scenario = combination.scenario
            weather = None if scenario is None else weather_part(scenario)
            by_seed = scenario is not None and depends_on_seed(scenario)
            groups.append((by_seed, numbers.setdefault(weather, len(numbers))))
        return groups

    def _group(self, run: int, groups: Sequence[tuple[bool, int]]) -> tuple[int, int]:
        """What tells the weather of flights apart: a seed where it matters, and the combination's number."""
        index, which = divmod(run, len(self.combinations))
        by_seed, number = groups[which]
        return (index if by_seed else -1, number)


def _seed(origin: Origin, tried: Sequence[tuple[str, ...]], seeds: Sequence[str]) -> int:
    """The scenario's, or the given one; the values that it is tried with are needed where it is not whole.

    Raises:
        ScenarioError: what is wrong with the first of them, if the scenario makes no sense with any.
    """
    refusal: ScenarioError | None = None
    for overrides in tried:
        try:
            return scenario_of(origin.toml, origin.source, origin.folder, (*overrides, *seeds)).scenario.seed
        except ScenarioError as error:
            refusal = refusal or error
    assert refusal is not None  # there is one combination at least
    raise refusal


def _checked(flight: Flight) -> Combination:
    """What can be told of a combination from one of its flights, without weather."""
    try:
        loaded = flight.load()
        parse_limits(loaded.scenario.limits)
        return Combination(flight.overrides, loaded.scenario, tuple(named_files(loaded)))
    except (SimError, AircraftError, RecordingError) as error:
        return Combination(flight.overrides, None, refusal=str(error))
