"""Where in a Rerun file the log of a flight stands, for its writer and its reader."""

from __future__ import annotations

from recordings.schema import (
    EVENTS,
    FORECAST_HAZARD,
    OUTCOME,
    PLAN_ISSUE,
    REFERENCE,
    SAMPLED,
    TRUTH_HAZARD,
    Topic,
)

HEADER_ENTITY = "/log"
METADATA, MESSAGE, SUMS = "metadata", "message", "sums"

MESSAGE_TOPICS = (REFERENCE, PLAN_ISSUE, FORECAST_HAZARD, TRUTH_HAZARD, EVENTS, OUTCOME)
"""Topics of single messages that a report is computed from."""


def entity_of(topic: Topic) -> str:
    """Columns of a sampled topic stand where its name says, messages of others under `/log`."""
    return topic.name if topic in SAMPLED else HEADER_ENTITY + topic.name
