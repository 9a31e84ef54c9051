"""Peer planners on a scenario's weather, side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from planner.compare import compare
from planner.comparison_picture import draw
from planner.comparison_table import rows_table, summary_table
from planner.hazards import hazard_stages
from planner.peers import PEERS, Peer, PeerRoute, TrackPoint
from planner.pictures import check_picture
from planner.planning import PlanningRequest, staged_problem
from planner.plans import Plan
from planner.staged import Cell, StagedProblem
from planner.windaware import plan_windaware
from planner.windfield import WindField
from sim.errors import SimError
from sim.preparation import make_aircraft, planning_request
from sim.scenario import LoadedScenario
from sim.weather.source import bring_weather

WINDAWARE = "windaware"


def compare_planners(
    loaded: LoadedScenario,
    names: Sequence[str],
    picture: Path | None,
    progress: Callable[[str], None] = lambda _: None,
) -> str:
    """Run planners on a scenario and give the tables of what came of them.

    Args:
        loaded: the scenario.
        names: of the planners, all if empty.
        picture: where to draw the routes, if anywhere.
        progress: called with the name of each planner before it runs.

    Raises:
        SimError: if a name is unknown.
    """
    known = [*PEERS, WINDAWARE]
    for name in names:
        if name not in known:
            raise SimError(f"no planner is named {name!r}; there are {', '.join(known)}")
    if picture is not None:
        check_picture(picture)
    scenario = loaded.scenario
    if scenario.mission.levels_m:
        raise SimError(
            "planners are set side by side at one altitude, and mission.levels_m names others; leave it out "
            "with --set mission.levels_m=[]"
        )
    weather = bring_weather(loaded)
    request = planning_request(scenario, weather, make_aircraft(scenario, loaded.folder))
    problem = staged_problem(weather.forecast, request)
    grid = weather.forecast.grid
    truth = hazard_stages(
        weather.truth.level(request.altitude_m, grid),
        request.clock,
        threshold_mps=request.threshold_mps,
        corridor_m=0.0,
    )
    if weather.also.true is not None:
        truth |= weather.also.true
    start = request.start.cell(grid, "start")
    goals = [(goal.cell(grid, "goal"), goal.name) for goal in request.goals]
    peers = {**PEERS, WINDAWARE: _windaware(weather.forecast, request)}
    rows = compare(
        problem,
        start,
        [cell for cell, _ in goals],
        {name: peers[name] for name in names or known},
        truth=truth,
        seed=scenario.seed,
        progress=progress,
    )
    if picture is not None:
        draw(problem, grid, start, rows, picture)
    return f"{rows_table(rows, goals)}\n\n{summary_table(rows)}"


def _windaware(wind: WindField, request: PlanningRequest) -> Peer:
    """Our planner of any course, which takes its speed from the wind; asked for one goal after the other."""
    named = {goal.cell(wind.grid, "goal"): goal for goal in request.goals}

    def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
        place = named[goal]
        alone = replace(request, goals=(place,), goal=place.name, objective="earliest")
        plan = plan_windaware(wind, alone)
        if plan.waypoints:
            return PeerRoute(track=_track(plan, wind, problem.clock.step_s))
        return PeerRoute(reason=plan.outcome.reason)

    return Peer(find, "galeway's wind-aware planner", True, fastest=math.inf)


def _track(plan: Plan, wind: WindField, step_s: float) -> tuple[TrackPoint, ...]:
    """A plan's waypoints in rows, columns and steps."""
    grid = wind.grid
    rows, columns = np.arange(len(grid.lat_rad)), np.arange(len(grid.lon_rad))
    return tuple(
        TrackPoint(
            point.time_s / step_s,
            float(np.interp(math.radians(point.lat_deg), grid.lat_rad, rows)),
            float(np.interp(math.radians(point.lon_deg), grid.lon_rad, columns)),
        )
        for point in plan.waypoints
    )
