"""The planner's clock of a scenario."""

from __future__ import annotations

from planner.hazards import StageClock
from sim.scenario import Scenario


def make_clock(scenario: Scenario) -> StageClock:
    """Stages and steps from the mission's departure on."""
    stages = scenario.stages
    return StageClock(scenario.mission.departure_s, stages.count, stages.steps, stages.step_s)
