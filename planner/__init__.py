"""Routes through weather that changes: grid, wind, hazard, search and plan."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from planner.goal_plan import GoalPlan
    from planner.matrices import DeparturePlans, isochrones, plan, plan_departures

__all__ = ["DeparturePlans", "GoalPlan", "isochrones", "plan", "plan_departures"]


def __getattr__(name: str) -> Any:
    """Load what the package offers when it is asked for, so that importing it stays light."""
    if name in __all__:
        from planner import matrices

        return getattr(matrices, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
