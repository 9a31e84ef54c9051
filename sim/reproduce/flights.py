"""The same policies flown on JSBSim: a flight is a task, and the figures are made from its row."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import recordings
from aircraft.description import load_aircraft
from aircraft.errors import AircraftError
from aircraft.own_models import envelope_of
from planner.errors import PlannerError
from recordings.mcap_writer import McapRecorder
from recordings.tracking import Tracking, track
from sim.closed_loop import fly
from sim.errors import SimError
from sim.preparation import make_aircraft, prepare_flight
from sim.reproduce.days import Day
from sim.reproduce.flown_day import FlownDay
from sim.reproduce.forecasts import DayForecasts
from sim.reproduce.judging import first_hazard
from sim.reproduce.policies import POLICIES, Planned
from sim.reproduce.tuning import TUNED_SMALL
from sim.reproduce.worlds import World

Row = dict[str, Any]
"""What came of one flight, as JSON knows it."""

WIND_EDGES_MPS = (0.0, 3.0, 6.0, 9.0, 12.0, 15.0, 60.0)
"""Of the wind speeds by which tracking is told."""

CROSS_EDGES_M = np.concatenate([[0.0], np.geomspace(0.01, 10_000.0, 121)])
"""Of the histograms of cross-track error, from which percentiles over all flights are taken."""


@dataclass(frozen=True, slots=True)
class FlownTask:
    """One flight: a policy's plan for one goal of a day at one level of error."""

    world: World
    seed: int
    scale: float
    policy: str
    goal: int

    @property
    def key(self) -> str:
        """What tells it from all others of its world."""
        return f"{self.seed}-{self.scale:g}-{self.policy}-{self.goal}"


def fly_task(task: FlownTask) -> Row:
    """Plan and fly; the weather of a day is made once for all its flights in a row."""
    planned = _planned(task.world, task.seed, task.scale, task.policy)[task.goal]
    known = {"seed": task.seed, "scale": task.scale, "policy": task.policy, "goal": task.goal}
    if planned.way is None:
        return known | {"planned": "no route"}
    day = _flown_day(task.world, task.seed, task.scale)
    safe = first_hazard(planned.way, day.judged()) is None
    known |= {
        "planned": "safe" if safe else "lost",
        "abstained": planned.abstained,
        "planned_s": (len(planned.way) - 1) * task.world.step_s,
    }
    number = list(POLICIES).index(task.policy) + len(POLICIES) * task.goal
    try:
        return known | _flown(day, task.policy, 1000 * task.seed + number, planned)
    except (SimError, PlannerError, AircraftError) as error:
        return known | {"outcome": "refused", "detail": str(error), "flown": "lost"}


def _flown(day: FlownDay, policy: str, seed: int, planned: Planned) -> Row:
    assert planned.way is not None
    loaded = day.scenario(f"{policy}-{seed}", seed, planned.way)
    aircraft = make_aircraft(loaded.scenario)
    setup = prepare_flight(loaded, day.weather, day.plan(policy, planned.way), aircraft)
    with TemporaryDirectory(prefix="galeway-") as folder:
        path = Path(folder) / "flight.mcap"
        fly(setup, McapRecorder(path), lambda _: None)
        return _row(track(recordings.open(path)))


def _row(tracking: Tracking) -> Row:
    exposure_s = tracking.hazard_exposure_s or 0.0
    series = tracking.series
    by_wind, _, _ = np.histogram2d(
        series.wind_mps, np.abs(series.cross_track_m), bins=(WIND_EDGES_MPS, CROSS_EDGES_M)
    )
    met = np.flatnonzero(series.wind_mps > tracking.recording.header.threshold_mps)
    late_s = float(series.time_error_s[met[0]]) if met.size else None
    return {
        "outcome": tracking.outcome,
        "detail": tracking.outcome_detail,
        "arrived": tracking.arrived,
        "flown": "safe" if tracking.arrived and exposure_s == 0.0 else "lost",
        "hazard_exposure_s": exposure_s,
        "late_at_hazard_s": late_s,
        "flight_time_s": tracking.flight_time_s,
        "delay_s": tracking.delay_s,
        "cross_track_max_m": tracking.cross_track_m.max,
        "wind_max_mps": tracking.wind_mps.max,
        "outside_airspeeds_s": tracking.outside_airspeeds_s,
        "cross_track_by_wind": by_wind.astype(int).tolist(),
    }


@lru_cache(maxsize=1)
def _flown_day(world: World, seed: int, scale: float) -> FlownDay:
    envelope = envelope_of(load_aircraft("aerosonde"))
    return FlownDay(DayForecasts(Day(world, seed), scale), envelope)


@lru_cache(maxsize=8)
def _planned(world: World, seed: int, scale: float, policy: str) -> list[Planned]:
    return POLICIES[policy].plan(_flown_day(world, seed, scale).case(), TUNED_SMALL)
