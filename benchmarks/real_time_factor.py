"""What each link of the closed loop costs: the same two hours of `ian`, from bare JSBSim to both recorders.

Ratios of one run on one machine; the wall times alone say little.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from tables import table
from timing import say

from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorder, Recorders
from recordings.rerun_writer import RerunRecorder
from sim.closed_loop import FlightSetup, fly
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import load_scenario
from sim.weather.source import bring_weather

TITLE = "The closed loop against JSBSim alone"
FLOWN_S = 7200.0


class EnoughError(Exception):
    """The time to measure is over."""


def stop(time_s: float) -> None:
    if time_s >= FLOWN_S:
        raise EnoughError


def bare(setup: FlightSetup) -> float:
    begin_s = time.perf_counter()
    for _ in range(round((FLOWN_S + setup.lead_in_s) * setup.aircraft.rate_hz)):
        setup.aircraft.step()
    return time.perf_counter() - begin_s


def looped(setup: FlightSetup, recorder: Recorder) -> float:
    begin_s = time.perf_counter()
    try:
        fly(setup, recorder, stop)
    except EnoughError:
        return time.perf_counter() - begin_s
    raise SystemExit("the flight ended before the time to measure")


def section() -> str:
    loaded = load_scenario("ian")
    weather = bring_weather(loaded)
    plan = make_plan(loaded.scenario, weather, make_aircraft(loaded.scenario))

    def ready() -> FlightSetup:
        return prepare_flight(loaded, weather, plan, make_aircraft(loaded.scenario))

    with tempfile.TemporaryDirectory() as name:
        mcap, rrd = Path(name) / "flight.mcap", Path(name) / "flight.rrd"
        cases: dict[str, Callable[[], float]] = {
            "JSBSim alone": lambda: bare(ready()),
            "closed loop": lambda: looped(ready(), Recorders([])),
            "... with MCAP": lambda: looped(ready(), McapRecorder(mcap)),
            "... with Rerun": lambda: looped(ready(), RerunRecorder(rrd)),
            "... with both": lambda: looped(ready(), Recorders([McapRecorder(mcap), RerunRecorder(rrd)])),
        }
        walls_s: dict[str, float] = {}
        for case, measure in cases.items():
            walls_s[case] = measure()
            say(f"{case}: {walls_s[case]:.2f} s")
    flown_s = FLOWN_S + loaded.scenario.flight.lead_in_s
    alone_s = walls_s["JSBSim alone"]
    rows = [
        [case, f"{wall_s:.2f} s", f"{wall_s / alone_s:.2f}", f"{flown_s / wall_s:,.0f}"]
        for case, wall_s in walls_s.items()
    ]
    return f"""\
{FLOWN_S / 3600.0:.0f} h of `ian` to {plan.goal}: JSBSim with its autopilot at 60 Hz,
guidance and samples at 10 Hz.

{table(["", "wall time", "times JSBSim alone", "times real time"], rows)}"""


if __name__ == "__main__":
    print(section())
