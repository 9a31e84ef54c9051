"""The main job: a scenario planned, flown, recorded and judged, its files in one folder."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile

import recordings
from planner.plans import Plan
from recordings.limits import Limit, Verdict, judge, parse_limits
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.rerun_writer import RerunRecorder
from recordings.samples import Samples
from recordings.tracking import Tracking, track
from sim.closed_loop import End, FlightSetup, fly
from sim.endurance import short_of_fuel
from sim.errors import SimError
from sim.faults import missed
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
    def rerun_partial(self) -> Path:
        """The same while it is being written."""
        return RerunRecorder(self.rerun).partial_path

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
    tell: Callable[[str], object],
) -> Flown | None:
    """Plan, fly, record, and judge from the recording.

    Args:
        loaded: the scenario.
        files: where everything goes; files of an earlier job there are replaced.
        on_plan: told the plan, before the flight.
        on_time: told the time since departure [s] all through the flight.
        tell: told what a user has to know besides: a plan that the tanks do not suffice for, files that are
            replaced, faults that did not strike.

    Returns:
        The flight, or None if the plan says that its goal cannot be reached, or not with the chance to
        survive that is asked for.

    Raises:
        SimError: if the folder cannot be written; and whatever is wrong with the input, before it is touched.
    """
    scenario = loaded.scenario
    limits = parse_limits(scenario.limits)
    _check_room(files)
    aircraft = make_aircraft(scenario, loaded.folder)
    weather = bring_weather(loaded)
    plan = make_plan(scenario, weather, aircraft)
    on_plan(plan)
    short = short_of_fuel(plan, aircraft.folder, aircraft.envelope.cruise_mps, scenario.mission.altitude_m)
    if short:
        tell(short)
    flyable = bool(plan.waypoints) and not plan.outcome.abstained
    setup = prepare_flight(loaded, weather, plan, aircraft) if flyable else None
    _make_room(files, "replaced" if setup else "nothing is flown; removed", tell)
    write_whole(files.plan, plan.to_json())
    if setup is None:
        return None
    samples = Samples()
    mcap, rerun = McapRecorder(files.mcap, samples), RerunRecorder(files.rerun, samples, judged=True)
    try:
        flown = _fly_and_judge(setup, files, mcap, rerun, limits, on_time)
    except BaseException:
        rerun.abandon()
        raise
    for text in missed(setup.faults, flown.end.time_s):
        tell(text)
    return flown


def _fly_and_judge(
    setup: FlightSetup,
    files: Files,
    mcap: McapRecorder,
    rerun: RerunRecorder,
    limits: Sequence[Limit],
    on_time: Callable[[float], object],
) -> Flown:
    """Fly and record, then read the recording back and judge it; the verdicts go to the eyes, too."""
    begin_s = time.perf_counter()
    end = fly(setup, Recorders([mcap, rerun]), on_time)
    factor = (end.time_s + setup.lead_in_s) / (time.perf_counter() - begin_s)
    tracking = track(recordings.open(files.mcap))
    write_whole(files.report, tracking.to_json(real_time_factor=round(factor, 1)))
    verdicts = judge(tracking, limits) if limits else []
    rerun.verdicts(verdicts)
    return Flown(end, tracking, verdicts, factor)


def _check_room(files: Files) -> None:
    """Find out before the planning whether the folder can be written to; nothing of that stays."""
    missing: list[Path] = []
    try:
        missing = [folder for folder in (files.folder, *files.folder.parents) if not folder.exists()]
        files.folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=files.folder):
            pass
    except OSError as error:
        raise _unusable(files, error) from error
    finally:
        for folder in missing:
            with suppress(OSError):  # it was never made
                folder.rmdir()


def _make_room(files: Files, what: str, tell: Callable[[str], object]) -> None:
    """Make the folder and take away what an earlier job left, finished or not; `what` is said to be done."""
    try:
        files.folder.mkdir(parents=True, exist_ok=True)
        patterns = ("plan.json", "report.json", "flight.mcap", "flight.rrd", "flight.partial.*")
        earlier = [path for pattern in patterns for path in files.folder.glob(pattern)]
        for path in earlier:
            path.unlink()
    except OSError as error:
        raise _unusable(files, error) from error
    if earlier:
        names = ", ".join(path.name for path in earlier)
        tell(f"{what} in {files.folder}, from an earlier flight: {names}")


def _unusable(files: Files, error: OSError) -> SimError:
    return SimError(f"cannot write to {files.folder}: {error.strerror}; choose another --out")


def write_whole(path: Path, content: bytes) -> None:
    """Write a file under another name first, so that it is never half written under its own."""
    partial = path.with_suffix(f".partial{path.suffix}")
    partial.write_bytes(content)
    partial.replace(path)
