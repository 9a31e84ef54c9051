"""Routes through weather that changes: grid, wind, hazard, search and plan."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from planner.goal_plan import GoalPlan
    from planner.matrices import plan

__all__ = ["GoalPlan", "plan"]


class _Package(ModuleType):
    """The package, whose `plan` stays the function when the module planner/plan.py is imported."""

    def __getattr__(self, name: str) -> Any:
        """Load what the package offers when it is asked for, so that importing it stays light."""
        if name in __all__:
            from planner import matrices

            return getattr(matrices, name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __setattr__(self, name: str, value: object) -> None:
        """Leave `plan` free; importing planner/plan.py would set it to that module."""
        if not (name == "plan" and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
