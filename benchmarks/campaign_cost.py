"""What a flight of a campaign costs, part by part: the figures that docs/scale.md reckons with.

Processor times, over all threads, the least of some rounds; so it may be run beside other work. It prints
markdown: `python benchmarks/campaign_cost.py`, some minutes; `--quick` for less exact figures.
"""

from __future__ import annotations

import argparse
import pickle
import random
import shutil
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import psutil
from campaign_sides import LONG, SCENARIO
from dask_programs import cluster
from tables import duration, table
from timing import clocked, say

import recordings
from planner.grid import Grid
from planner.windfield import WindField
from recordings.limits import judge, parse_limits
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.tracking import track
from sim.campaign.columns import schema, write_table
from sim.campaign.dask_cluster import connected
from sim.campaign.design import CHUNK, Design
from sim.campaign.errand import Errand
from sim.campaign.flight import Origin
from sim.campaign.flying import Flying
from sim.campaign.journal import Journal
from sim.campaign.keeping import Keep
from sim.campaign.premises import Premises
from sim.campaign.row import Row
from sim.closed_loop import fly
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import LoadedScenario, load_scenario
from sim.weather.cf_writer import write_wind
from sim.weather.source import bring_weather

ROWS = 2000
KEPT = 200
MANY = 50
CHUNKS = 400
HOURS = 19
MAP = (121, 161)
"""Latitudes and longitudes of a weather file: 30 by 40 degrees, a quarter of a degree apart."""


def _silent(_: float) -> None:
    pass


def flight_parts(loaded: LoadedScenario, folder: Path, rounds: int) -> tuple[dict[str, float], int, float]:
    """Seconds of the parts of a flight, the recording's bytes, and how long the flight is [s]."""
    scenario, path = loaded.scenario, folder / "flight.mcap"
    weather_s, weather = clocked(lambda: bring_weather(loaded), rounds)
    plan_s, plan = clocked(lambda: make_plan(scenario, weather, make_aircraft(scenario)), rounds)
    flown: list[float] = []

    def once(recorder: Callable[[], Any]) -> float:
        setup = prepare_flight(loaded, weather, plan, make_aircraft(scenario))
        seconds, end = clocked(lambda: fly(setup, recorder(), _silent))
        flown.append(end.time_s)
        return seconds

    taken = [(once(lambda: Recorders([])), once(lambda: McapRecorder(path))) for _ in range(rounds)]
    bare_s, recorded_s = map(min, zip(*taken, strict=True))
    limits = parse_limits(scenario.limits)
    judged_s, _ = clocked(lambda: judge(track(recordings.open(path)), limits), rounds)
    seconds = {
        "weather of a storm, once a worker": weather_s,
        "plan, once a worker unless forecasts err": plan_s,
        "flight, closed loop on JSBSim": bare_s,
        "its recording": recorded_s - bare_s,
        "reading that back and judging it": judged_s,
    }
    return seconds, path.stat().st_size, flown[0]


def rows_like(row: Row, count: int) -> Iterable[Row]:
    """Rows with other figures, as those of other flights are, so that they do not compress too well."""
    chance = random.Random(1)
    for run in range(count):
        other = {
            name: value * chance.uniform(0.5, 1.5) if isinstance(value, float) else value
            for name, value in row.items()
        }
        other["recording_sha256"] = f"{chance.getrandbits(256):064x}"
        yield row | other | {"run": run, "seed": run}


def row_costs(row: Row, folder: Path) -> dict[str, str]:
    """Bytes of a row, and the time to keep it, on this disk and by the clock on the wall."""
    made = list(rows_like(row, ROWS))
    write_table(folder / "flights.parquet", made, schema((), {}), {})
    path = folder / "journal.sqlite"
    return {
        "a row in Parquet": f"{(folder / 'flights.parquet').stat().st_size / ROWS:.0f} B",
        "a row kept, a transaction each": kept(path, made[:KEPT], 1),
        f"a row kept, {CHUNK} a transaction": kept(path, made[KEPT : 2 * KEPT], CHUNK),
        f"a row kept, {MANY} a transaction": kept(path, made[2 * KEPT : 3 * KEPT], MANY),
        "a row in the journal": f"{path.stat().st_size / (3 * KEPT) / 1000:.1f} kB",
    }


def kept(path: Path, rows: Sequence[Row], together: int) -> str:
    """The time to keep a row where some land together, and what of it is work."""
    journal = Journal(path)
    begin_s, begin_cpu_s = time.perf_counter(), time.process_time()
    for first in range(0, len(rows), together):
        journal.add(rows[first : first + together])
    whole_s, cpu_s = time.perf_counter() - begin_s, time.process_time() - begin_cpu_s
    journal.close()
    return f"{duration(whole_s / len(rows))}, {duration(cpu_s / len(rows))} of it work"


