"""Planning a scenario without flying it: one plan, or the best of many departures, and files of it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from planner.arrivals import sweep_arrivals
from planner.departure_table import DepartureTable
from planner.export import export
from planner.planning import StagedMission
from planner.plans import Plan
from planner.staged_departures import plan_departures
from sim.departing import Departing
from sim.endurance import short_of_fuel
from sim.errors import SimError
from sim.preparation import make_aircraft, make_plan, planning_request
from sim.scenario import LoadedScenario
from sim.weather.source import bring_weather


@dataclass(frozen=True, slots=True)
class PlanFiles:
    """Which files are wanted: the plan, the route for other programs, the arrival step of every cell."""

    out: Path | None = None
    exports: tuple[Path, ...] = ()
    isochrones: Path | None = None


@dataclass(frozen=True, slots=True)
class Planned:
    """The plan; or from many departures the chosen plans and their table.

    `served`: whether each goal that was to be reached has a plan.
    """

    plans: tuple[Plan, ...]
    table: DepartureTable | None
    served: bool

    @property
    def passed(self) -> bool:
        """Whether there are plans, and all of them are to be flown."""
        return self.served and all(plan.waypoints and not plan.outcome.abstained for plan in self.plans)

    def to_json(self) -> bytes:
        """The plan; or {"plans": [...], "departures": {...}}."""
        if self.table is None:
            return self.plans[0].to_json()
        answer = {"plans": self.plans, "departures": self.table.to_dict()}
        return msgspec.json.format(msgspec.json.encode(answer), indent=1) + b"\n"


def plan_job(
    loaded: LoadedScenario, departing: Departing | None, files: PlanFiles, tell: Callable[[str], object]
) -> Planned:
    """Bring the weather, plan, and write the files.

    A plan without a route, or one that its chance to survive speaks against, is not exported.

    Args:
        loaded: the scenario.
        departing: the departures to choose from; without, the mission's own.
        files: what to write; of a fleet (`departing.distinct`) one file a goal, the goal's name in its name.
        tell: told of plans that the tanks do not suffice for.

    Raises:
        SimError: if options do not go together; PlannerError for what the planner or a writer refuses.
    """
    _check(loaded, departing, files)
    scenario = loaded.scenario
    aircraft, weather = make_aircraft(scenario, loaded.folder), bring_weather(loaded)
    if departing is not None:
        found = plan_departures(
            weather.forecast,
            planning_request(scenario, weather, aircraft),
            departing.slots_min,
            best_by=departing.best_by,
            distinct=departing.distinct,
        )
        planned = Planned(found.plans, found.table, found.served)
    elif files.isochrones is not None:
        mission = StagedMission.prepare(weather.forecast, planning_request(scenario, weather, aircraft))
        write_isochrones(files.isochrones, sweep_arrivals(mission.problem.ground, mission.start).field())
        planned = Planned((mission.plan(),), None, True)
    else:
        planned = Planned((make_plan(scenario, weather, aircraft),), None, True)
    for plan in planned.plans:
        short = short_of_fuel(
            plan, aircraft.folder, aircraft.envelope.cruise_mps, scenario.mission.altitude_m
        )
        if short:
            tell(short)
    _write(planned.plans, files, fleet=departing is not None and departing.distinct)
    return planned


def write_isochrones(path: Path, field: NDArray[np.int32]) -> None:
    """Write the arrival step of every cell as a NumPy file.

    Raises:
        SimError: if the file is not to be named .npy, or cannot be written.
    """
    if path.suffix != ".npy":
        raise SimError(f"isochrones go to a NumPy file; name it {path.with_suffix('.npy')}, not {path}")
    try:
        with path.open("wb") as file:
            np.save(file, field)
    except OSError as error:
        raise SimError(f"cannot write isochrones to {path}: {error.strerror}; name another file") from error


def _check(loaded: LoadedScenario, departing: Departing | None, files: PlanFiles) -> None:
    kind = loaded.scenario.planner.kind
    and_levels = " --set mission.levels_m=[]" if loaded.scenario.mission.levels_m else ""
    for option, wanted in (("--departures", departing is not None), ("--isochrones", bool(files.isochrones))):
        if wanted and kind != "staged":
            raise SimError(
                f"{option} needs the staged planner, and planner.kind is {kind}; add --planner staged"
                f"{and_levels}"
            )
    for path in (files.out, *files.exports, files.isochrones):
        if path is not None and not path.parent.is_dir():
            raise SimError(f"there is no folder {path.parent} for {path.name}; make it first")
    if departing is not None and files.isochrones is not None:
        raise SimError(
            "--isochrones belong to one departure; leave out --departures, or set mission.departure instead"
        )


def _write(plans: tuple[Plan, ...], files: PlanFiles, *, fleet: bool) -> None:
    names = [_file_name(plan.goal) for plan in plans]
    if fleet and len(set(names)) < len(names):
        raise SimError(f"the goals' files would share a name ({', '.join(sorted(names))}); rename a goal")
    for plan, name in zip(plans, names, strict=True):
        if files.out is not None:
            plan.save(_of_goal(files.out, name) if fleet else files.out)
        if plan.waypoints and not plan.outcome.abstained:
            for path in files.exports:
                export(plan, _of_goal(path, name) if fleet else path)


def _file_name(goal: str) -> str:
    return re.sub(r"[^\w.-]+", "-", goal)


def _of_goal(path: Path, name: str) -> Path:
    return path.with_stem(f"{path.stem}-{name}")
