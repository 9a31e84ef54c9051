"""How closely flights follow their plans: every case of the table, five seeds each, beside its target.

Figures come from the recordings alone, as `galeway check` computes them: p95 of the worst seed, and the
largest of all. Errors are against the reference; what the reference cuts off the plan's corners is a column
of its own. Run by itself, with a name or two on the command line, it measures only those cases.
"""

from __future__ import annotations

import math
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import vortex_course

from planner.windfield import WindField
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.tracking import Tracking, track
from sim.closed_loop import FlightSetup, fly
from sim.errors import ScenarioError
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import LoadedScenario, Scenario, load_scenario
from sim.weather.source import bring_weather

TITLE = "How closely the plan is followed"
SEEDS = (1, 2, 3, 4, 5)
PROCESSES = 2

GALE_MPS = 48.0
GALE_FROM_S, GALE_S, GALE_RAMP_S = 600.0, 600.0, 60.0
BACK_M = 5.0
"""An aircraft is back on its path when it comes within this distance."""


@dataclass(frozen=True)
class Case:
    """`targets`: cross-track p95 and max [m], altitude p95 [m], waypoint time p95 [s]."""

    name: str
    text: str
    targets: tuple[float, float, float, float] | None
    legs: int = 30
    hours: int = 2
    tables: str = "[turbulence]\nseverity = 3"
    seeds: Sequence[int] = SEEDS


class Job(NamedTuple):
    """One flight: on the vortex course, or of `ian` to a goal."""

    case: str
    seed: int
    goal: str = ""


class Flown(NamedTuple):
    """What is kept of a flight."""

    job: Job
    cross_p95_m: float
    cross_max_m: float
    altitude_p95_m: float
    altitude_max_m: float
    time_p95_s: float
    time_max_s: float
    cut_m: float
    wind_max_mps: float
    flight_s: float
    arrived: bool
    note: str


CASES = (
    Case(
        "calm",
        "moving vortex to 15 m/s, no turbulence",
        (0.3, 1.5, 0.3, 0.5),
        tables='[turbulence]\nkind = "none"',
        seeds=(1,),
    ),
    Case("light", "the same, Milspec severity 3", (0.6, 4.0, 1.0, 2.0)),
    Case("moderate", "the same, severity 4", (1.0, 6.0, 5.0, 6.0), tables="[turbulence]\nseverity = 4"),
    Case("gps", "severity 3 with `gps` sensors", (3.0, 8.0, 2.0, 3.0), tables='[flight]\nsensors = "gps"'),
    Case("long", "18 hours, over 500 legs, severity 3", (0.6, 5.0, 1.5, 3.0), legs=505, hours=21),
    Case("ian", "`ian` to every reachable goal, severity 3", (0.6, 5.0, 1.5, 3.0)),
    Case(
        "surprise",
        "the truth's wind 20 % stronger than the forecast, severity 3",
        (1.0, 5.0, 2.0, 5.0),
        tables="[weather.truth]\nspeed_factor = 1.2",
    ),
    Case("gale", "wind above airspeed for ten minutes, severity 3", None),
)
_BY_NAME = {case.name: case for case in CASES}


def jobs_of(case: Case) -> list[Job]:
    """The flights of a case: each seed, and of `ian` to each goal that can be reached."""
    if case.name != "ian":
        return [Job(case.name, seed) for seed in case.seeds]
    loaded = load_scenario("ian")
    plan = make_plan(loaded.scenario, bring_weather(loaded), make_aircraft(loaded.scenario))
    reachable = [goal.name for goal in plan.goals if goal.reachable]
    return [Job("ian", seed, goal) for goal in reachable for seed in case.seeds]