def messages(loaded: LoadedScenario, row: Row) -> dict[str, str]:
    """Bytes that go to a worker and come back for a chunk."""
    origin = Origin(loaded.toml, "scenario.toml", loaded.folder)
    design = Design.of(origin, (), CHUNK)
    chunk = tuple(design.flight(run) for run in range(CHUNK))
    work = pickle.dumps(Flying(Keep.parse("none"), Path("/campaign/recordings")))
    errand = Errand("0" * 32, work, 3600.0, Premises.here())
    return {
        f"a chunk of {CHUNK} flights, to a worker": f"{len(pickle.dumps((errand, chunk))) / 1000:.1f} kB",
        f"{CHUNK} rows, from a worker": f"{len(pickle.dumps(list(rows_like(row, CHUNK)))) / 1000:.1f} kB",
    }


def chunk_costs(chunks: int) -> dict[str, str]:
    """Processor time of scheduler and client for a chunk whose tasks take no time."""
    with cluster(2) as started, connected(started.address, 60.0) as executor:
        list(executor.results(abs, [[0], [1]]))
        scheduler = psutil.Process(started.scheduler_pid)
        before, begin_s = scheduler.cpu_times(), time.process_time()
        for _ in executor.results(abs, ([number] for number in range(chunks))):
            pass
        client_s, after = time.process_time() - begin_s, scheduler.cpu_times()
    scheduler_s = after.user + after.system - before.user - before.system
    return {
        "Dask's scheduler, a chunk": duration(scheduler_s / chunks),
        "galeway campaign, a chunk": duration(client_s / chunks),
    }


def file_costs(folder: Path, rounds: int) -> dict[str, str]:
    """A weather file of a gridded forecast: its size, and the time to read it."""
    rows, columns = MAP
    chance = np.random.default_rng(1)
    grid = Grid(np.radians(15.0), np.radians(-100.0), np.radians(0.25), np.radians(0.25), rows, columns)
    time_s = 1664409600.0 + 3600.0 * np.arange(HOURS)
    waves = [
        12.0 * np.sin(np.add.outer(np.linspace(0, 7, rows), np.linspace(k, k + 9, columns)))
        + chance.normal(0.0, 0.3, (rows, columns))
        for k in np.linspace(0.0, 6.0, 2 * HOURS)
    ]
    wind = WindField(grid, time_s, np.float32(waves[:HOURS]), np.float32(waves[HOURS:]))
    write_wind(folder / "wind.nc", wind, title="a forecast", source="made up")
    text = SCENARIO.format(**LONG).replace('storm = "AL092022"', 'file = "wind.nc"')
    (folder / "gridded.toml").write_text(text)
    loaded = load_scenario(str(folder / "gridded.toml"))
    read_s, _ = clocked(lambda: bring_weather(loaded), rounds)
    size_mb = 2 * 4 * HOURS * rows * columns / 1e6
    return {
        f"{HOURS} hours of wind on {rows} x {columns} places, in memory": f"{size_mb:.1f} MB",
        "the same as compressed NetCDF": f"{(folder / 'wind.nc').stat().st_size / 1e6:.1f} MB",
        "read, for a mission's area": duration(read_s),
    }


def report(*, quick: bool = False) -> str:
    rounds = 1 if quick else 5
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scenario.toml").write_text(SCENARIO.format(**LONG))
        loaded = load_scenario(str(folder / "scenario.toml"))
        say("a flight")
        seconds, length, flown_s = flight_parts(loaded, folder, rounds)
        say("a row")
        design = Design.of(Origin(loaded.toml, "scenario.toml", loaded.folder), (), 1)
        row = Flying(Keep.parse("none"), folder)(design.flight(0))
        sizes = row_costs(row, folder) | messages(loaded, row)
        say("a weather file")
        sizes |= file_costs(folder, rounds)
        say("chunks on Dask")
        sizes |= chunk_costs(CHUNKS // 8 if quick else CHUNKS)
        shutil.rmtree(folder)
        folder.mkdir()
    hours = flown_s / 3600.0
    parts = [[part, duration(each), duration(each / hours)] for part, each in seconds.items()]
    always_s = sum(list(seconds.values())[2:])
    parts.append(["the last three: every flight", duration(always_s), duration(always_s / hours)])
    sizes = {"a recording": f"{length / 1e6:.2f} MB, {length / hours / 1e6:.2f} MB an hour"} | sizes
    return f"""\
A flight of {hours:.2f} hours:

{table(["part", "processor time", "an hour of flight"], parts)}

{table(["what", "measured"], [[what, told] for what, told in sizes.items()])}
"""


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure what a flight of a campaign costs.")
    parser.add_argument("--quick", action="store_true", help="one round of each")
    print(report(quick=parser.parse_args().quick))
