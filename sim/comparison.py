"""Peer planners on a scenario's weather, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from planner.compare import compare
from planner.comparison_table import rows_table, summary_table
from planner.hazards import hazard_stages
from planner.peers import PEERS
from planner.planning import staged_problem
from sim.errors import SimError
from sim.preparation import make_aircraft, planning_request
from sim.scenario import LoadedScenario
from sim.weather.source import bring_weather


def compare_planners(loaded: LoadedScenario, names: Sequence[str], picture: Path | None) -> str:
    """Run planners on a scenario and give the tables of what came of them.

    Args:
        loaded: the scenario.
        names: of the planners, all if empty.
        picture: where to draw the routes, if anywhere.

    Raises:
        SimError: if a name is unknown.
    """
    for name in names:
        if name not in PEERS:
            raise SimError(f"no planner is named {name!r}; there are {', '.join(PEERS)}")
    scenario, weather = loaded.scenario, bring_weather(loaded)
    request = planning_request(scenario, make_aircraft(scenario, loaded.folder))
    problem = staged_problem(weather.forecast, request)
    grid = weather.forecast.grid
    truth = hazard_stages(
        weather.truth.at_altitude(request.altitude_m).resampled(grid),
        request.clock,
        threshold_mps=request.threshold_mps,
        corridor_m=0.0,
    )
    start = request.start.cell(grid, "start")
    goals = [(goal.cell(grid, "goal"), goal.name) for goal in request.goals]
    peers = {name: PEERS[name] for name in names or PEERS}
    rows = compare(problem, start, [cell for cell, _ in goals], peers, truth=truth, seed=scenario.seed)
    if picture is not None:
        from planner.comparison_picture import draw  # matplotlib, an extra

        draw(problem, start, rows, picture)
    return f"{rows_table(rows, goals)}\n\n{summary_table(rows)}"
