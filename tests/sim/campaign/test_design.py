"""Which flights a campaign has, and which of them are flown together."""

from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from recordings.errors import RecordingError
from sim.campaign.design import CHUNK, Design
from sim.campaign.flight import MOST_SEEDS, Origin, seed_of
from sim.campaign.shared import weather_part
from sim.campaign.variation import parse_variations
from sim.errors import CampaignError, ScenarioError

HOP = str(Path(__file__).parent.parent / "scenarios" / "hop.toml")


def design(*vary, runs=3, scenario=HOP, given=()):
    return Design.of(Origin.of(scenario), parse_variations(vary), runs, given)


def test_each_combination_flies_the_same_seeds():
    made = design("turbulence.severity=0,3", "planner.kind=staged,windaware")
    flights = [made.flight(run) for run in range(made.count)]
    assert len(flights) == 12
    seeds = {}
    for flight in flights:
        seeds.setdefault(flight.overrides, []).append(flight.seed)
    assert list(seeds.values()) == [[7, 8, 9]] * 4
    assert [flight.run for flight in flights] == list(range(12))
    assert flights[5].load().scenario.turbulence.severity == 0
    assert (
        flights[5]
        .load()
        .toml.startswith("# --set turbulence.severity=0\n# --set planner.kind=windaware\n# --set seed=8\n")
    )


def test_what_is_given_is_in_each_flight_and_the_seed_is_the_first_ones():
    made = design("turbulence.severity=0,3", given=("hazard.corridor_m=400", "seed=40", " seed = 50"), runs=2)
    flights = [made.flight(run) for run in range(made.count)]
    assert [flight.seed for flight in flights] == [50, 50, 51, 51]
    assert flights[1].settings == ("hazard.corridor_m=400", "turbulence.severity=3", "seed=50")
    assert {flight.load().scenario.hazard.corridor_m for flight in flights} == {400.0}


def test_a_scenario_that_is_whole_with_what_is_given_or_varied_alone_is_flown(tmp_path):
    path = tmp_path / "template.toml"
    path.write_text(Path(HOP).read_text().replace('goal = "There"', 'goal = "to be named"'))
    made = design(runs=2, scenario=str(path), given=("mission.goal=There",))
    assert [made.flight(run).seed for run in range(2)] == [7, 8]
    assert made.flight(1).load().scenario.mission.goal == "There"
    assert made.origin.toml == path.read_text()
    assert design("mission.goal=There", runs=2, scenario=str(path)).first_seed == 7
    with pytest.raises(ScenarioError, match="'to be named' is not among"):
        design(runs=2, scenario=str(path))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("turbulence.severty=0", "did you mean 'severity'"),
        ("turbulence.severity", "not of the form"),
        ("seed=-1", "seed"),
        ("seed=often", "seed"),
        ("hazard.corridor_m=7", r"--vary hazard\.corridor_m leaves nothing of --set hazard\.corridor_m=7"),
    ],
)
def test_what_is_given_and_never_right_is_refused(given, words):
    for vary in ((), ("hazard.corridor_m=400,500",)):
        if vary or "corridor" not in given:
            with pytest.raises((CampaignError, ScenarioError), match=words):
                design(*vary, given=(given,))


def test_a_table_that_is_varied_leaves_nothing_of_a_value_in_it():
    with pytest.raises(CampaignError, match="leaves nothing of"):
        design("hazard={corridor_m = 400},{corridor_m = 500}", given=("hazard.corridor_m=7",))
    assert design("hazard.corridor_m=400,500", given=("hazard={threshold_mps = 20}",)).count == 6


def test_more_runs_only_add_flights():
    few, many = design("turbulence.severity=0,3", runs=2), design("turbulence.severity=0,3", runs=5)
    assert [few.flight(run) for run in range(4)] == [many.flight(run) for run in range(4)]


def test_seeds_begin_again_behind_the_largest():
    assert seed_of(MOST_SEEDS - 1, 0) == MOST_SEEDS - 1
    assert seed_of(MOST_SEEDS - 1, 2) == 1


ERRING = ("weather.error.kind=none,growing", "turbulence.severity=0,3", "weather.truth.speed_factor=1.0,1.1")


@pytest.fixture(scope="module")
def erring():
    """A campaign of which half the flights have weather by their seeds, and the weather of each."""
    made = design(*ERRING, runs=6)
    return made, [weather_part(made.flight(run).load().scenario) for run in range(made.count)]


@settings(deadline=None, max_examples=50)
@given(st.sets(st.integers(0, 8 * 6 - 1)), st.integers(1, 64))
def test_what_is_left_is_in_one_chunk_each_and_chunks_share_their_weather(erring, landed, workers):
    made, weather = erring
    chunks = list(made.chunks(landed, workers))
    flown = [flight.run for chunk in chunks for flight in chunk]
    assert sorted(flown) == sorted(set(range(made.count)) - landed)
    assert all(1 <= len(chunk) <= CHUNK for chunk in chunks)
    assert all(len({weather[flight.run] for flight in chunk}) == 1 for chunk in chunks)
    changes = sum(weather[before] != weather[after] for before, after in pairwise(flown))
    assert changes == max(len({weather[run] for run in flown}) - 1, 0)  # none comes twice


def test_chunks_are_small_enough_for_all_workers():
    sizes = [len(chunk) for chunk in design(runs=100).chunks((), 8)]
    assert sizes[0] == 3
    assert sizes[-1] == 1
    assert len(next(design(runs=100).chunks((), 2))) == CHUNK


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("turbulence.severty=0,3", r"unknown key 'turbulence\.severty'.*did you mean 'severity'"),
        ("turbulense.severity=0", "turbulence"),
        ("turbulence.severity=0,9", "turbulence.severity.*9"),
        ("seed.x=1", "value, not a table"),
        ("mission.goal=Nowhere", "Nowhere"),
        ('limits=["cross_track_m.p95 <= 2"],["cross_trak_m.p95 <= 2"]', "cross_trak_m"),
        ("aircraft.model=aerosonde,aerosond", "did you mean 'aerosonde'"),
        ("weather.file=missing.hurdat2", "missing.hurdat2|no weather file"),
    ],
)
def test_a_value_that_is_never_right_is_refused(vary, words):
    with pytest.raises((CampaignError, ScenarioError, RecordingError), match=words):
        design("hazard.corridor_m=0,500", vary)


def test_a_combination_that_is_not_right_is_left_to_its_flights():
    made = design("planner.kind=staged,windaware", "planner.objective=earliest,fuel")
    refused = [combination for combination in made.combinations if combination.scenario is None]
    assert [combination.overrides for combination in refused] == [
        ("planner.kind=staged", "planner.objective=fuel")
    ]
    assert "fuel" in refused[0].refusal
    assert made.count == 12


def test_a_scenario_that_is_not_right_is_refused(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(Path(HOP).read_text().replace('"cross_track_m.p95 <= 2"', '"cross_trak_m <= 2"'))
    with pytest.raises((CampaignError, RecordingError), match="cross_trak_m"):
        design(scenario=str(path))
    with pytest.raises(ScenarioError, match="neither a file nor one of"):
        design(scenario="nowhere")


def test_too_many_flights_are_refused():
    with pytest.raises(CampaignError, match="limit is 1000000"):
        design("turbulence.severity=0,3", runs=500_001)
