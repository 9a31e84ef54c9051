"""What a flight costs beside JSBSim itself: bare `run()`, the closed loop with no, each, both recorders.

The cases take turns, round after round, every other round backwards, and a ratio is the median of those
within the rounds: a machine's own speed moves by a quarter from one minute to the next, and both sides of a
ratio have to have the same. Times are of the processor, over all threads: what one core has to do. Only what
the recorders add is told by the clock on the wall, too, where Rerun's threads find another core.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from mcap.reader import make_reader
from timing import say

import recordings
from aircraft.jsbsim_aircraft import IDLE_IN_FLIGHT
from aircraft.reference import Reference
from aircraft.state import FlightState
from recordings.mcap_writer import McapRecorder
from recordings.recorder import (
    FlightHeader,
    GuidanceSample,
    Outcome,
    PlanIssue,
    Recorder,
    Recorders,
    WeatherSheet,
)
from recordings.rerun_writer import RerunRecorder
from recordings.samples import Samples
from recordings.schema import STATE
from sim.closed_loop import FlightSetup, fly
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import LoadedScenario, load_scenario
from sim.weather.source import bring_weather
from sim.wind_ahead import WindAhead

TITLE = "Speed of a flight"

ROUNDS = 9
FLOWN_S = 7200.0
WHOLE_S = 18.0 * 3600.0

BARE, LEAN, LOOP, MCAP, RERUN, BOTH = (
    "JSBSim's `run()` alone",
    "the same as the loop has it, without what is idle or hardly changes",
    "closed loop, without recorders",
    "closed loop with MCAP",
    "closed loop with Rerun",
    "closed loop with both",
)


class Time(NamedTuple):
    """How long something took, by the processor over all threads, and by the clock on the wall."""

    cpu_s: float
    wall_s: float


Spent = dict[str, list[Time]]
"""By case, one a round."""


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

    def reference(self, time_s: float, reference: Reference) -> None:
        pass

    def plan(self, issue: PlanIssue) -> None:
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

    def bare(self) -> Time:
        """JSBSim as it comes: `run()` of the same model, all its parts in every step."""
        setup = self.ready()
        aircraft = setup.aircraft
        for part in IDLE_IN_FLIGHT:
            aircraft.enable(part, True)
        run, steps = aircraft._fdm.run, self._steps(setup)

        def repeated() -> None:
            for _ in range(steps):
                run()

        return timed(repeated)

    def lean(self) -> Time:
        """JSBSim as the loop has it: without what is idle in flight, and its slow parts less often."""
        setup = self.ready()
        return timed(lambda: setup.aircraft.step(self._steps(setup)))

    def _steps(self, setup: FlightSetup) -> int:
        return round((FLOWN_S + setup.lead_in_s) * setup.aircraft.rate_hz)

    def loop(self, recorder: Recorder, flown_s: float) -> Time:
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

        return timed(flight)

    def both(self) -> Recorder:
        samples = Samples()
        return Recorders([McapRecorder(self.mcap, samples), RerunRecorder(self.rrd, samples)])

    def cases(self) -> dict[str, Callable[[], Time]]:
        return {
            BARE: self.bare,
            LEAN: self.lean,
            LOOP: lambda: self.loop(Recorders([]), FLOWN_S),
            MCAP: lambda: self.loop(McapRecorder(self.mcap), FLOWN_S),
            RERUN: lambda: self.loop(RerunRecorder(self.rrd), FLOWN_S),
            BOTH: lambda: self.loop(self.both(), FLOWN_S),
        }

    def parts_us(self) -> dict[str, float]:
        """What the loop consists of, each repeated alone on the moments of a flight [us a sample]."""
        kept = Kept()
        self.loop(kept, FLOWN_S / 4.0)
        states = [state for state, _ in kept.samples]
        commands = [guidance.command for _, guidance in kept.samples]
        setup = self.ready()
        aircraft, frame = setup.aircraft, setup.header.grid.frame
        wind = WindAhead(setup.truth.probe(), setup.header.plan.departure_s, setup.lead_in_s)
        seen = [
            (s, *frame.plane_point(s.lat_rad, s.lon_rad), s.wind_north_mps, s.wind_east_mps) for s in states
        ]
        every, hz = setup.sample_hz // setup.guidance_hz, setup.guidance_hz
        guided, steps = slice(None, None, every), round(aircraft.rate_hz / hz)
        parts: dict[str, tuple[Callable[..., object], list[tuple[Any, ...]]]] = {
            "wind at the aircraft": (
                wind.look,
                [(aircraft, state, steps, 1.0 / hz) for state in states[guided]],
            ),
            "guidance": (setup.guidance.update, seen[guided]),
            "reading the state": (aircraft.state, [()] * len(states)),
            "place in the plane": (frame.plane_point, [moment[0][1:3] for moment in seen[guided]]),
            "commands to the autopilot": (aircraft.command, [(command,) for command in commands[guided]]),
        }

        def repeated_s(call: Callable[..., object], arguments: list[tuple[Any, ...]]) -> float:
            return cpu_s(lambda: [call(*each) for each in arguments])

        return {name: repeated_s(*part) / len(states) * 1e6 for name, part in parts.items()}


class Sizes(NamedTuple):
    """Of the files of a whole flight, and how many times faster than message by message each is read."""

    mcap_mb: float
    rrd_mb: float
    mcap_ratio: float
    rrd_ratio: float


def timed(work: Callable[[], object]) -> Time:
    begin = time.process_time(), time.perf_counter()
    work()
    return Time(time.process_time() - begin[0], time.perf_counter() - begin[1])


def cpu_s(work: Callable[[], object]) -> float:
    return timed(work).cpu_s


def state_by_messages(path: Path) -> int:
    with path.open("rb") as stream:
        return sum(1 for _ in make_reader(stream).iter_messages(topics=[STATE.name]))


def sizes(bench: Bench) -> Sizes:
    """Of the last flight with both recorders, drawn out to eighteen hours."""
    mcap, rrd = (path.with_suffix(f".partial{path.suffix}") for path in (bench.mcap, bench.rrd))
    times = WHOLE_S / FLOWN_S / 1e6
    messages_s = min(cpu_s(lambda: state_by_messages(mcap)) for _ in range(3))
    mcap_ratio, rrd_ratio = (messages_s / columns_s(path) for path in (mcap, rrd))
    return Sizes(mcap.stat().st_size * times, rrd.stat().st_size * times, mcap_ratio, rrd_ratio)


def columns_s(path: Path) -> float:
    return min(cpu_s(lambda: recordings.open(path).state) for _ in range(3))


def section() -> str:
    """Measure, and give the section of docs/benchmarks.md."""
    with tempfile.TemporaryDirectory() as name:
        bench = Bench(Path(name))
        bench.loop(bench.both(), 60.0)  # what is imported by the first flight is no part of the others
        cases = bench.cases()
        spent: Spent = {case: [] for case in cases}
        parts = []
        for round_ in range(ROUNDS):
            say(f"loop: round {round_ + 1} of {ROUNDS}")
            for case in list(cases) if round_ % 2 else reversed(cases):
                spent[case].append(cases[case]())
            parts.append(bench.parts_us())
        flight = bench.loaded.scenario.flight
        part_us = {part: median(times[part] for times in parts) for part in parts[0]}
        measured = sizes(bench)
    flown_s = FLOWN_S + flight.lead_in_s
    added = ratio(spent, BOTH, LOOP) - 1.0
    added_wall = ratio(spent, BOTH, LOOP, wall=True) - 1.0
    return "\n\n".join(
        [
            "To reach: the loop without recorders at most 1.3 times `run()` alone; with both recorders "
            "1,200 times real time, and on the wall's clock at most 30 % more than without; 120 MB of MCAP "
            "and 150 MB of Rerun for 18 hours; reading 4 times faster.",
            f"{FLOWN_S / 3600.0:.0f} hours of `ian`, {flight.simulation_hz:g} Hz, guidance at "
            f"{flight.guidance_hz} and samples at {flight.sample_hz} Hz, on one core; "
            f"medians of {ROUNDS} rounds in which the cases take turns, and the quickest of them.",
            ratios(spent, flown_s),
            f"18 hours take {cpu_median_s(spent[BOTH]) * WHOLE_S / flown_s:.0f} s with both recorders. "
            f"They add {added_wall:.0%} to the flight without by the clock on the wall, {added:.0%} in time "
            "of the processor, since Rerun encodes in threads of its own. They leave "
            f"{measured.mcap_mb:.0f} MB of MCAP and {measured.rrd_mb:.0f} MB of Rerun. Reading the state "
            f"into columns, whole recording and all, is {measured.mcap_ratio:.1f} times faster from MCAP and "
            f"{measured.rrd_ratio:.1f} times from Rerun than iterating it with mcap's reader, without "
            "decoding a message.",
            "Where the time goes, for each sample (0.1 s of flight):",
            where(spent, part_us, flown_s * flight.sample_hz),
        ]
    )


def ratio(spent: Spent, case: str, reference: str, *, wall: bool = False) -> float:
    """How many times the other's time a case takes: the median over the rounds."""
    return median(mine[wall] / other[wall] for mine, other in zip(spent[case], spent[reference], strict=True))


def cpu_median_s(times: Sequence[Time]) -> float:
    return median(each.cpu_s for each in times)


def ratios(spent: Spent, flown_s: float) -> str:
    lines = ["| case | × `run()` alone | × real time | the quickest |", "|---|---|---|---|"]
    for case, times in spent.items():
        factors = f"{flown_s / cpu_median_s(times):,.0f} | {flown_s / min(times).cpu_s:,.0f}"
        lines.append(f"| {case} | {ratio(spent, case, BARE):.2f} | {factors} |")
    return "\n".join(lines)


def where(spent: Spent, parts: dict[str, float], samples: float) -> str:
    """JSBSim, the parts alone, and the recorders as what they add; the rest is the loop, and cold caches."""
    per_sample = {case: cpu_median_s(times) / samples * 1e6 for case, times in spent.items()}
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
