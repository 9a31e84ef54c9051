"""Why a goal has no route."""

from __future__ import annotations

from enum import StrEnum


class Blocked(StrEnum):
    """The reasons, of which a planner gives the first that holds."""

    START_IN_HAZARD = "the start is in hazard at departure"
    GOAL_ALWAYS_IN_HAZARD = "the goal is in hazard in every stage"
    NEVER_REACHABLE = "no safe way leads there within the horizon"
    NOT_FLYABLE = "every safe way there asks for airspeeds that the aircraft does not have"
    WAITS_TOO_SHORT = "a safe way leads there within the horizon, but not with waits that can be flown"