def measure(job: Job, folder: Path) -> Flown:
    """Fly and measure, in a process of its own."""
    with tempfile.TemporaryDirectory() as name:
        mcap = Path(name) / "flight.mcap"
        setup = prepare(job, folder)
        end = fly(setup, McapRecorder(mcap), lambda _: None)
        tracking = track(read(mcap))
    note = _drift_note(setup, tracking) if job.case == "gale" else ""
    if not tracking.arrived:
        note = f"{end.outcome.value}: {end.detail}"
    cross, altitude, late = tracking.cross_track_m, tracking.altitude_error_m, tracking.waypoint_time_error_s
    figures = (cross.p95, cross.max, altitude.p95, altitude.max, late.p95, late.max)
    return Flown(
        job,
        *(math.nan if figure is None else figure for figure in figures),
        tracking.corner_cut_m.max or 0.0,
        tracking.wind_mps.max or 0.0,
        tracking.flight_time_s,
        tracking.arrived,
        note,
    )


def prepare(job: Job, folder: Path) -> FlightSetup:
    """The flight of a job, its weather in `folder`."""
    case = _BY_NAME[job.case]
    loaded: LoadedScenario
    if job.goal:
        loaded = load_scenario("ian", [f"seed={job.seed}", f'mission.goal="{job.goal}"'])
    else:
        loaded = vortex_course.load(folder / str(case.hours), case.hours, (case.tables,))
        loaded = replace(loaded, scenario=_seeded(loaded, job.seed))
    aircraft, weather = make_aircraft(loaded.scenario), bring_weather(loaded)
    if job.goal:
        plan = make_plan(loaded.scenario, weather, aircraft)
    else:
        plan = vortex_course.make_course(weather.forecast, case.legs, aircraft.envelope.cruise_mps)
    setup = prepare_flight(loaded, weather, plan, aircraft)
    return replace(setup, truth=with_gale(setup.truth)) if job.case == "gale" else setup


def _seeded(loaded: LoadedScenario, seed: int) -> Scenario:
    import msgspec

    return msgspec.structs.replace(loaded.scenario, seed=seed)


def with_gale(truth: WindField) -> WindField:
    """The wind with a gale toward the east in its place for ten minutes, brought in and out over one."""
    begin_s = vortex_course.DEPARTURE_S + GALE_FROM_S
    marks = np.array([0.0, GALE_RAMP_S, GALE_RAMP_S + GALE_S, 2.0 * GALE_RAMP_S + GALE_S]) + begin_s
    time_s = np.union1d(truth.time_s, marks)
    share = np.interp(time_s, marks, [0.0, 1.0, 1.0, 0.0])[:, np.newaxis, np.newaxis]
    sheets = [truth.sheet(moment) for moment in time_s]
    north, east = (
        np.stack([np.asarray(sheet[part], dtype=np.float64) for sheet in sheets]) for part in (0, 1)
    )
    return replace(
        truth,
        time_s=time_s,
        north_mps=(1.0 - share) * north,
        east_mps=(1.0 - share) * east + share * GALE_MPS,
    )


def _drift_note(setup: FlightSetup, tracking: Tracking) -> str:
    """How far it was blown, what the wind's excess alone would have done, and when it was back."""
    series = tracking.series
    off_m = np.abs(series.cross_track_m)
    excess_mps = np.maximum(series.wind_mps - setup.aircraft.envelope.airspeed_max_mps, 0.0)
    excess_m = float(np.sum(excess_mps[:-1] * np.diff(series.time_s)))
    blowing = np.flatnonzero(excess_mps)
    calm_s = series.time_s[blowing[-1]]
    back_s = series.time_s[np.argmax((series.time_s > calm_s) & (off_m < BACK_M))] - calm_s
    after = series.time_s > calm_s + back_s
    return (
        f"blown {off_m.max():.0f} m off, wind minus airspeed over its time {excess_m:.0f} m; within "
        f"{BACK_M:.0f} m again {back_s:.0f} s after the wind fell below the airspeed, "
        f"then {np.percentile(off_m[after], 95):.2f} m p95, {off_m[after].max():.1f} m at most"
    )


