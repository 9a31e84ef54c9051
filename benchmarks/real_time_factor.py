"""What a flight costs beside JSBSim itself: bare `run()`, the closed loop with no, each, both recorders.

The cases take turns, round after round, and of each its quickest round counts: other work on the machine only
adds to a time. Times are of the processor, over all threads: what one core has to do.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from mcap.reader import make_reader

from aircraft.jsbsim_aircraft import IDLE_IN_FLIGHT
from aircraft.state import FlightState
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import FlightHeader, GuidanceSample, Outcome, Recorder, Recorders, WeatherSheet
from recordings.rerun_writer import RerunRecorder
from recordings.schema import STATE
from sim.closed_loop import FlightSetup, fly
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import LoadedScenario, load_scenario
from sim.weather.source import bring_weather
from sim.wind_ahead import WindAhead

TITLE = "Speed of a flight"

ROUNDS = 5
FLOWN_S = 1800.0
LONG_S = 7200.0
WHOLE_S = 18.0 * 3600.0

BARE, LEAN, LOOP, MCAP, RERUN, BOTH = (
    "JSBSim's `run()` alone",
    "the same without what is idle in flight, as the loop has it",
    "closed loop, without recorders",
    "closed loop with MCAP",
    "closed loop with Rerun",
    "closed loop with both",
)


class EnoughError(Exception):
    """The time to measure is over."""


class Kept:
    """A recorder that keeps the samples in memory."""

    def __init__(self) -> None:
        self.samples: list[tuple[FlightState, GuidanceSample]] = []

    def begin(self, header: FlightHeader) -> None:
        pass

    def weather(self, sheet: WeatherSheet) -> None:
        pass

    def sample(self, state: FlightState, guidance: GuidanceSample) -> None:
        self.samples.append((state, guidance))

    def estimate(self, seen: FlightState) -> None:
        pass

    def event(self, time_s: float, text: str) -> None:
        pass

    def finish(self, time_s: float, outcome: Outcome, detail: str) -> None:
        pass

    def abandon(self) -> None:
        pass


class Bench:
    """The scenario `ian`, planned once and flown often."""

    def __init__(self, folder: Path) -> None:
        self.loaded: LoadedScenario = load_scenario("ian")
        self.weather = bring_weather(self.loaded)
        self.plan = make_plan(self.loaded.scenario, self.weather, make_aircraft(self.loaded.scenario))
        self.mcap, self.rrd = folder / "flight.mcap", folder / "flight.rrd"

    def ready(self) -> FlightSetup:
        return prepare_flight(self.loaded, self.weather, self.plan, make_aircraft(self.loaded.scenario))

    def bare_s(self, *, lean: bool = False) -> float:
        """JSBSim as it is, or without its parts that are idle in flight."""
        setup = self.ready()
        for part in IDLE_IN_FLIGHT:
            setup.aircraft.enable(part, not lean)
        steps = round((FLOWN_S + setup.lead_in_s) * setup.aircraft.rate_hz)
        return cpu_s(lambda: setup.aircraft.step(steps))

    def loop_s(self, recorder: Recorder, flown_s: float = FLOWN_S) -> float:
        """Fly for a time, from the opening of the files to their closing."""
        setup = self.ready()

        def stop(time_s: float) -> None:
            if time_s >= flown_s:
                raise EnoughError

        def flight() -> None:
            try:
                fly(setup, recorder, stop)
            except EnoughError:
                return
            raise SystemExit("the flight ended before the time to measure")

        return cpu_s(flight)

    def both(self) -> Recorder:
        return Recorders([McapRecorder(self.mcap), RerunRecorder(self.rrd)])

    def cases(self) -> dict[str, Callable[[], float]]:
        return {
            BARE: self.bare_s,
            LEAN: lambda: self.bare_s(lean=True),
            LOOP: lambda: self.loop_s(Recorders([])),
            MCAP: lambda: self.loop_s(McapRecorder(self.mcap)),
            RERUN: lambda: self.loop_s(RerunRecorder(self.rrd)),
            BOTH: lambda: self.loop_s(self.both()),
        }

    def parts_us(self) -> dict[str, float]:
        """What the loop consists of, each repeated alone on the moments of a flight [us a sample]."""
        kept = Kept()
        self.loop_s(kept)
        states = [state for state, _ in kept.samples]
        commands = [guidance.command for _, guidance in kept.samples]
        setup = self.ready()
        aircraft, frame = setup.aircraft, setup.header.grid.frame
        wind = WindAhead(setup.truth.probe(), setup.header.plan.departure_s, setup.lead_in_s)
        seen = [
            (s, *frame.plane_point(s.lat_rad, s.lon_rad), s.wind_north_mps, s.wind_east_mps) for s in states
        ]
        guided = slice(None, None, setup.sample_hz // setup.guidance_hz)
        parts: dict[str, tuple[Callable[..., object], list[tuple[Any, ...]]]] = {
            "wind at the aircraft": (wind.fly, [(aircraft, state, 0, 0.1) for state in states]),
            "guidance": (setup.guidance.update, seen[guided]),
            "reading the state": (aircraft.state, [()] * len(states)),
            "place in the plane": (frame.plane_point, [moment[0][1:3] for moment in seen[guided]]),
            "commands to the autopilot": (aircraft.command, [(command,) for command in commands[guided]]),
        }

        def repeated_s(call: Callable[..., object], arguments: list[tuple[Any, ...]]) -> float:
            return cpu_s(lambda: [call(*each) for each in arguments])

        return {name: repeated_s(*part) / len(states) * 1e6 for name, part in parts.items()}


class Sizes(NamedTuple):
    """Of the files of a whole flight, and how many times faster than message by message one is read."""

    mcap_mb: float
    rrd_mb: float
    read_ratio: float


def cpu_s(work: Callable[[], object]) -> float:
    begin_s = time.process_time()
    work()
    return time.process_time() - begin_s


def state_by_messages(path: Path) -> int:
    with path.open("rb") as stream:
        return sum(1 for _ in make_reader(stream).iter_messages(topics=[STATE.name]))


def sizes(bench: Bench) -> Sizes:
    """Of a flight of two hours, drawn out to eighteen."""
    bench.loop_s(bench.both(), LONG_S)
    mcap, rrd = (path.with_suffix(f".partial{path.suffix}") for path in (bench.mcap, bench.rrd))
    times = WHOLE_S / LONG_S / 1e6
    columns_s = min(cpu_s(lambda: read(mcap).state) for _ in range(3))
    messages_s = min(cpu_s(lambda: state_by_messages(mcap)) for _ in range(3))
    return Sizes(mcap.stat().st_size * times, rrd.stat().st_size * times, messages_s / columns_s)


def section() -> str:
    """Measure, and give the section of docs/benchmarks.md."""
    with tempfile.TemporaryDirectory() as name:
        bench = Bench(Path(name))
        bench.loop_s(bench.both(), 60.0)  # what is imported by the first flight is no part of the others
        found: dict[str, list[float]] = {case: [] for case in bench.cases()}
        rounds = [bench.parts_us() for _ in range(ROUNDS)]
        for _ in range(ROUNDS):
            for case, measure in bench.cases().items():
                found[case].append(measure())
        least_s = {case: min(times) for case, times in found.items()}
        flight = bench.loaded.scenario.flight
        parts = {part: min(times[part] for times in rounds) for part in rounds[0]}
        measured = sizes(bench)
    flown_s = FLOWN_S + flight.lead_in_s
    return "\n\n".join(
        [
            "To reach: the loop without recorders at most 1.3 times `run()` alone; with both recorders 1,200 "
            "times real time, and at most 30 % more than without; 120 MB of MCAP and 150 MB of Rerun for 18 "
            "hours; reading 4 times faster.",
            f"{FLOWN_S / 60.0:.0f} minutes of `ian`, {flight.simulation_hz:g} Hz, guidance at "
            f"{flight.guidance_hz} and samples at {flight.sample_hz} Hz, on one core; "
            f"the least of {ROUNDS} rounds.",
            ratios(least_s, flown_s),
            f"18 hours take {least_s[BOTH] * WHOLE_S / flown_s:.0f} s with both recorders, which add "
            f"{least_s[BOTH] / least_s[LOOP] - 1.0:.0%} to the flight without; they leave "
            f"{measured.mcap_mb:.0f} MB of MCAP and {measured.rrd_mb:.0f} MB of Rerun. Reading the state "
            f"into columns, whole recording and all, is {measured.read_ratio:.1f} times faster than "
            "iterating it with mcap's reader, without decoding a message.",
            "Where the time goes, for each sample (0.1 s of flight):",
            where(least_s, parts, flown_s * flight.sample_hz),
        ]
    )


def ratios(least_s: dict[str, float], flown_s: float) -> str:
    lines = ["| case | × `run()` alone | × real time |", "|---|---|---|"]
    for case, spent_s in least_s.items():
        lines.append(f"| {case} | {spent_s / least_s[BARE]:.2f} | {flown_s / spent_s:,.0f} |")
    return "\n".join(lines)


def where(least_s: dict[str, float], parts: dict[str, float], samples: float) -> str:
    """JSBSim, the parts alone, and the recorders as what they add; the rest is the loop, and cold caches."""
    per_sample = {case: spent_s / samples * 1e6 for case, spent_s in least_s.items()}
    rows = {"JSBSim": per_sample[LEAN], **parts}
    rows["rest of the loop, and what each part slows the others down"] = per_sample[LOOP] - sum(rows.values())
    rows["MCAP"] = per_sample[MCAP] - per_sample[LOOP]
    rows["Rerun"] = per_sample[BOTH] - per_sample[MCAP]
    lines = ["| part | µs | share |", "|---|---|---|"]
    for part, spent_us in rows.items():
        lines.append(f"| {part} | {spent_us:.1f} | {spent_us / per_sample[BOTH]:.0%} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(f"## {TITLE}\n\n{section()}")
