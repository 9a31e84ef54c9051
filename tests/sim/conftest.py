"""The short scenario, ready to fly, and a recorder that keeps everything in memory."""

from pathlib import Path

import pytest

from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import load_scenario
from sim.weather.source import bring_weather

SHORT = Path(__file__).parent / "scenarios" / "short.toml"


class Kept:
    """Keeps what it is told."""

    def __init__(self):
        self.header = self.end = None
        self.sheets, self.samples, self.seen, self.events = [], [], [], []
        self.abandoned = False

    def begin(self, header):
        self.header = header

    def weather(self, sheet):
        self.sheets.append((len(self.samples), sheet))

    def sample(self, state, guidance):
        self.samples.append((state, guidance))

    def estimate(self, seen):
        self.seen.append(seen)

    def event(self, time_s, text):
        self.events.append((time_s, text))

    def finish(self, time_s, outcome, detail):
        self.end = (time_s, outcome, detail)

    def abandon(self):
        self.abandoned = True


@pytest.fixture
def kept():
    return Kept()


@pytest.fixture
def ready():
    """Makes the short flight ready: (overrides) -> FlightSetup."""

    def made(*overrides):
        loaded = load_scenario(str(SHORT), overrides)
        aircraft = make_aircraft(loaded.scenario)
        weather = bring_weather(loaded)
        return prepare_flight(loaded, weather, make_plan(loaded.scenario, weather, aircraft), aircraft)

    return made