def run(cases: Sequence[Case], on_flight: Callable[[Flown], object]) -> dict[str, list[Flown]]:
    """All flights of the cases, two at a time; a case that the scenario does not know yet has none."""
    flown: dict[str, list[Flown]] = {case.name: [] for case in cases}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for hours in {case.hours for case in cases}:
            (folder / str(hours)).mkdir()
            vortex_course.write_weather(folder / str(hours), hours)
        known = [case for case in cases if _is_known(case, folder)]
        jobs = [job for case in sorted(known, key=lambda case: -case.legs) for job in jobs_of(case)]
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(PROCESSES, mp_context=context) as pool:
            for result in pool.map(measure, jobs, [folder] * len(jobs)):
                on_flight(result)
                flown[result.job.case].append(result)
    return flown


def _is_known(case: Case, folder: Path) -> bool:
    try:
        vortex_course.load(folder / str(case.hours), case.hours, (case.tables,))
    except ScenarioError:
        return False
    return True


COLUMNS = (
    "case",
    "cross-track p95 / max [m]",
    "target",
    "altitude p95 / max [m]",
    "target p95",
    "waypoint time p95 / max [s]",
    "target p95",
    "corners cut [m]",
    "arrived",
)


def table(cases: Sequence[Case], flown: dict[str, list[Flown]]) -> str:
    """One line a case; a figure that misses its target is bold."""
    lines = [COLUMNS, ("---",) * len(COLUMNS), *(_line(case, flown[case.name]) for case in cases)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _line(case: Case, flights: Sequence[Flown]) -> tuple[str, ...]:
    if not flights:
        return case.text, "not measured: not in this version", *[""] * (len(COLUMNS) - 2)
    worst = [max(getattr(flight, name) for flight in flights) for name in Flown._fields[1:8]]
    cross_p95, cross_max, altitude_p95, altitude_max, time_p95, time_max, cut_m = worst
    arrived = f"{sum(flight.arrived for flight in flights)} of {len(flights)}"
    if case.targets is None:
        note, late = flights[-1].note, f"late by {time_max:.0f} at most"
        return case.text, note, "survives", f"{altitude_p95:.2f}", "", late, "", f"{cut_m:.0f}", arrived
    aim = case.targets
    return (
        case.text,
        f"{_figure(cross_p95, aim[0])} / {_figure(cross_max, aim[1])}",
        f"{aim[0]:g} / {aim[1]:g}",
        f"{_figure(altitude_p95, aim[2])} / {altitude_max:.1f}",
        f"{aim[2]:g}",
        f"{_figure(time_p95, aim[3])} / {time_max:.1f}",
        f"{aim[3]:g}",
        f"{cut_m:.0f}",
        arrived,
    )


def _figure(value: float, target: float) -> str:
    return f"{value:.2f}" if value <= target else f"**{value:.2f}**"


def section() -> str:
    """This part of docs/benchmarks.md: measured now."""
    return _section(CASES, lambda _: None)


def _section(cases: Sequence[Case], on_flight: Callable[[Flown], object]) -> str:
    begin_s = time.perf_counter()
    flown = run(cases, on_flight)
    hours = sum(flight.flight_s for flights in flown.values() for flight in flights) / 3600.0
    took_s = time.perf_counter() - begin_s
    return "\n\n".join(
        [
            "p95 of the worst flight and the largest of all, against the reference, on true state, from the "
            f"recordings; {len(SEEDS)} seeds of turbulence for each case, of `ian` for each goal (calm air "
            "has none, so one flight). The vortex course has 3.6 km legs with right angles between "
            "them, timed at cruise airspeed in the forecast wind. Figures that miss their target are bold.",
            table(cases, flown),
            f"{hours:.0f} h of flight in {took_s:.0f} s on {PROCESSES} processes.",
        ]
    )


def main() -> None:
    names = sys.argv[1:] or list(_BY_NAME)
    print(_section([_BY_NAME[name] for name in names], lambda flight: print(flight, file=sys.stderr)))


if __name__ == "__main__":
    main()
