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
        self.references, self.plans = [], []
        self.abandoned = False

    def begin(self, header):
        self.header = header

    def weather(self, sheet):
        self.sheets.append((len(self.samples), sheet))

    def sample(self, state, guidance):
        self.samples.append((state, guidance))

    def estimate(self, seen):
        self.seen.append(seen)

    def reference(self, time_s, reference):
        self.references.append((time_s, reference))

    def plan(self, issue):
        self.plans.append(issue)

    def event(self, time_s, text):
        self.events.append((time_s, text))

    def finish(self, time_s, outcome, detail):
        self.end = (time_s, outcome, detail)

    def abandon(self):
        self.abandoned = True


@pytest.fixture(scope="session")
def flown(galeway_process, tmp_path_factory):
    """The short scenario, flown once in a process of its own: (finished process, folder)."""
    folder = tmp_path_factory.mktemp("short")
    return galeway_process("fly", str(SHORT), "--out", str(folder)), folder


@pytest.fixture(scope="session")
def assert_one_message():
    """Checks a finished process: (done, exit code, words of the one line that it says)."""

    def check(done, code, *words):
        assert done.returncode == code, done.stderr
        assert "Traceback" not in done.stderr + done.stdout
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        assert len(lines) == 1, done.stderr
        for word in words:
            assert word in lines[0]

    return check


@pytest.fixture
def ran(galeway):
    """Runs the command in this process: (*arguments) -> exit code, stdout, stderr."""

    def run(*arguments):
        done = galeway(*arguments)
        return done.returncode, done.stdout, done.stderr

    return run


@pytest.fixture
def kept():
    return Kept()


@pytest.fixture
def ready():
    """Makes the short flight, or another one, ready: (overrides) -> FlightSetup."""

    def made(*overrides, scenario=SHORT):
        loaded = load_scenario(str(scenario), overrides)
        aircraft = make_aircraft(loaded.scenario)
        weather = bring_weather(loaded)
        return prepare_flight(loaded, weather, make_plan(loaded.scenario, weather, aircraft), aircraft)

    return made
