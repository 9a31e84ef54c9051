"""The main job: a scenario planned, flown, recorded and judged, its files in one folder."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from planner.plans import Plan
from recordings.limits import Verdict, judge, parse_limits
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.rerun_writer import RerunRecorder
from recordings.tracking import Tracking, track
from sim.closed_loop import End, fly
from sim.errors import SimError
from sim.preparation import make_aircraft, make_plan, prepare_flight
from sim.scenario import LoadedScenario
from sim.weather.source import bring_weather


@dataclass(frozen=True, slots=True)
class Files:
    """Where a job leaves what it made."""

    folder: Path

    @property
    def plan(self) -> Path:
        """The plan, JSON."""
        return self.folder / "plan.json"

    @property
    def mcap(self) -> Path:
        """The recording that is checked."""
        return self.folder / "flight.mcap"

    @property
    def rerun(self) -> Path:
        """The recording to look at."""
        return self.folder / "flight.rrd"

    @property
    def report(self) -> Path:
        """The tracking report, JSON."""
        return self.folder / "report.json"


@dataclass(frozen=True, slots=True)
class Flown:
    """A finished flight. `real_time_factor`: simulated over wall time of the loop with its recorders."""

    end: End
    tracking: Tracking
    verdicts: list[Verdict]
    real_time_factor: float


def run(
    loaded: LoadedScenario,
    files: Files,
    *,
    on_plan: Callable[[Plan], object],
    on_time: Callable[[float], object],
) -> Flown | None:
    """Plan, fly, record, and judge from the recording.

    Args:
        loaded: the scenario.
        files: where everything goes; files of an earlier job there are replaced.
        on_plan: told the plan, before the flight.
        on_time: told the time since departure [s] all through the flight.

    Returns:
        The flight, or None if the plan says that its goal cannot be reached, or not with the chance to
        survive that is asked for.

    Raises:
        SimError: if the folder cannot be written; and whatever is wrong with the input, before it is touched.
    """
    scenario = loaded.scenario
    limits = parse_limits(scenario.limits)
    aircraft = make_aircraft(scenario, loaded.folder)
    weather = bring_weather(loaded)
    plan = make_plan(scenario, weather, aircraft)
    on_plan(plan)
    flyable = bool(plan.waypoints) and not plan.outcome.abstained
    setup = prepare_flight(loaded, weather, plan, aircraft) if flyable else None
    _make_room(files)
    write_whole(files.plan, plan.to_json())
    if setup is None:
        return None
    begin_s = time.perf_counter()
    end = fly(setup, Recorders([McapRecorder(files.mcap), RerunRecorder(files.rerun)]), on_time)
    factor = (end.time_s + setup.lead_in_s) / (time.perf_counter() - begin_s)
    tracking = track(read(files.mcap))
    write_whole(files.report, tracking.to_json(real_time_factor=round(factor, 1)))
    return Flown(end, tracking, judge(tracking, limits) if limits else [], factor)


def _make_room(files: Files) -> None:
    """Make the folder and take away what an earlier job left, finished or not."""
    try:
        files.folder.mkdir(parents=True, exist_ok=True)
        for pattern in ("plan.json", "report.json", "flight.mcap", "flight.rrd", "flight.partial.*"):
            for path in files.folder.glob(pattern):
                path.unlink()
    except OSError as error:
        raise SimError(f"cannot write to {files.folder}: {error.strerror}; choose another --out") from error


def write_whole(path: Path, content: bytes) -> None:
    """Write a file under another name first, so that it is never half written under its own."""
    partial = path.with_suffix(f".partial{path.suffix}")
    partial.write_bytes(content)
    partial.replace(path)
